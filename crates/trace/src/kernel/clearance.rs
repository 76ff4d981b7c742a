//! Clearance of rays at apertures: a smooth measure of how near rays come to being clipped. [`Path::walk`] returns only
//! whether they are clipped. The clearance is used in searches for the edge of a pupil, and is another output of the
//! kernel's own loop ([`Nearest`]).

use std::marker::PhantomData;

use super::{
    Table,
    apertures::Nearest,
    dispersion::Own,
    group::Group,
    instances::{Grouping, InVectors, KernelScalar, in_vectors},
    ray_arrays::{Approach, anywhere, from_plane},
    ray_lanes::{RayLanes, Start},
    trace::{enter, through},
};
use realistic_optics::{lens::Ray, trace::Path};
use realistic_simd::{Available, Cpu, Lanes};

/// The clearance of a ray at the apertures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// The largest ratio of the ray's distance from the axis to a clear semi-diameter; at most 1 for a ray that gets
    /// through.
    pub ratio: f64,
    /// Whether the ray is also blocked farther on for another reason. This is not tested in full behind an aperture
    /// that the ray passes far outside.
    pub lost: bool,
    /// Point on the film plane, x and y, mm, where a ray from the scene lands, unless it is lost.
    pub landing: Option<[f64; 2]>,
}

/// Maximum number of rays per packet.
const PACKET: usize = 32;

/// A ray before a lens, as `N` numbers.
pub trait Departure<const N: usize> {
    /// Whether the ray ends at the film.
    const LANDS: bool;
    /// Returns the numbers.
    fn numbers(self) -> [f64; N];
    /// Builds a vector of rays from these numbers, for a film at z = `film`.
    fn start<L: Lanes<Scalar = f64>>(cpu: Cpu<L>, approach: Approach, film: f64, numbers: [L; N])
    -> Start<L>;
}

/// A ray from the film.
#[derive(Clone, Copy, Debug)]
pub struct FilmRay {
    /// The film point, mm.
    pub point: [f64; 2],
    /// dx/dz and dy/dz.
    pub slopes: [f64; 2],
}

impl Departure<4> for FilmRay {
    const LANDS: bool = false;

    #[inline(always)]
    fn numbers(self) -> [f64; 4] {
        let ([x, y], [sx, sy]) = (self.point, self.slopes);
        [x, y, sx, sy]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = f64>>(
        cpu: Cpu<L>,
        approach: Approach,
        film: f64,
        [x, y, sx, sy]: [L; 4],
    ) -> Start<L> {
        from_plane(cpu, approach, film, [x, y], [sx, sy])
    }
}

/// A ray from the scene, which may start anywhere before the first surface.
impl Departure<6> for Ray {
    const LANDS: bool = true;

    #[inline(always)]
    fn numbers(self) -> [f64; 6] {
        let ([x, y, z], [dx, dy, dz]) = (self.origin, self.direction);
        [x, y, z, dx, dy, dz]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = f64>>(
        cpu: Cpu<L>,
        approach: Approach,
        _: f64,
        [x, y, z, dx, dy, dz]: [L; 6],
    ) -> Start<L> {
        anywhere(cpu, approach, [x, y, z], [dx, dy, dz])
    }
}

/// Tracer that measures the clearances of rays along a path between film and scene, with the film behind the lens. The
/// rays are [`FilmRay`]s if the path leads to the scene, [`Ray`]s if it leads to the film.
pub struct ClearanceTracer {
    table: Table<f64>,
    film: f64,
    simd: Available,
}

impl ClearanceTracer {
    /// Creates a tracer for a film at z = `film`, behind the lens, with the best available instructions.
    pub fn new(path: &Path<f64>, film: f64) -> Self {
        Self::with_simd(path, film, Available::best())
    }

    fn with_simd(path: &Path<f64>, film: f64, simd: Available) -> Self {
        Self { table: Table::new(path, f64::AMPLIFICATION), film, simd }
    }

