//! How near rays come to being clipped: a smooth measure of what [`Path::walk`] answers with yes or no, for searches
//! of a pupil's edge.
//!
//! In lanes: the kernel's formulas (see `ray`) for a path that has every aperture as a height, with the largest height
//! over its aperture carried along. Both roots at once and no division keep the time that few rays take short; what
//! that costs in digits a search of an edge does not need. No multiply-add is fused but at aspheres, whose code is the
//! kernel's own: processors without the instruction would do it slowly.

mod aspheres;
pub(super) mod crossing;
mod probe;

#[cfg(any(test, target_arch = "x86_64"))]
use super::Simd;
use super::{
    Available,
    asphere::Asphere,
    lanes::{Cpu, Lanes, Portable},
};
use crate::trace::path::Path;
use aspheres::PassAsphere;
use probe::Probe;

/// The aperture that a ray comes nearest to, or reaches farthest beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clearance {
    /// The ray's distance from the axis there over the clear semi-diameter; at most 1 for a ray that
    /// gets through.
    pub ratio: f64,
    /// The surface, counted along the travel.
    pub surface: usize,
    /// Whether the ray stops for another reason, too, farther on.
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
pub(crate) struct ClearanceTracer<'a> {
    path: &'a Path<f64>,
    /// From the film to the first vertex, mm.
    distance: f64,
    /// The surfaces that are neither spheres nor planes.
    aspheres: Vec<Option<Box<Asphere<f64>>>>,
    simd: Available,
}

impl<'a> ClearanceTracer<'a> {
    /// For film at z = `film`, behind the lens, and the best instructions that there are.
    pub fn new(path: &'a Path<f64>, film: f64) -> Self {
        Self::with_simd(path, film, Available::best())
    }

    fn with_simd(path: &'a Path<f64>, film: f64, simd: Available) -> Self {
        let aspheres = path.steps.iter().map(|step| Asphere::for_search(step).map(Box::new)).collect();
        Self { path, distance: path.entry - film, aspheres, simd }
    }

    /// Tells `found`, in order, the largest ratio of height to clear semi-diameter along each of several rays, traced
    /// side by side, where no aperture stops them.
    ///
    /// A ray that stops for another reason (it misses a surface, is reflected, turns back) has the ratio so far if that
    /// is more than 1, else none: `None` and a ratio of more than 1 together are what [`Path::walk`] blocks. Refraction
    /// is by the fused form, whatever the path's.
    pub fn trace(
        &self,
        mut rays: impl Iterator<Item = MeridianRay>,
        mut found: impl FnMut(Option<Clearance>),
    ) {
        let mut packet = Packet::new(self.distance);
        while packet.fill(&mut rays) > 0 {
            match self.simd.simd() {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the processor has these instructions.
                Simd::Avx512 => unsafe { avx512(self, &mut packet) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                Simd::Avx2 => unsafe { avx2(self, &mut packet) },
                _ => portable(self, &mut packet),
            }
            let lanes = packet.largest.iter().zip(packet.surface).zip(packet.open).take(packet.count);
            for ((&largest, surface), open) in lanes {
                let lost = open == 0.0;
                let surface = surface.to_bits() as usize;
                found((!lost || largest > 1.0).then(|| Clearance { ratio: largest.sqrt(), surface, lost }));
            }
        }
    }
}

/// Once, not for each of the callers' closures.
#[inline(never)]
fn portable(lens: &ClearanceTracer<'_>, packet: &mut Packet) {
    packet.trace::<Portable<f64, 4>>(Portable::cpu(), lens);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512(lens: &ClearanceTracer<'_>, packet: &mut Packet) {
    // SAFETY: this function is called only where the processor has what it is compiled for.
    packet.trace::<super::lanes::avx512::F64x8>(unsafe { Cpu::assume() }, lens);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2(lens: &ClearanceTracer<'_>, packet: &mut Packet) {
    // SAFETY: as in `avx512`.
    packet.trace::<super::lanes::avx2::F64x4>(unsafe { Cpu::assume() }, lens);
}

/// Rays as structure of arrays: where they set out, and what became of them.
struct Packet {
    /// From the film to the first vertex, mm.
    distance: f64,
    /// Rays in it; the lanes after them hold whatever was there before.
    count: usize,
    height: [f64; PACKET],
    slopes: [[f64; PACKET]; 2],
    /// 1 for a ray that got through but for apertures, else 0.
    open: [f64; PACKET],
    /// Square of the largest ratio.
    largest: [f64; PACKET],
    /// Its surface, whole numbers as the bits of floats: one mask selects both, and nothing computes with them.
    surface: [f64; PACKET],
}

impl Packet {
    fn new(distance: f64) -> Self {
        let zero = [0.0; PACKET];
        Self { distance, count: 0, height: zero, slopes: [zero; 2], open: zero, largest: zero, surface: zero }
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

    /// Several registers' rays in turns: each of them waits for its own square roots.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn trace<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, lens: &ClearanceTracer<'_>) {
        let mut at = 0;
        while at < self.count {
            at += if self.count - at <= L::WIDTH {
                self.trace_some::<L, 1>(cpu, lens, at)
            } else if self.count - at <= 2 * L::WIDTH {
                self.trace_some::<L, 2>(cpu, lens, at)
            } else {
                self.trace_some::<L, 4>(cpu, lens, at)
            };
        }
    }

    /// The rays of one register, from the one `at` on, where `n` is the index.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, n: f64, at: usize) -> Probe<L> {
        let height = L::load(cpu, &self.height[at..]);
        let [sx, sy] = &self.slopes;
        Probe::enter(cpu, self.distance, height, [L::load(cpu, &sx[at..]), L::load(cpu, &sy[at..])], n)
    }

    /// Traces the rays of `U` registers from the one `at` on; how many they are.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn trace_some<L: Lanes<Scalar = f64>, const U: usize>(
        &mut self,
        cpu: Cpu<L>,
        lens: &ClearanceTracer<'_>,
        at: usize,
    ) -> usize {
        let steps = &lens.path.steps;
        let n = steps[0].n;
        // No closures: one that is not inlined would be compiled for another processor than this function.
        let mut probes = [self.enter(cpu, n, at); U];
        for (u, probe) in probes.iter_mut().enumerate().skip(1) {
            *probe = self.enter(cpu, n, at + u * L::WIDTH);
        }
        for (number, (step, asphere)) in steps.iter().zip(&lens.aspheres).enumerate() {
            let number = f64::from_bits(number as u64);
            if let Some(asphere) = asphere {
                L::apart(cpu, PassAsphere { cpu, step, asphere, number, probes: &mut probes });
                continue;
            }
            for probe in &mut probes {
                probe.pass(cpu, step, number);
            }
        }
        for (u, probe) in probes.iter().enumerate() {
            let at = at + u * L::WIDTH;
            probe.open.store(&mut self.open[at..]);
            probe.largest.store(&mut self.largest[at..]);
            probe.surface.store(&mut self.surface[at..]);
        }
        U * L::WIDTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
