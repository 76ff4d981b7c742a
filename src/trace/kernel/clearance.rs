//! How near rays come to being clipped: a smooth measure of what [`Path::walk`] answers with yes or no, for searches
//! of a pupil's edge. By the kernel's own loop, of which it is another output ([`Nearest`]).

use super::{
    Available, Table,
    apertures::Nearest,
    dispersion::Own,
    instances::{Grouping, InVectors, KernelScalar, in_vectors},
    lanes::{Cpu, Lanes},
    rays::batch::{Approach, from_plane},
    trace::through,
};
use crate::trace::path::Path;

/// The aperture that a ray comes nearest to, or reaches farthest beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clearance {
    /// The ray's distance from the axis there over the clear semi-diameter; at most 1 for a ray that
    /// gets through.
    pub ratio: f64,
    /// The surface, counted along the travel.
    pub surface: usize,
    /// Whether the ray stops for another reason, too, farther on, as far as that is looked at beyond an aperture.
    pub lost: bool,
}

/// Rays of a packet.
const PACKET: usize = 32;

/// A ray from the film, whose point lies on the x axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeridianRay {
    /// The film point's x, mm.
    pub height: f64,
    /// dx/dz and dy/dz.
    pub slopes: [f64; 2],
}

/// A path from film to scene and the film behind it, made ready for rays whose clearances are asked for.
pub(crate) struct ClearanceTracer {
    table: Table<f64>,
    film: f64,
    simd: Available,
}

impl ClearanceTracer {
    /// For film at z = `film`, behind the lens, and the best instructions that there are.
    pub fn new(path: &Path<f64>, film: f64) -> Self {
        Self::with_simd(path, film, Available::best())
    }

    fn with_simd(path: &Path<f64>, film: f64, simd: Available) -> Self {
        Self { table: Table::new(path, f64::AMPLIFICATION), film, simd }
    }

    /// Tells `found`, in order, the largest ratio of height to clear semi-diameter along each of several rays, traced
    /// side by side, where no aperture stops them.
    ///
    /// A ray that stops for another reason (it misses a surface, is reflected, turns back) has the ratio so far if that
    /// is more than 1, else none: `None` and a ratio of more than 1 together are what [`Path::walk`] blocks. Refraction
    /// is by the fused form, whatever the path's; blades block nothing.
    pub fn trace(
        &self,
        mut rays: impl Iterator<Item = MeridianRay>,
        mut found: impl FnMut(Option<Clearance>),
    ) {
        let mut packet = Packet::new(self);
        while packet.fill(&mut rays) > 0 {
            trace(self.simd, &mut packet);
            for i in 0..packet.count {
                let lost = packet.passed[i] == 0.0;
                let ratio = packet.ratio[i].sqrt();
                let surface = || self.table.surfaces[packet.at[i].to_bits() as usize];
                found((!lost || ratio > 1.0).then(|| Clearance { ratio, surface: surface(), lost }));
            }
        }
    }
}

/// Once, not for each of the callers' closures.
#[inline(never)]
fn trace(simd: Available, packet: &mut Packet<'_>) {
    in_vectors(simd, Grouping::Wide, packet);
}

/// Rays as structure of arrays: where they set out, and what became of them.
struct Packet<'a> {
    lens: &'a ClearanceTracer,
    /// Rays in it; the lanes after them hold whatever was there before.
    count: usize,
    height: [f64; PACKET],
    slopes: [[f64; PACKET]; 2],
    /// 1 for a ray that got through but for apertures, else 0.
    passed: [f64; PACKET],
    /// As [`Nearest`] has them.
    ratio: [f64; PACKET],
    at: [f64; PACKET],
}

impl<'a> Packet<'a> {
    fn new(lens: &'a ClearanceTracer) -> Self {
        let zero = [0.0; PACKET];
        Self { lens, count: 0, height: zero, slopes: [zero; 2], passed: zero, ratio: zero, at: zero }
    }

    /// Takes as many rays as there is room for; how many.
    fn fill(&mut self, rays: &mut impl Iterator<Item = MeridianRay>) -> usize {
        self.count = 0;
        for (i, ray) in rays.take(PACKET).enumerate() {
            self.height[i] = ray.height;
            (self.slopes[0][i], self.slopes[1][i]) = (ray.slopes[0], ray.slopes[1]);
            self.count = i + 1;
        }
        self.count
    }
}

