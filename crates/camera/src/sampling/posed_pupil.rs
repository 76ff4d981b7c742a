//! The pupils of film that is tilted or curved, and so does not lie in one plane perpendicular to the axis.
//!
//! Each point of such film has its own distance to the lens, so the pupil depends on both x and y of the film
//! point. Rays are extended to the plane through the film's centre perpendicular to the axis, from which the
//! camera traces them.

use std::f64::consts::PI;

use super::{
    film_rays::FilmRays,
    film_surface::{FilmMeeting, FilmSurface, SurfaceConstants},
    pupil_disk::{LaneDisk, PupilDisk, PupilSample},
    pupil_map::{MapConstants, RectanglePupil},
};
use realistic_base::numeric::Real;
use realistic_optics::trace::Path;
use realistic_simd::{Compiled, Cpu, Lanes, OneLane, Portable, Scalar, Simd};

/// The region to which the lens samples of tilted or curved film are mapped.
#[derive(Clone, Debug)]
pub struct PosedPupil {
    surface: FilmSurface,
    /// The table of the true pupils; `None` if a disk is sampled instead.
    table: Option<RectanglePupil>,
    /// The disk, which is also sampled for film points outside the table.
    disk: PupilDisk,
}

/// Constants of a [`PosedPupil`] in the precision of lanes.
#[derive(Clone, Copy, Debug)]
pub struct LanePosed<S> {
    surface: SurfaceConstants<S>,
    /// Constants of the table, if there is one.
    table: Option<MapConstants<S>>,
    disk: LaneDisk<S>,
}

impl PosedPupil {
    /// Tabulates the true pupils of a rectangle of film: see `RectanglePupil::new`.
    pub fn new(
        path: &Path,
        film: f64,
        surface: &FilmSurface,
        rectangle: [[f64; 2]; 2],
        [cover, exit]: [PupilDisk; 2],
    ) -> Self {
        let table = RectanglePupil::new(path, film, surface, rectangle, [cover, exit]);
        Self { surface: *surface, table: Some(table), disk: cover }
    }

    /// Returns film for which a disk is sampled in place of the true pupils.
    pub fn of_disk(surface: &FilmSurface, disk: PupilDisk) -> Self {
        Self { surface: *surface, table: None, disk }
    }

    /// Returns this film, but with lens samples mapped to the disk that contains every pupil.
    pub fn over_disk(&self) -> Self {
        Self::of_disk(&self.surface, self.disk)
    }

    /// Returns the disk; `None` if the true pupils are sampled.
    pub fn disk(&self) -> Option<&PupilDisk> {
        self.table.is_none().then_some(&self.disk)
    }

    /// Returns the fraction of the film for which the disk is sampled instead of the pupil.
    pub fn covered(&self) -> f64 {
        self.table.as_ref().map_or(0.0, RectanglePupil::covered)
    }

    /// Returns the constants in the precision `S`.
    pub(crate) fn constants<S: Scalar>(&self) -> LanePosed<S> {
        LanePosed {
            surface: self.surface.constants(),
            table: self.table.as_ref().map(RectanglePupil::constants),
            disk: self.disk.lane_disk(),
        }
    }

