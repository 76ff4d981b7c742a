//! The lens traced surface by surface with a named method of refraction, one ray at a time; the film and the
//! pupil are sampled in double precision.

use super::{
    body::CameraBody,
    film_sampling::FilmSampling,
    tracer::{LensTracer, Tracer},
};
use crate::{
    rays::{Rays, WorldRay},
    samples::{Sample, Samples},
    sampling::film_rays::FilmRays,
};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::{
    lens::{self, Lens},
    trace::{Path, Real},
};

/// A camera that traces its rays through the lens in numbers of type `R`.
pub struct WalkTracer<R> {
    film: FilmSampling<f64>,
    path: Path<R>,
    /// The path with the light of the rays, if surfaces or a picture in the stop dim it.
    lit: Option<LitPath>,
    body: CameraBody,
}

impl<R: Real> WalkTracer<R> {
    /// Prepares the camera; `path` is the path from the film to the scene through `lens`.
    pub fn new(path: Path<R>, lens: &Lens, body: &CameraBody) -> Self {
        let surfaces = || match &body.coatings {
            Some(coatings) => Surfaces::untabulated(lens, coatings),
            None => Surfaces::lossless(lens),
        };
        let whole = || Path::film_to_scene(lens).with_apertures(lens);
        let carries_light = body.coatings.is_some() || lens.picture().is_some();
        let lit = carries_light.then(|| LitPath::new(whole(), &surfaces()));
        Self { film: body.film_sampling(), path, lit, body: body.clone() }
    }

    fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let film_ray = self.film.one(sample, None);
        if film_ray.area_per_pi.is_nan() {
            return None;
        }
        let from = lens::film_ray(film_ray.point, self.body.film_side.z, film_ray.slopes);
        let ray = self.path.trace(from).ok()?;
        let share = match &self.lit {
            None => 1.0,
            Some(lit) => lit.trace(from).ok()?.1,
        };
        self.body.world_ray(&film_ray, ray, share, sample.time)
    }
}

impl<R: Real + Send + Sync> Tracer for WalkTracer<R> {
    fn trace(&self, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        (0..samples.len()).for_each(|i| rays.put(i, self.ray(&samples.get(i))));
    }

    fn gains_by_four(&self) -> bool {
        false
    }
}

impl<R: Real + Send + Sync> LensTracer for WalkTracer<R> {
    fn film_ray(&self, sample: &Sample, _: Option<f32>) -> FilmRays<f64> {
        self.film.one(sample, None)
    }
}