impl InVectors<f64> for Packet<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.count
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vectors<L: Lanes<Scalar = f64>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize) {
        let ClearanceTracer { table, film, .. } = self.lens;
        let approach = Approach { entry: table.entry, travel_sign: table.travel_sign };
        let zero = L::splat(cpu, 0.0);
        let mut starts = [from_plane(cpu, approach, *film, [zero; 2], [zero; 2]); U];
        for (u, start) in starts.iter_mut().enumerate() {
            let at = first + u * L::WIDTH;
            let [height, sx, sy] = [
                L::load(cpu, &self.height[at..]),
                L::load(cpu, &self.slopes[0][at..]),
                L::load(cpu, &self.slopes[1][at..]),
            ];
            *start = from_plane(cpu, approach, *film, [height, zero], [sx, sy]);
        }
        let rays = through::<L, Nearest<L>, U>(cpu, table, Own, starts);
        for (u, ray) in rays.iter().enumerate() {
            let at = first + u * L::WIDTH;
            L::splat(cpu, 1.0).or_zero(ray.passed).store(&mut self.passed[at..]);
            ray.apertures.ratio.store(&mut self.ratio[at..]);
            ray.apertures.at.store(&mut self.at[at..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Simd, *};
    use crate::{
        lens::{Lens, film_ray},
        prescription::catalogue,
    };

    #[test]
    fn every_instance_and_every_packet_gives_the_same_bits() {
        let (mut lost, mut inside) = (0, 0);
        for name in catalogue::names() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let path = Path::<f64>::film_to_scene(&lens);
            let film = lens.rear().vertex - 1.1 * lens.rear().semi_diameter;
            let at = |k: u32| 2.5 * (f64::from(k) / 22.0 - 0.5);
            let ray = |k: u32| MeridianRay { height: 3.0, slopes: [at(k % 23), at(k / 23)] };
            let rays: Vec<_> = (0..23 * 23).map(ray).collect();
            let ask = |simd, packet: usize| {
                let tracer = ClearanceTracer::with_simd(&path, film, simd);
                let mut found = Vec::new();
                for rays in rays.chunks(packet) {
                    tracer.trace(rays.iter().copied(), |clearance| found.push(clearance));
                }
                found
            };
            let expected = ask(Simd::Portable.available().expect("always there"), 1);
            lost += usize::from(expected.contains(&None));
            inside += usize::from(expected.iter().flatten().any(|found| found.ratio < 1.0));
            for simd in Simd::ALL.into_iter().filter_map(Simd::available) {
                for packet in [3, 7, 15, PACKET, rays.len()] {
                    assert!(ask(simd, packet) == expected, "{name} {simd:?} {packet}");
                }
            }
        }
        // Not so of every lens: a telephone's lights no film so far from its axis.
        assert!(lost >= 15 && inside >= 15, "{lost} {inside}");
    }

    #[test]
    fn a_ray_gets_through_exactly_where_no_ratio_exceeds_1() {
        let (mut evaluations, mut meetings) = (0, 0);
        for name in catalogue::names() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let path = Path::<f64>::film_to_scene(&lens);
            let film = lens.rear().vertex - 1.1 * lens.rear().semi_diameter;
            // Along the axis, too, where a stop may lie at a vertex.
            let mut rays = vec![MeridianRay { height: 0.0, slopes: [0.0; 2] }];
            for i in 0..40 {
                for j in 0..40 {
                    for height in [0.0, 3.0, 12.0] {
                        let at = |k: i32| 2.5 * (f64::from(k) / 39.0 - 0.5);
                        rays.push(MeridianRay { height, slopes: [at(i), at(j)] });
                    }
                }
            }
            let mut clearances = Vec::new();
            let before = crate::trace::evaluations();
            ClearanceTracer::new(&path, film)
                .trace(rays.iter().copied(), |clearance| clearances.push(clearance));
            evaluations += crate::trace::evaluations() - before;
            meetings += (path.aspheres() * rays.len()) as u64;
            let (mut through, mut clipped, mut stopped) = (0, 0, 0);
            for (ray, clearance) in rays.into_iter().zip(clearances) {
                let passes = clearance.is_some_and(|clearance| clearance.ratio <= 1.0);
                let traced = path.trace(film_ray([ray.height, 0.0], film, ray.slopes));
                assert_eq!(passes, traced.is_ok(), "{name} {ray:?} {clearance:?}");
                match clearance {
                    Some(_) if passes => through += 1,
                    Some(_) => clipped += 1,
                    None => stopped += 1,
                }
            }
            assert!(through > 20 && clipped > 20, "{name}: {through} {clipped} {stopped}");
        }
        println!("{evaluations} evaluations where rays may meet aspheres {meetings} times");
        assert!(evaluations > 1000 && evaluations < 2 * meetings, "{evaluations} of {meetings}");
    }
}
