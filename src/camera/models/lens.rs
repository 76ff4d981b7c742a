//! The realistic camera: a sample in, a ray through every interface of the lens out (Kolb, Mitchell and Hanrahan 1995).

use super::lens_parts::{
    Tracers, ghost_rays, plan_and_compile, pupil_sampler, rear_disk, transmission, weight_factor,
};
use crate::{
    camera::{
        host::{Host, Log},
        importance::{AdjointCamera, AdjointLens},
        model::Model,
        parameters::{CameraError, ParameterError, Parameters},
        pipeline::{
            arrays::{RayArrays, SampleArrays},
            body::CameraBody,
            ray_maker::RayMaker,
            spectral::{LensOfMedia, Spectral},
        },
        ray::{Outcome, Sample, WorldRay},
        setup::{Facts, Focusing, Setup, SharedLens},
    },
    imaging::field::Field,
    lens::film_ray,
    plan::{FilmSide, Plan},
    prescription::Blades,
    sampling::{DiskMapping, PupilDisk, film_rays::FilmRays},
    trace::{Blocked, Direction, Path, Ray},
};

/// A camera with a real lens. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct RealisticCamera {
    facts: Facts,
    body: CameraBody,
    /// The disk that holds every pupil.
    rear: PupilDisk,
    tracers: Tracers,
    rays: RayMaker,
    plan: Plan,
    blades: Option<Blades>,
    shared: SharedLens,
}

