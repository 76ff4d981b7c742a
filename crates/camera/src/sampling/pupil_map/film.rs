//! The pupils of all points of a film, at one wavelength.

use std::f64::consts::PI;

use super::{FilmRadii, Gap, Grid, GridLocation, MapConstants, MapFailure, PupilFilmSide, PupilMap};
use crate::sampling::{
    film_rays::FilmRays,
    pupil_disk::{LaneDisk, PupilDisk, PupilSample},
};
use realistic_base::numeric::Real;
use realistic_optics::trace::Path;
use realistic_simd::{Compiled, Cpu, Lanes, OneLane, Portable, Scalar, Simd};

/// The true pupil of every point of a film. Immutable once built.
#[derive(Clone, Debug)]
pub struct WarpedPupil {
    map: PupilMap,
    cover: PupilDisk,
    build: BuildReport,
    given_up: Vec<GivenUp>,
}

/// Size and cost of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// Number of film radii in the table.
    pub nodes: usize,
    /// Number of rays traced.
    pub rays: u32,
    /// Fraction of the film radius over which the rear element's disk is sampled instead of the pupil.
    pub covered: f64,
}

/// A range of film radii for which a region larger than the pupil is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenUp {
    /// First and last radius, mm.
    pub radii: [f64; 2],
    /// The reason.
    pub reason: MapFailure,
    /// Smallest share of samples found to pass the lens, over the cells with any that pass; 0 if there is no
    /// such cell.
    pub acceptance: f64,
}

/// Constants of look-ups, in the precision of the lanes.
#[derive(Clone, Copy, Debug)]
pub struct LanePupil<S> {
    pub(super) map: MapConstants<S>,
    cover: LaneDisk<S>,
}

impl<S: Scalar> LanePupil<S> {
    pub(super) fn new(map: &PupilMap, cover: PupilDisk) -> Self {
        Self { map: map.constants(), cover: cover.lane_disk() }
    }
}

impl WarpedPupil {
    /// Tabulates the pupils of film points up to `reach` mm from the axis, for film at z = `film` (lens
    /// space). `cover` is a disk that contains all these pupils; `exit` is the paraxial exit pupil.
    pub fn new(path: &Path, film: f64, reach: f64, [cover, exit]: [PupilDisk; 2]) -> Self {
        let family = FilmRadii::new(PupilFilmSide::new(path, film, [cover, exit]), reach);
        let grid = Grid::new(&family);
        let given_up = given_up(&grid);
        let is_covered = |gap: &&GivenUp| gap.reason != MapFailure::Gaps;
        let covered: f64 = given_up.iter().filter(is_covered).map(|gap| gap.radii[1] - gap.radii[0]).sum();
        let build =
            BuildReport { nodes: grid.slices.len(), rays: family.rays(), covered: covered / grid.ends[0] };
        Self { map: PupilMap::new(&grid, true), cover, build, given_up }
    }

    /// Returns the size and cost of the table.
    pub fn build_report(&self) -> BuildReport {
        self.build
    }

    /// Returns the ranges of film radii, in outward order, for which a region larger than the pupil is
    /// sampled.
    pub fn given_up(&self) -> &[GivenUp] {
        &self.given_up
    }

    /// Returns the film radius beyond which no light arrives, mm; `None` if it is not found within `reach` or
    /// at most an eighth beyond.
    pub fn image_radius(&self) -> Option<f64> {
        self.map.is_dark_beyond().then(|| self.map.end())
    }

    /// Returns the disk that contains every pupil.
    pub(crate) fn cover_disk(&self) -> PupilDisk {
        self.cover
    }

