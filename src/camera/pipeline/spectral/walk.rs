//! Rays at a wavelength of their own, one by one, through a lens made for each.

use super::{LensOfMedia, SpectralTracer, WAVELENGTHS};
use crate::{
    camera::{
        pipeline::{
            arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
            body::CameraBody,
            film_sampling::FilmSampling,
        },
        ray::{Sample, WorldRay},
    },
    lens::{cos4, film_ray},
    plan::FilmSide,
    sampling::{PupilSampler, film_rays::FilmRays},
};
use std::f64::consts::PI;

/// A camera that makes its lens anew for each ray, sampled over a disk that holds every pupil.
pub(super) struct WalkAt {
    optics: LensOfMedia,
    film: FilmSampling<f64>,
    body: CameraBody,
}

impl WalkAt {
    pub fn new(optics: LensOfMedia, body: &CameraBody) -> Self {
        let sampler = match &body.film_side.sampler {
            PupilSampler::Warped(pupil) => PupilSampler::Disk(pupil.cover_disk()),
            disk @ PupilSampler::Disk(_) => disk.clone(),
        };
        let side = FilmSide { sampler, ..body.film_side.clone() };
        Self { optics, film: FilmSampling::new(&side), body: body.clone() }
    }

    fn ray(&self, sample: &Sample, wavelength: f32) -> Option<(WorldRay, f32)> {
        let FilmRays { point, slopes, area_per_pi, .. } = self.film.one(sample);
        if area_per_pi.is_nan() || !WAVELENGTHS.contains(&wavelength) {
            return None;
        }
        let CameraBody { film_side, weight, placement, units_per_mm } = &self.body;
        let ray = self.optics.path(wavelength.into()).trace(film_ray(point, film_side.z, slopes)).ok()?;
        let weight = weight.map_or(1.0, |weight| weight * (PI * area_per_pi * cos4(slopes))) as f32;
        let ray = placement.world_ray(ray, *units_per_mm, sample.time);
        (ray.is_sound() && weight.is_finite()).then_some((ray, weight.max(f32::MIN_POSITIVE)))
    }

    fn each(&self, samples: &impl SampleStore, wavelengths: &[f32], rays: &mut impl RayStore) {
        (0..samples.len()).for_each(|i| rays.put(i, self.ray(&samples.sample(i), wavelengths[i])));
    }
}

impl SpectralTracer for WalkAt {
    fn one(&self, sample: &Sample, wavelength: f32, ray: &mut OneRay<'_>) {
        self.each(sample, &[wavelength], ray);
    }

    fn four(&self, samples: &SampleBlock<4>, wavelengths: &[f32; 4], rays: &mut RayBlock<4>) {
        self.each(samples, wavelengths, rays);
    }

    fn many(&self, samples: &SampleArrays<'_>, wavelengths: &[f32], rays: &mut RayArrays<'_>) {
        self.each(samples, wavelengths, rays);
    }

    fn film_ray(&self, sample: &Sample, _: f32) -> FilmRays<f64> {
        self.film.one(sample)
    }
}