impl RealisticCamera {
    /// Builds a camera of the model "lens". `log` receives warnings.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(parameters: &Parameters, host: &Host, log: Log<'_>) -> Result<Self, CameraError> {
        Self::build_from(None, parameters, host, log)
    }

    /// [`RealisticCamera::build`], the same to the last bit; what follows from the same as in the donor is taken from it.
    ///
    /// # Errors
    /// As of [`RealisticCamera::build`].
    pub fn build_from(
        donor: Option<&Self>,
        parameters: &Parameters,
        host: &Host,
        log: Log<'_>,
    ) -> Result<Self, CameraError> {
        let model = parameters.model();
        if model != Model::Lens {
            let (value, range) = (format!("\"{model}\""), "\"lens\"".to_owned());
            return Err(ParameterError::Range { name: "model", value, range }.into());
        }
        let donor = donor.map(|camera| &camera.shared);
        let setup = Setup::of(parameters, host, Focusing::Exact, donor, log)?;
        Self::from_setup(setup, log)
    }

    /// Builds the camera of a checked set-up, each part once, in the order of the light.
    fn from_setup(setup: Setup, log: Log<'_>) -> Result<Self, CameraError> {
        let Facts { lens, film, .. } = &setup.facts;
        let path = Path::new(lens, Direction::FilmToScene, setup.refraction);
        let film_z = setup.facts.film_z();
        let rear = rear_disk(&setup, film_z)?;
        let exit = PupilDisk::exit(lens, film_z);
        let sampler = pupil_sampler(&setup, &path, film_z, [rear, exit], log);
        // The pupil is that of the whole circle, and what of it the blades cover is blocked.
        let path = path.with_blades(lens, setup.blades);
        let weight = weight_factor(&setup, &path, film_z, &sampler, [rear, exit])?;
        let body = CameraBody {
            film_side: FilmSide { film: *film, z: film_z, mapping: setup.mapping, sampler },
            weight,
            transmission: transmission(&setup, film_z, rear, log),
            placement: setup.placement.clone(),
            units_per_mm: setup.mm_per_unit.recip(),
        };
        let (mut tracers, plan) = plan_and_compile(&setup, &path, &body, log);
        let ghosts = ghost_rays(&setup, rear, &body, log);
        if let Some(ghosts) = &ghosts {
            tracers = tracers.with_ghosts(ghosts);
        }
        let mut rays = RayMaker::new(tracers.one.clone(), tracers.many.clone(), body.placement.clone());
        if setup.is_dispersive() {
            let Setup { media, transmittances, blades, coatings, .. } = setup;
            let optics = LensOfMedia { lens: lens.clone(), media, transmittances, blades, coatings };
            rays.set_spectral(Spectral::new(optics, body.clone(), tracers.exact, ghosts));
        }
        // Where the film stands once its place in lens space is rounded.
        let film_distance = setup.facts.lens.rear().vertex - film_z;
        let facts = Facts { film_distance, ..setup.facts };
        Ok(Self { facts, body, rear, tracers, rays, plan, blades: setup.blades, shared: setup.shared })
    }

    /// The ray of a sample, or why there is none. Finding out why costs more than a ray does; where
    /// nobody asks, [`RealisticCamera::ray`] spares it.
    pub fn generate(&self, sample: &Sample) -> Outcome {
        if let Some((ray, weight)) = self.ray(sample) {
            return Outcome::Ray(ray, weight);
        }
        let FilmRays { point, disk, slopes, area_per_pi } = self.tracers.one.film_ray(sample);
        if self.asks_again(disk) {
            Outcome::Redraw
        } else if area_per_pi.is_nan() {
            Outcome::Blocked(Blocked::Clipped)
        } else {
            let ray = film_ray(point, self.body.film_side.z, slopes);
            Outcome::Blocked(self.tracers.one.reason(sample, ray))
        }
    }

    /// The ray of a sample with its weight, positive; `None` where there is none.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        self.rays.ray(sample)
    }

    /// [`RealisticCamera::ray`] of many samples, the same to the last bit; with a tolerance, each within it. Where there is
    /// no ray the weight is 0, and the other numbers are left as they are.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn rays(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        let n = samples.checked_len();
        assert_eq!(n, rays.checked_len(), "a batch needs as much room as it has samples");
        self.rays.many(samples, rays);
    }

    /// Whether a point of the unit disk, which is none, asks for a new lens sample.
    fn asks_again(&self, disk: [f64; 2]) -> bool {
        self.body.film_side.mapping == DiskMapping::Rejection && disk.iter().any(|x| x.is_nan())
    }

    /// A ray that stands in for a blocked one where a host needs a complete ray all the same:
    /// the thick lens's ray of the same film point and lens sample, or the straight one where the lens is afocal.
    pub fn substitute(&self, sample: &Sample) -> WorldRay {
        let axial = Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] };
        let FilmRays { point, disk, slopes, area_per_pi } = self.tracers.one.film_ray(sample);
        let (point, slopes) = if self.asks_again(disk) {
            Default::default()
        } else if area_per_pi.is_nan() {
            (point, self.rear.seen_from(point).center)
        } else {
            (point, slopes)
        };
        let CameraBody { film_side, placement, units_per_mm, .. } = &self.body;
        let ray = film_ray(point, film_side.z, slopes);
        let ray = self.facts.first_order.as_ref().map_or_else(|_| straight(ray), |lens| lens.transfer(ray));
        let finite = ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite());
        placement.world_ray(if finite { ray } else { axial }, *units_per_mm, sample.time)
    }

    /// What the camera keeps and leaves out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The lens and the film.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// How far from the axis light reaches the film, up to its corner, mm; `None` where its middle is dark.
    pub(crate) fn lit_radius(&self) -> Option<f64> {
        let Facts { lens, film, .. } = &self.facts;
        let corner = 0.5 * film.diagonal();
        match self.body.film_side.sampler.image_radius() {
            Some(end) => Some(end.min(corner)),
            None => Field::new(lens, self.facts.film_z()).lit_radius(corner),
        }
    }

    pub(crate) fn ray_maker(&self) -> &RayMaker {
        &self.rays
    }

    /// The adjoint camera.
    pub(crate) fn adjoint(&self) -> AdjointCamera {
        AdjointCamera::of_lens(self.adjoint_lens(), &self.body.placement, self.body.units_per_mm)
    }

    /// The adjoint lens.
    pub(crate) fn adjoint_lens(&self) -> AdjointLens {
        AdjointLens::new(&self.facts.lens, self.blades, &self.body)
    }
}

/// A ray as it reaches the front vertex plane where nothing bends it, with a unit direction.
fn straight(Ray { origin: [x, y, z], direction: [dx, dy, dz] }: Ray) -> Ray {
    let (sx, sy) = (dx / dz, dy / dz);
    let norm = (1.0 + sx * sx + sy * sy).sqrt();
    Ray { origin: [x - sx * z, y - sy * z, 0.0], direction: [sx / norm, sy / norm, 1.0 / norm] }
}