    /// Reports to `found`, in order, the largest ratio of height to clear semi-diameter along each ray. The rays are
    /// traced side by side, and apertures do not block them.
    ///
    /// For a ray that is blocked for another reason (it misses a surface, is totally reflected, or turns back), the
    /// result has the largest ratio up to there if that is more than 1; otherwise the result is `None`. [`Path::walk`]
    /// blocks exactly the rays with `None` or a ratio of more than 1. The fused form of refraction is used, whatever
    /// the path's method.
    pub fn trace<const N: usize, D: Departure<N>>(
        &self,
        mut rays: impl Iterator<Item = D>,
        mut found: impl FnMut(Option<Clearance>),
    ) {
        let mut packet = Packet::<N, D>::new(self);
        while packet.fill(&mut rays) > 0 {
            trace(self.simd, &mut packet);
            for i in 0..packet.count {
                let lost = packet.passed[i] == 0.0;
                let ratio = packet.ratio[i].sqrt();
                let landing = (D::LANDS && !lost).then(|| packet.landing.map(|axis| axis[i]));
                let clearance = || Clearance { ratio, lost, landing };
                found((!lost || ratio > 1.0).then(clearance));
            }
        }
    }

    /// Returns, in order, how far outside the apertures rays pass: the largest ratio of [`ClearanceTracer::trace`]
    /// minus 1, at most 0 for a ray that gets through. The result is infinity for a lost ray, because the apertures
    /// that it met do not show how near it comes to getting through.
    pub fn excesses<const N: usize, D: Departure<N>>(
        &self,
        rays: impl ExactSizeIterator<Item = D>,
    ) -> Vec<f64> {
        let mut found = Vec::with_capacity(rays.len());
        self.trace(rays, |clearance| {
            let not_lost = clearance.filter(|clearance| !clearance.lost);
            found.push(not_lost.map_or(f64::INFINITY, |clearance| clearance.ratio - 1.0));
        });
        found
    }
}

/// Traces a packet. This function is compiled once for each type of ray, not for each closure of a caller.
#[inline(never)]
fn trace<const N: usize, D: Departure<N>>(simd: Available, packet: &mut Packet<'_, N, D>) {
    in_vectors(simd, Grouping::Wide, packet);
}

/// Rays as structure of arrays: their starts and their results.
struct Packet<'a, const N: usize, D> {
    lens: &'a ClearanceTracer,
    /// Type of the rays.
    of: PhantomData<D>,
    /// Number of rays; the lanes behind them hold stale values.
    count: usize,
    numbers: [[f64; PACKET]; N],
    /// 1 for a ray that nothing but apertures blocks, else 0.
    passed: [f64; PACKET],
    /// Squared ratios, as in [`Nearest`].
    ratio: [f64; PACKET],
    /// Points on the film of the rays that land.
    landing: [[f64; PACKET]; 2],
}

impl<'a, const N: usize, D: Departure<N>> Packet<'a, N, D> {
    fn new(lens: &'a ClearanceTracer) -> Self {
        let zero = [0.0; PACKET];
        let (numbers, landing) = ([zero; N], [zero; 2]);
        Self { lens, of: PhantomData, count: 0, numbers, passed: zero, ratio: zero, landing }
    }

    /// Loads as many rays as fit, and returns their number.
    fn fill(&mut self, rays: &mut impl Iterator<Item = D>) -> usize {
        self.count = 0;
        for (i, ray) in rays.take(PACKET).enumerate() {
            for (array, number) in self.numbers.iter_mut().zip(ray.numbers()) {
                array[i] = number;
            }
            self.count = i + 1;
        }
        self.count
    }

    /// Returns a vector of rays, starting with ray number `at`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, at: usize) -> Start<L> {
        let ClearanceTracer { table, film, .. } = self.lens;
        let approach = Approach { entry: table.entry, travel_sign: table.travel_sign };
        let mut numbers = [L::splat(cpu, 0.0); N];
        for (number, array) in numbers.iter_mut().zip(&self.numbers) {
            *number = L::load(cpu, &array[at..]);
        }
        D::start(cpu, approach, *film, numbers)
    }
}