    /// Returns the slope sample that corresponds to the point `disk` of the unit disk, for a film point in
    /// mm; `None` if the film is dark there.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> Option<PupilSample> {
        let mut sample = PupilSample { slopes: [0.0; 2], area: f64::NAN };
        Simd::best().run(OneSample { pupil: self, film, disk, found: &mut sample });
        (!sample.area.is_nan()).then_some(sample)
    }

    /// Returns the constants of look-ups, in the precision of the lanes.
    pub(crate) fn lane_pupil<S: Scalar>(&self) -> LanePupil<S> {
        LanePupil::new(&self.map, self.cover)
    }

    /// Computes [`WarpedPupil::sample`] in lanes: sets the slopes and areas of rays. The area is NaN if there is
    /// nothing to sample.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        rays: &mut [FilmRays<L>; U],
    ) {
        let mut headings = [Heading::of(cpu, rays[0].point); U];
        for u in 1..U {
            headings[u] = Heading::of(cpu, rays[u].point);
        }
        let mut locations = [self.map.locate(cpu, &constants.map, headings[0].radius); U];
        for u in 1..U {
            locations[u] = self.map.locate(cpu, &constants.map, headings[u].radius);
        }
        for u in 0..U {
            aim(cpu, &self.map, constants, &headings[u], &locations[u], &mut rays[u]);
        }
    }

    /// Sets the areas of rays, given their slopes: the area per sample at each slope, divided by π. It is NaN
    /// outside the tabulated pupil and where the film is dark.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn areas<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePupil<L::Scalar>,
        rays: &mut [FilmRays<L>; U],
    ) {
        let heading = Heading::of(cpu, rays[0].point);
        let mut locations = [self.map.locate(cpu, &constants.map, heading.radius); U];
        let mut points = [heading.turned(rays[0].slopes); U];
        for u in 1..U {
            let heading = Heading::of(cpu, rays[u].point);
            locations[u] = self.map.locate(cpu, &constants.map, heading.radius);
            points[u] = heading.turned(rays[u].slopes);
        }
        let areas = self.map.areas(cpu, &locations, &points);
        for u in 0..U {
            rays[u].area_per_pi = areas[u];
            if !L::all(locations[u].inside) {
                let beyond = if self.map.is_dark_beyond() {
                    L::splat(cpu, L::Scalar::from_f64(f64::NAN))
                } else {
                    constants.cover.areas(cpu, rays[u].point, rays[u].slopes)
                };
                rays[u].area_per_pi = L::select(locations[u].inside, areas[u], beyond);
            }
        }
    }
}

/// Returns the cells that were given up, for a grid with one parameter; adjacent cells with the same reason
/// are merged.
fn given_up(grid: &Grid) -> Vec<GivenUp> {
    let mut all: Vec<GivenUp> = Vec::new();
    for &Gap { cell: [i, _], reason, acceptance } in &grid.gaps {
        let [from, to] = [i, i + 1].map(|node| grid.first([node as f64, 0.0]));
        match all.last_mut() {
            Some(last) if last.reason == reason && last.radii[1] == from => {
                last.radii[1] = to;
                last.acceptance = last.acceptance.min(acceptance);
            }
            _ => all.push(GivenUp { radii: [from, to], reason, acceptance }),
        }
    }
    all
}

/// Film points in polar form: distances and directions from the axis.
#[derive(Clone, Copy)]
pub(super) struct Heading<L> {
    pub radius: L,
    /// Unit vector; its value on the axis does not matter.
    direction: [L; 2],
}

impl<L: Lanes> Heading<L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn of(cpu: Cpu<L>, [x, y]: [L; 2]) -> Self {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let square = y.mul_add(y, x * x);
        let is_aside = L::splat(cpu, L::Scalar::NO_SQUARE).less(square);
        let root = L::select(is_aside, square, one).sqrt();
        let per_radius = one / root;
        let direction = [L::select(is_aside, x * per_radius, one), (y * per_radius).or_zero(is_aside)];
        Self { radius: L::select(is_aside, root, zero), direction }
    }

    /// Rotates vectors into the frame in which the film point lies on the x axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn turned(&self, [x, y]: [L; 2]) -> [L; 2] {
        let [c, s] = self.direction;
        [y.mul_add(s, x * c), x.neg_mul_add(s, y * c)]
    }

    /// Rotates vectors back into the film's own frame.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn back(&self, [x, y]: [L; 2]) -> [L; 2] {
        let [c, s] = self.direction;
        [y.neg_mul_add(s, x * c), x.mul_add(s, y * c)]
    }
}

/// Sets the slopes and areas of rays: by the map; beyond the end of the map by the cover or, if the film is
/// dark there, to NaN areas.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn aim<L: Lanes>(
    cpu: Cpu<L>,
    map: &PupilMap,
    constants: &LanePupil<L::Scalar>,
    heading: &Heading<L>,
    location: &GridLocation<L>,
    ray: &mut FilmRays<L>,
) {
    let (point, area) = map.at(cpu, location, heading.turned(ray.disk));
    (ray.slopes, ray.area_per_pi) = (heading.back(point), area);
    if L::all(location.inside) {
        return;
    }
    if map.is_dark_beyond() {
        ray.area_per_pi = L::select(location.inside, area, L::splat(cpu, L::Scalar::from_f64(f64::NAN)));
        return;
    }
    ray.replace(location.inside, constants.cover.lanes(cpu, ray.point, ray.disk));
}

/// Computes one sample with the processor's own fused multiply-add instructions.
struct OneSample<'a> {
    pupil: &'a WarpedPupil,
    film: [f64; 2],
    disk: [f64; 2],
    found: &'a mut PupilSample,
}

