//! A camera without its lens: the film and its sampler, the factor of a ray's weight, and the camera's pose.

use std::{f64::consts::PI, sync::Arc};

use super::film_sampling::FilmSampling;
use crate::{
    camera::{
        placement::{Placement, ToWorld},
        rays::Outcome,
    },
    lens::film_ray,
    plan::FilmSide,
    prescription::SurfaceCoating,
    sampling::{DiskMapping, film_rays::FilmRays},
    trace::{Blocked, Ray, kernel::KernelScalar},
};

/// The parts of a camera on both sides of the lens.
#[derive(Clone, Debug)]
pub(crate) struct CameraBody {
    pub film_side: FilmSide,
    /// Factor of a ray's weight, times cos⁴ and the slope area per sample; `None` for weight 1.
    pub weight: Option<f64>,
    /// Coatings of the surfaces, from the scene on, if weights include the lens's transmission.
    pub coatings: Option<Arc<[SurfaceCoating]>>,
    pub placement: Placement,
    pub units_per_mm: f64,
}

impl CameraBody {
    /// Returns the film's side in a precision.
    pub fn film_sampling<S: KernelScalar>(&self) -> FilmSampling<S> {
        FilmSampling::new(&self.film_side)
    }

    /// Whether a film ray's point of the unit disk is missing because another lens sample is requested.
    pub fn asks_again(&self, disk: [f64; 2]) -> bool {
        self.film_side.mapping == DiskMapping::Rejection && disk.iter().any(|x| x.is_nan())
    }

    /// Returns the reason why a film ray of the direct path gives no ray; `trace` goes through the lens.
    pub fn why_none<T>(&self, ray: FilmRays<f64>, trace: impl FnOnce(Ray) -> Result<T, Blocked>) -> Outcome {
        let FilmRays { point, disk, slopes, area_per_pi } = ray;
        if self.asks_again(disk) {
            return Outcome::Redraw;
        }
        if area_per_pi.is_nan() {
            return Outcome::Blocked(Blocked::Clipped);
        }
        // A ray within rounding of an edge may pass here.
        let traced = trace(film_ray(point, self.film_side.z, slopes));
        Outcome::Blocked(traced.err().unwrap_or(Blocked::Clipped))
    }

    /// Returns the whole body in a precision.
    pub fn lane_body<S: KernelScalar>(&self) -> LaneBody<S> {
        LaneBody {
            film: self.film_sampling(),
            film_z: self.film_side.z,
            weight: self.weight.map(|weight| S::from_f64(PI * weight)),
            to_world: ToWorld::new(&self.placement, self.units_per_mm),
        }
    }
}

/// [`CameraBody`] for lanes of a precision. The type does not depend on the lens's tracer, so that code for it is
/// compiled once.
pub(crate) struct LaneBody<S> {
    pub film: FilmSampling<S>,
    /// z of the film, lens space, mm.
    pub film_z: f64,
    /// Factor of a ray's weight, times cos⁴ and the slope area over π per sample; `None` for weight 1. The sampler
    /// divides areas by π, so that a disk's area is its radius squared; this factor contains the π.
    pub weight: Option<S>,
    pub to_world: ToWorld<S>,
}