impl<const N: usize, D: Departure<N>> InVectors<f64> for Packet<'_, N, D> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.count
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = f64>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        let ClearanceTracer { table, film, .. } = self.lens;
        let mut rays = Group::<RayLanes<L, Nearest<L>>, U>::default();
        for u in 0..count {
            let start = self.start(cpu, first + u * L::WIDTH);
            rays.push(enter(cpu, table, &Own, L::splat(cpu, 0.0), start).0);
        }
        let rays = rays.filled();
        through(cpu, table, &Own, rays, &mut [(); U], count);
        for (u, ray) in rays[..count].iter().enumerate() {
            let at = first + u * L::WIDTH;
            let mut passed = ray.passed;
            if D::LANDS {
                let end = ray.leave(cpu, table, L::splat(cpu, 1.0));
                passed = end.passed;
                let along = (L::splat(cpu, *film) - end.origin[2]) / end.direction[2];
                passed = L::both(passed, L::splat(cpu, 0.0).less_equal(along));
                for axis in 0..2 {
                    let landing = along.mul_add(end.direction[axis], end.origin[axis]);
                    landing.store(&mut self.landing[axis][at..]);
                }
            }
            L::splat(cpu, 1.0).or_zero(passed).store(&mut self.passed[at..]);
            ray.apertures.ratio.store(&mut self.ratio[at..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Kernel, RayBuffer},
        *,
    };
    use realistic_base::numeric::STEPS;
    use realistic_optics::{
        lens::{Lens, film_ray, pupil::EntrancePupil},
        prescription::catalogue,
        trace::Direction,
    };
    use realistic_simd::Simd;

    /// Returns z of a film behind a lens.
    fn film(lens: &Lens) -> f64 {
        lens.rear().vertex - 1.1 * lens.rear().semi_diameter
    }

    /// Returns rays from points at several distances and from infinity, at angles up to more than 90 degrees. They
    /// cross the plane of the entrance pupil inside the pupil and around it.
    fn from_scene(lens: &Lens, count: u32) -> Vec<Ray> {
        let pupil =
            EntrancePupil::of_surface(lens, lens.stop_index().expect("the catalogue's lenses have one"));
        let z = pupil.position().expect("no catalogue lens is telecentric there");
        let ray = |k: u32| {
            let [a, b, c, d] = STEPS.map(|step| (0.5 + f64::from(k) * step).fract());
            let (sin, cos) = (1.8 * a * a).sin_cos();
            let (aside, along) = (std::f64::consts::TAU * b).sin_cos();
            let at = |number: f64| 2.2 * pupil.diameter() * (number - 0.5);
            let point = [at(c), at(d), z];
            let to_scene = [sin * along, sin * aside, cos];
            let from = |reference: [f64; 3], distance: f64| -> [f64; 3] {
                std::array::from_fn(|axis| reference[axis] + distance * to_scene[axis])
            };
            let origin = match k % 4 {
                0 => from(point, 300.0),
                1 => from([0.0, 0.0, z], 300.0),
                2 => from([0.0, 0.0, z], 2000.0),
                _ => from([0.0, 0.0, z], 1e7),
            };
            let difference: [f64; 3] = std::array::from_fn(|axis| point[axis] - origin[axis]);
            Ray { origin, direction: realistic_base::numeric::unit(difference) }
        };
        (0..count).map(ray).collect()
    }

    /// Returns the clearances of rays. Asserts that every instance gives the same clearances for the first 600 rays,
    /// whatever the packet size.
    fn clearances<const N: usize, D: Departure<N> + Copy>(
        name: &str,
        path: &Path<f64>,
        film: f64,
        rays: &[D],
    ) -> Vec<Option<Clearance>> {
        let traced = |rays: &[D], simd, packet: usize| {
            let tracer = ClearanceTracer::with_simd(path, film, simd);
            let mut found = Vec::new();
            for rays in rays.chunks(packet) {
                tracer.trace(rays.iter().copied(), |clearance| found.push(clearance));
            }
            found
        };
        let expected = traced(rays, Simd::Portable.available().expect("always there"), 1);
        let first = &rays[..rays.len().min(600)];
        for simd in Simd::ALL.into_iter().filter_map(Simd::available) {
            for packet in [3, 7, 15, PACKET, first.len()] {
                assert!(traced(first, simd, packet) == expected[..first.len()], "{name} {simd:?} {packet}");
            }
        }
        expected
    }

    #[test]
    fn every_instance_and_every_packet_gives_the_same_bits() {
        let (mut lost, mut inside) = (0, 0);
        for name in catalogue::round() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let at = |k: u32| 2.5 * (f64::from(k) / 22.0 - 0.5);
            let ray = |k: u32| FilmRay { point: [3.0, 0.0], slopes: [at(k % 23), at(k / 23)] };
            let rays: Vec<_> = (0..23 * 23).map(ray).collect();
            let found = clearances(name, &Path::film_to_scene(&lens), film(&lens), &rays);
            lost += usize::from(found.contains(&None));
            inside += usize::from(found.iter().flatten().any(|found| found.ratio < 1.0));
        }
        // This does not hold for every lens: a telephone's lens illuminates no film so far from its axis.
        assert!(lost >= 15 && inside >= 15, "{lost} {inside}");
    }

    #[test]
    fn a_scene_ray_passes_where_no_excess_ratio_exceeds_1() {
        // Most scene rays in a telephoto are clipped elsewhere than at the stop.
        const NARROWER: f64 = 0.7;
        for name in catalogue::round() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let mut narrow = lens.clone();
            let stop = narrow.stop_index().expect("the catalogue's lenses have one");
            narrow.surfaces[stop].semi_diameter *= NARROWER;
            let (path, film) = (Path::scene_to_film(&narrow), film(&lens));
            let rays = from_scene(&lens, 4000);
            let found = clearances(name, &path, film, &rays);
            let (whole, kernel) =
                (Path::<f64>::scene_to_film(&lens), Kernel::<f64>::new(&narrow, Direction::SceneToFilm));
            let mut traced = RayBuffer::new(rays.len());
            for (i, ray) in rays.iter().enumerate() {
                traced.put(i, ray.origin, ray.direction);
            }
            kernel.trace_in_place(&mut traced.rays());
            let (mut through, mut clipped, mut stopped, mut beyond) = (0, 0, 0, 0);
            for (i, (ray, clearance)) in rays.into_iter().zip(found).enumerate() {
                let passes = clearance.is_some_and(|clearance| clearance.ratio <= 1.0);
                assert_eq!(passes, traced.get(i).is_some(), "{name} {ray:?} {clearance:?}");
                assert_eq!(passes, path.trace(ray).is_ok(), "{name} {ray:?} {clearance:?}");
                match clearance {
                    Some(_) if passes => through += 1,
                    Some(_) => clipped += 1,
                    None => stopped += 1,
                }
                let Ok(Ray { origin: [x, y, z], direction: [dx, dy, dz] }) = whole.trace(ray) else {
                    continue;
                };
                let Clearance { ratio, lost, landing } = clearance.expect("not lost");
                assert!(!lost && ratio <= 1.0 / NARROWER, "{name} {ray:?}");
                beyond += u32::from(!passes);
                let [u, v] = landing.expect("not lost");
                let along = (film - z) / dz;
                let off = (u - x - along * dx).hypot(v - y - along * dy);
                // The distance is measured perpendicular to the ray, not along the film.
                assert!(off * dz.abs() < 1e-9, "{name} {ray:?} {off:e}");
            }
            assert!(
                through > 20 && clipped > 20 && beyond > 5,
                "{name}: {through} {clipped} {stopped} {beyond}"
            );
        }
    }

    #[test]
    fn a_ray_gets_through_exactly_where_no_ratio_exceeds_1() {
        for name in catalogue::round() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let path = Path::<f64>::film_to_scene(&lens);
            let film = film(&lens);
            // Includes the axis, where a stop may lie at a vertex.
            let mut rays = vec![FilmRay { point: [0.0, 0.0], slopes: [0.0; 2] }];
            for i in 0..40 {
                for j in 0..40 {
                    for height in [0.0, 3.0, 12.0] {
                        let at = |k: i32| 2.5 * (f64::from(k) / 39.0 - 0.5);
                        rays.push(FilmRay { point: [height, 0.0], slopes: [at(i), at(j)] });
                    }
                }
            }
            let mut clearances = Vec::new();
            ClearanceTracer::new(&path, film)
                .trace(rays.iter().copied(), |clearance| clearances.push(clearance));
            let (mut through, mut clipped, mut stopped) = (0, 0, 0);
            for (ray, clearance) in rays.into_iter().zip(clearances) {
                let passes = clearance.is_some_and(|clearance| clearance.ratio <= 1.0);
                let traced = path.trace(film_ray(ray.point, film, ray.slopes));
                assert_eq!(passes, traced.is_ok(), "{name} {ray:?} {clearance:?}");
                match clearance {
                    Some(_) if passes => through += 1,
                    Some(_) => clipped += 1,
                    None => stopped += 1,
                }
            }
            assert!(through > 20 && clipped > 20, "{name}: {through} {clipped} {stopped}");
        }
    }
}
