//! The importance of a lens: traces rays from the scene to the film and samples directions toward the lens
//! from scene points.

use super::{block::ArrivingRays, entrance::SeenPupil, film::ImportanceFilm, front::Front};
use crate::pipeline::{body::CameraBody, on_demand::OnDemand};
use crate::sampling::DiskMapping;
use crate::vectors::in_vectors;
use realistic_light::Transmission;
use realistic_optics::{
    imaging::axial_beam::AxialBeam,
    lens::{Lens, Ray, pupil::EntrancePupil, refraction::Refraction},
    prescription::SurfaceCoating,
    trace::{Direction, Path},
};
use realistic_simd::Available;
use realistic_trace::kernel::{Arrays, Grouping, Kernel, LensRays, LensSteps, Optics, Own, RayBuffer};

/// Smallest depth of the projection centre behind the front vertex, as a fraction of the front surface's
/// clear semi-diameter.
const BEHIND: f64 = 0.05;
/// Distance by which the origin of a ray is moved back, as a fraction of the front surface's clear
/// semi-diameter. The move is needed because a camera's own rays begin on the surface, up to rounding.
const BACK: f64 = 1e-4;

/// A kernel from scene to film; its rays carry their transmitted light if weights include the lens's
/// transmission.
#[derive(Clone, Debug)]
enum LightKernel {
    Clear(Kernel<f64>),
    Lit(LensSteps<f64, Transmission<Own>>, Available),
}

impl LightKernel {
    fn new(kernel: Kernel<f64>, lens: &Lens, coatings: Option<&[SurfaceCoating]>) -> Self {
        match coatings {
            None => Self::Clear(kernel),
            Some(coatings) => {
                let lit = Transmission::steps(kernel.steps(), lens, Direction::SceneToFilm, coatings);
                Self::Lit(lit, kernel.available())
            }
        }
    }

    /// Traces rays in place. The weight of each becomes the share of light that the lens transmits, 0 for a
    /// blocked ray.
    fn trace(&self, rays: &mut LensRays<'_, f64>) {
        match self {
            Self::Clear(kernel) => light_in_place(kernel.steps(), kernel.available(), rays),
            Self::Lit(lit, simd) => light_in_place(lit, *simd, rays),
        }
    }
}

fn light_in_place(optics: &impl Optics<f64>, simd: Available, rays: &mut LensRays<'_, f64>) {
    let mut rays = Arrays { optics, from: None, to: rays, optical_path: None };
    in_vectors(simd, Grouping::Wide, &mut rays);
}

/// A lens and the film behind it, for rays from the scene.
#[derive(Clone, Debug)]
pub struct AdjointLens {
    front: Front,
    film: ImportanceFilm,
    /// The kernel from scene to film, with all apertures.
    kernel: LightKernel,
    /// The path from scene to film with circles as its only apertures.
    whole: Path,
    /// The entrance pupil.
    pupil: EntrancePupil,
    /// z of the projection centre, which is the entrance pupil or, if that lies outside the lens, the point
    /// in the lens nearest to it.
    reference: f64,
    entrance: OnDemand<SeenPupil>,
}

impl AdjointLens {
    /// Returns the adjoint of a lens in front of a camera body.
    pub fn new(lens: &Lens, body: &CameraBody) -> Self {
        let pupil = AxialBeam::of(lens).entrance;
        let film = ImportanceFilm::new(body, lens.radiance_factor());
        let path = Path::new(lens, Direction::SceneToFilm, Refraction::Fused).with_apertures(lens);
        let kernel = Kernel::along(&path);
        Self {
            front: Front::of(lens),
            film,
            kernel: LightKernel::new(kernel, lens, body.coatings.as_deref()),
            whole: path.with_circles(),
            pupil,
            reference: pupil
                .position()
                .unwrap_or(0.0)
                .max(lens.rear().vertex)
                .min(-BEHIND * lens.front().semi_diameter),
            entrance: OnDemand::new(),
        }
    }

    /// Whether the pupil as seen from scene points has been tabulated.
    pub fn is_tabulated(&self) -> bool {
        self.entrance.get().is_some()
    }

    /// Returns the area of the front clear aperture, mm².
    pub fn front_area(&self) -> f64 {
        std::f64::consts::PI * self.front.surface.semi_diameter.powi(2)
    }

    /// Traces rays with directions of any length and replaces each by its importance, which is 0 for NaN and
    /// for a zero direction. `moved` holds each ray and the rounding error of its origin.
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
            // NaN marks a blocked ray.
            let start = if is_ray { start } else { [f64::NAN; 3] };
            rays.put(i, start, *direction);
        }
        self.land(rays);
    }

    /// Computes the importance of rays that begin in front of the lens.
    fn land(&self, rays: &mut RayBuffer<f64>) {
        self.kernel.trace(&mut rays.rays());
        self.film.we(rays);
    }

    /// Samples directions toward the lens from points of camera space, by two numbers in [0, 1] each, and
    /// computes the importance of their rays. A point that is NaN has no direction.
    pub(super) fn aim(&self, points: [&mut [f64]; 5], rays: &mut ArrivingRays) {
        if self.front.is_general {
            aim_at_front(&self.front, points, rays);
            return self.land(&mut rays.traced);
        }
        let entrance = self.entrance.get_or_make(|| self.tabulate());
        entrance.aim(&self.front, points, rays);
        self.land(&mut rays.traced);
    }

    /// Tabulates the pupil as seen from scene points. It is the pupil of the clear apertures; rays that other
    /// apertures block are traced in vain.
    fn tabulate(&self) -> SeenPupil {
        SeenPupil::build(&self.whole, &self.front, self.film.z(), &self.pupil, self.reference)
    }
}

/// Samples directions from points toward the clear aperture of the front surface, for lenses whose pupil is not tabulated
/// for scene points.
fn aim_at_front(front: &Front, points: [&mut [f64]; 5], rays: &mut ArrivingRays) {
    let back = BACK * front.surface.semi_diameter;
    let [x, y, z, u, v] = points;
    let toward_lens = rays.toward_lens.each_mut();
    for i in 0..x.len() {
        let disk = DiskMapping::Concentric.map(u[i], v[i]);
        let aimed = disk.and_then(|disk| front.aim([x[i], y[i], z[i]], disk));
        let (origin, direction, density) = aimed.unwrap_or(([f64::NAN; 3], [f64::NAN; 3], 0.0));
        for axis in 0..3 {
            toward_lens[axis][i] = origin[axis];
            toward_lens[3 + axis][i] = direction[axis];
        }
        toward_lens[6][i] = density;
        rays.traced.put(i, std::array::from_fn(|axis| origin[axis] - back * direction[axis]), direction);
    }
}