impl Compiled for OneSample<'_> {
    #[inline(always)]
    fn run(self) {
        let ([x, y], [u, v]) = (self.film, self.disk);
        let (point, disk) = ([Portable([x]), Portable([y])], [Portable([u]), Portable([v])]);
        let mut rays = [FilmRays { point, disk, slopes: disk, area_per_pi: Portable([0.0]) }];
        self.pupil.lanes(OneLane::cpu(), &self.pupil.lane_pupil(), &mut rays);
        let [FilmRays { slopes: [Portable([sx]), Portable([sy])], area_per_pi: Portable([area]), .. }] = rays;
        *self.found = PupilSample { slopes: [sx, sy], area: PI * area };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::{
        lens::{Lens, first_order::FirstOrder},
        prescription::catalogue,
    };

    /// Returns the area per sample at these slopes.
    fn area_at(pupil: &WarpedPupil, point: [f64; 2], slopes: [f64; 2]) -> Option<f64> {
        let [point, slopes] = [point, slopes].map(|pair| pair.map(|x| Portable([x])));
        let mut rays = [FilmRays { point, slopes, disk: slopes, area_per_pi: Portable([0.0]) }];
        pupil.areas(OneLane::cpu(), &pupil.lane_pupil(), &mut rays);
        let Portable([area_per_pi]) = rays[0].area_per_pi;
        (!area_per_pi.is_nan()).then_some(PI * area_per_pi)
    }

    #[test]
    fn the_inverse_finds_samples_of_the_pupil_with_their_area_alone() {
        for name in ["dgauss.50mm", "fisheye.10mm", "telephoto.250mm", "wide.22mm"] {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point - 0.5;
            let reach = 22.0;
            let disks = [PupilDisk::rear(&lens, film, reach).expect("behind"), PupilDisk::exit(&lens, film)];
            let pupil = WarpedPupil::new(&Path::film_to_scene(&lens), film, reach, disks);
            let mut sampled = 0;
            for i in 0..4000_u32 {
                let at = |step: f64| (0.5 + f64::from(i) * step).fract();
                let (radius, angle) =
                    (1.05 * reach * at(0.856_674_883_854_502_9), 6.3 * at(0.733_891_856_627_126));
                let (r, turn) = (at(0.628_706_721_037_808_7).sqrt(), 6.3 * at(0.538_597_257_225_901_9));
                let point = [radius * angle.cos(), radius * angle.sin()];
                let disk = [r * turn.cos(), r * turn.sin()];
                let Some(sample) = pupil.sample(point, disk) else {
                    assert_eq!(area_at(&pupil, point, [0.1, 0.1]), None, "{name} {point:?}");
                    continue;
                };
                sampled += 1;
                let area = area_at(&pupil, point, sample.slopes);
                let area = area.unwrap_or_else(|| panic!("{name} {point:?} {disk:?}: not found"));
                assert!((area / sample.area - 1.0).abs() < 1e-6, "{name} {point:?} {disk:?}: {area}");
                let beyond = disk.map(|part| 1.001 * part / r);
                if let Some(beyond) = pupil.sample(point, beyond) {
                    assert_eq!(area_at(&pupil, point, beyond.slopes), None, "{name} {point:?} {disk:?}");
                }
            }
            assert!(sampled > 2000, "{name}: {sampled}");
        }
    }

    #[test]
    fn slopes_are_continuous_through_the_axis_of_a_round_pupil() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("listed"));
        let film = FirstOrder::of(&lens).expect("not afocal").rear_focal_point;
        let disks = [PupilDisk::rear(&lens, film, 20.0).expect("behind"), PupilDisk::exit(&lens, film)];
        let pupil = WarpedPupil::new(&Path::film_to_scene(&lens), film, 20.0, disks);
        for k in 0..100_u32 {
            let at = |step: f64| (0.5 + f64::from(k) * step).fract();
            let (sin, cos) = (6.3 * at(0.733_891_856_627_126)).sin_cos();
            let disk = [0.7 * at(0.628_706_721_037_808_7), 0.7 * at(0.538_597_257_225_901_9)];
            let sample = |h: f64| pupil.sample([h * cos, h * sin], disk).expect("lit");
            let (axis, near) = (sample(0.0), sample(1e-7));
            for i in 0..2 {
                assert!((axis.slopes[i] - near.slopes[i]).abs() < 1e-7, "{axis:?} {near:?}");
            }
            let ratio = axis.slopes[0] / disk[0] / (axis.slopes[1] / disk[1]);
            assert!((ratio - 1.0).abs() < 1e-6, "{axis:?} for {disk:?}");
        }
    }
}
