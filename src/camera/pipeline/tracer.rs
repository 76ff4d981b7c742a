//! The lens as a camera traces it: compiled for speed, or walked where a method of refraction is named.

use crate::sampling::film_rays::FilmRays;
use std::f64::consts::PI;

use super::{compiled::Pipeline, film_rays::Drawing};
use crate::trace::{Blocked, Path, Ray, Real};
use crate::{
    camera::{RayArrays, Sample, SampleArrays},
    imaging::irradiance::{cos4, film_ray},
};

/// A lens for rays from the film in the precision and by the refraction asked for.
#[derive(Clone, Debug)]
pub(crate) enum Tracer {
    Double(Box<Pipeline<f64>>),
    Single(Box<Pipeline<f32>>),
    Walk(Box<Walk<f64>>),
    WalkSingle(Box<Walk<f32>>),
}

/// A lens that is walked, ray by ray, with rays drawn in double precision.
#[derive(Clone, Debug)]
pub(crate) struct Walk<R> {
    pub drawing: Drawing<f64>,
    pub path: Path<R>,
}

impl Tracer {
    /// The film ray that a sample asks for.
    pub fn film_ray(&self, sample: &Sample) -> FilmRays<f64> {
        match self {
            Self::Double(pipeline) => pipeline.drawing().one(sample),
            Self::Single(pipeline) => pipeline.drawing().one(sample),
            Self::Walk(walk) => walk.drawing.one(sample),
            Self::WalkSingle(walk) => walk.drawing.one(sample),
        }
    }

    /// Rays and weights of many samples; `false` where they are to be asked for one by one.
    pub fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) -> bool {
        match self {
            Self::Double(pipeline) => pipeline.many(samples, rays),
            Self::Single(pipeline) => pipeline.many(samples, rays),
            Self::Walk(_) | Self::WalkSingle(_) => return false,
        }
        true
    }

    /// Why a ray that does not get through is blocked.
    pub fn reason(&self, film: f64, point: [f64; 2], slopes: [f64; 2]) -> Blocked {
        let ray = film_ray(point, film, slopes);
        match self {
            Self::Double(pipeline) => pipeline.lens().reason(ray),
            Self::Single(pipeline) => pipeline.lens().reason(ray),
            Self::Walk(walk) => walk.path.trace(ray).err().unwrap_or(Blocked::Clipped),
            Self::WalkSingle(walk) => walk.path.trace(ray).err().unwrap_or(Blocked::Clipped),
        }
    }
}

/// A ray in lens space.
pub(crate) struct Walked {
    pub ray: Ray,
    /// The slope area that it stands for, times cos⁴ before the lens.
    pub share: f64,
}

impl<R: Real> Walk<R> {
    pub fn one(&self, film: f64, sample: &Sample) -> Option<Walked> {
        let FilmRays { point, slopes, area_per_pi, .. } = self.drawing.one(sample);
        if area_per_pi.is_nan() {
            return None;
        }
        let ray = self.path.trace(film_ray(point, film, slopes)).ok()?;
        Some(Walked { ray, share: PI * area_per_pi * cos4(slopes) })
    }
}
