//! The lens traced surface after surface by a named method of refraction: one ray at a time, sampled in double precision.

use std::f64::consts::PI;

use super::{
    body::CameraBody,
    film_sampling::FilmSampling,
    tracer::{LensTracer, Tracer},
};
use crate::{
    camera::rays::{Rays, Sample, Samples, WorldRay},
    lens::{Lens, cos4, film_ray},
    light::{LitPath, Surfaces},
    sampling::film_rays::FilmRays,
    trace::{Path, Real},
};

/// A camera that traces its rays through the lens in numbers of type `R`.
pub(crate) struct WalkTracer<R> {
    film: FilmSampling<f64>,
    path: Path<R>,
    /// The light of the rays, if weights include the lens's transmission.
    lit: Option<LitPath>,
    body: CameraBody,
}

impl<R: Real> WalkTracer<R> {
    /// Prepares the camera; `path` leads from the film to the scene through `lens`.
    pub fn new(path: Path<R>, lens: &Lens, body: &CameraBody) -> Self {
        let lit = body
            .coatings
            .as_ref()
            .map(|coatings| LitPath::new(Path::film_to_scene(lens), &Surfaces::untabulated(lens, coatings)));
        Self { film: body.film_sampling(), path, lit, body: body.clone() }
    }

    fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let FilmRays { point, slopes, area_per_pi, .. } = self.film.one(sample, None);
        if area_per_pi.is_nan() {
            return None;
        }
        let CameraBody { film_side, weight, placement, units_per_mm, .. } = &self.body;
        let from = film_ray(point, film_side.z, slopes);
        let ray = self.path.trace(from).ok()?;
        let left = match &self.lit {
            None => 1.0,
            Some(lit) => lit.trace(from).ok()?.1,
        };
        let weight = weight.map_or(1.0, |weight| weight * (PI * area_per_pi * left * cos4(slopes))) as f32;
        let ray = placement.world_ray(ray, *units_per_mm, sample.time);
        // The weight of a ray must not underflow to that of a blocked ray.
        (ray.is_sound() && weight.is_finite()).then_some((ray, weight.max(f32::MIN_POSITIVE)))
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
