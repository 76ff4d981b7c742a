//! The importance of a lens: rays from the scene traced to the film, and directions toward the lens from scene points.

use super::{block::ArrivingRays, entrance::SeenPupil, film::ImportanceFilm, front::Front};
use crate::{
    camera::pipeline::{body::CameraBody, on_demand::OnDemand},
    imaging::axial_beam::AxialBeam,
    lens::{Lens, Ray, pupil::EntrancePupil, refraction::Refraction},
    prescription::Blades,
    trace::{
        Direction, Path,
        kernel::{Kernel, RayBuffer},
    },
};

/// How far behind the front vertex the point of the axis lies at least that the scene is seen from, over the front surface's
/// clear semi-diameter.
const BEHIND: f64 = 0.05;
/// How far before where it is said to begin a ray begins, over the front surface's clear semi-diameter: those of a camera
/// begin on the surface, but for rounding.
const BACK: f64 = 1e-4;

/// A lens and the film behind it, for rays from the scene.
#[derive(Clone, Debug)]
pub(crate) struct AdjointLens {
    front: Front,
    film: ImportanceFilm,
    /// From scene to film, with the blades.
    kernel: Kernel<f64>,
    /// The same without them.
    whole: Path,
    /// The entrance pupil.
    pupil: EntrancePupil,
    /// Its z, or of the place in the lens next to that.
    reference: f64,
    entrance: OnDemand<SeenPupil>,
}

impl AdjointLens {
    /// Of a lens, the blades in its stop and what lies behind and around it.
    pub fn new(lens: &Lens, blades: Option<Blades>, body: &CameraBody) -> Self {
        let pupil = AxialBeam::of(lens).entrance;
        let film = ImportanceFilm::new(body);
        let whole = Path::new(lens, Direction::SceneToFilm, Refraction::Fused);
        Self {
            front: Front::of(lens),
            film,
            kernel: Kernel::along(&whole.clone().with_blades(lens, blades)),
            whole,
            pupil,
            reference: pupil
                .position()
                .unwrap_or(0.0)
                .max(lens.rear().vertex)
                .min(-BEHIND * lens.front().semi_diameter),
            entrance: OnDemand::new(),
        }
    }

    /// Whether the lens has been looked at from everywhere.
    pub fn is_tabulated(&self) -> bool {
        self.entrance.get().is_some()
    }

    /// Area of the front clear aperture, mm².
    pub fn front_area(&self) -> f64 {
        std::f64::consts::PI * self.front.surface.semi_diameter.powi(2)
    }

    /// Traces rays with directions of any length, and leaves what they count; NaN and direction 0 count nothing. `moved` are the
    /// rays, and how far off its origin each may have been rounded.
    pub fn arrive(&self, moved: &[(Ray, f64)], rays: &mut RayBuffer<f64>) {
        let back = BACK * self.front.surface.semi_diameter;
        for (i, (Ray { origin, direction }, rounding)) in moved.iter().enumerate() {
            let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
            let moved = (back + rounding) / length;
            let start = [0, 1, 2].map(|axis| origin[axis] - moved * direction[axis]);
            let unit = direction.map(|part| part / length);
            let is_ray = start.iter().chain(direction).all(|part| part.is_finite())
                && self.front.is_before(start)
                && self.front.meets(&Ray { origin: start, direction: unit });
            // What is no ray is blocked.
            let start = if is_ray { start } else { [f64::NAN; 3] };
            rays.put(i, start, *direction);
        }
        self.land(rays);
    }

    /// What rays before the lens count.
    fn land(&self, rays: &mut RayBuffer<f64>) {
        self.kernel.trace_in_place(&mut rays.rays());
        self.film.we(rays);
    }

    /// Directions toward the lens from points of camera space, each for two numbers in [0, 1], and what they count; of points
    /// that are NaN none.
    pub(super) fn aim(&self, points: [&mut [f64]; 5], rays: &mut ArrivingRays) {
        let entrance = self.entrance.get_or_make(|| self.tabulate());
        entrance.aim(&self.front, points, rays);
        self.land(&mut rays.traced);
    }

    /// Looks at the lens from everywhere. The pupil is that of the whole stop: what of it the blades cover is blocked.
    fn tabulate(&self) -> SeenPupil {
        SeenPupil::build(&self.whole, &self.front, self.film.z(), &self.pupil, self.reference)
    }
}