    /// Sets the slopes and areas of rays from points of the flat film, and replaces these points by those
    /// where the rays cross the plane through the film's centre perpendicular to the axis. The area is
    /// divided by π and multiplied by cos θ_f/cos θ_a; it is NaN where the film faces away from the lens.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn lanes<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePosed<L::Scalar>,
        rays: &mut [FilmRays<L>; U],
    ) {
        // In steps, so that the look-ups of one vector overlap the arithmetic of others.
        let mut points = [constants.surface.lift(cpu, rays[0].point); U];
        for u in 1..U {
            points[u] = constants.surface.lift(cpu, rays[u].point);
        }
        if let (Some(table), Some(own)) = (&self.table, &constants.table) {
            let mut locations = [table.locate(cpu, own, rays[0].point); U];
            for u in 1..U {
                locations[u] = table.locate(cpu, own, rays[u].point);
            }
            for u in 0..U {
                (rays[u].slopes, rays[u].area_per_pi) = table.at(cpu, &locations[u], rays[u].disk);
                if !L::all(locations[u].inside()) {
                    let (at, disk) = (&points[u], rays[u].disk);
                    let aimed = constants.disk.lanes_ahead(cpu, at.point, at.ahead, disk);
                    rays[u].replace(locations[u].inside(), aimed);
                }
            }
        } else {
            for u in 0..U {
                (rays[u].slopes, rays[u].area_per_pi) =
                    constants.disk.lanes_ahead(cpu, points[u].point, points[u].ahead, rays[u].disk);
            }
        }
        for (ray, at) in rays.iter_mut().zip(&points) {
            ray.area_per_pi = lit(cpu, ray.area_per_pi, at.facing(ray.slopes));
            ray.point = at.on_plane(ray.slopes);
        }
    }

    /// Sets the areas of rays as [`PosedPupil::lanes`] does, with NaN outside the sampled region. The rays
    /// are given by their slopes and their points in the plane through the film's centre perpendicular to the
    /// axis; the points are replaced by points of the flat film. Returns the ratio of the flat film's area to
    /// that of the surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn areas<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LanePosed<L::Scalar>,
        rays: &mut [FilmRays<L>; U],
    ) -> [L; U] {
        let mut found = [constants.surface.meet(cpu, rays[0].point, rays[0].slopes); U];
        for u in 1..U {
            found[u] = constants.surface.meet(cpu, rays[u].point, rays[u].slopes);
        }
        for (ray, FilmMeeting { at, .. }) in rays.iter_mut().zip(&found) {
            ray.area_per_pi = constants.disk.areas_ahead(cpu, at.point, at.ahead, ray.slopes);
        }
        if let (Some(table), Some(own)) = (&self.table, &constants.table) {
            let mut locations = [table.locate(cpu, own, found[0].flat); U];
            let mut slopes = [rays[0].slopes; U];
            for u in 1..U {
                locations[u] = table.locate(cpu, own, found[u].flat);
                slopes[u] = rays[u].slopes;
            }
            let areas = table.areas(cpu, &locations, &slopes);
            for u in 0..U {
                rays[u].area_per_pi = L::select(locations[u].inside(), areas[u], rays[u].area_per_pi);
            }
        }
        let mut flat_per_area = [found[0].flat_per_area; U];
        for u in 0..U {
            rays[u].area_per_pi = lit(cpu, rays[u].area_per_pi, found[u].at.facing(rays[u].slopes));
            (rays[u].point, flat_per_area[u]) = (found[u].flat, found[u].flat_per_area);
        }
        flat_per_area
    }

    /// Returns the ray from a point of the flat film, mm, that corresponds to a point of the unit disk: the
    /// point where the ray crosses the plane through the film's centre perpendicular to the axis, and its
    /// slopes with the area per sample, as in `PosedPupil::lanes`. `None` where the film faces away from
    /// the lens.
    pub fn sample(&self, flat: [f64; 2], disk: [f64; 2]) -> Option<([f64; 2], PupilSample)> {
        let [point, disk] = [flat, disk].map(|pair| pair.map(|number| Portable([number])));
        let mut rays = [FilmRays { point, disk, slopes: disk, area_per_pi: Portable([0.0]) }];
        Simd::best().run(OneSample { pupil: self, rays: &mut rays });
        let FilmRays { point, slopes, area_per_pi, .. } = rays[0].widened();
        (!area_per_pi.is_nan()).then_some((point, PupilSample { slopes, area: PI * area_per_pi }))
    }
}

/// Returns areas times cos θ_f over cos θ_a; NaN where that is not positive.
#[cfg_attr(not(debug_assertions), inline(always))]
fn lit<L: Lanes>(cpu: Cpu<L>, area: L, facing: L) -> L {
    let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
    L::select(number(0.0).less(facing), area * facing, number(f64::NAN))
}

/// Computes one sample with the processor's own fused multiply-add instructions.
struct OneSample<'a> {
    pupil: &'a PosedPupil,
    rays: &'a mut [FilmRays<Portable<f64, 1>>; 1],
}

impl Compiled for OneSample<'_> {
    #[inline(always)]
    fn run(self) {
        self.pupil.lanes(OneLane::cpu(), &self.pupil.constants(), self.rays);
    }
}
