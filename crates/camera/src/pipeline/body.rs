//! A camera without its lens: the film and its sampler, the factor of a ray's weight, and the camera's pose.

use std::{f64::consts::PI, sync::Arc};

use super::film_sampling::FilmSampling;
use crate::{
    placement::{Placement, ToWorld},
    plan::FilmSide,
    rays::{Outcome, WorldRay},
    sampling::{DiskMapping, film_rays::FilmRays},
};
use realistic_optics::{
    lens::{cos4, film_ray},
    prescription::SurfaceCoating,
    trace::{Blocked, Ray},
};
use realistic_simd::{Cpu, Lanes};
use realistic_trace::kernel::{End, KernelScalar};

/// The parts of a camera on both sides of the lens: film and sampler behind it, pose in front of it.
#[derive(Clone, Debug)]
pub struct CameraBody {
    pub film_side: FilmSide,
    /// Factor from the product of cos⁴ and the slope area per sample to a ray's weight; `None` for weight 1.
    pub weight: Option<f64>,
    /// Coatings of the surfaces, from the scene on, if weights include the lens's transmission.
    pub coatings: Option<Arc<[SurfaceCoating]>>,
    pub placement: Placement,
    pub units_per_mm: f64,
}

impl CameraBody {
    /// Returns the sampling of the film in the precision `S`.
    pub fn film_sampling<S: KernelScalar>(&self) -> FilmSampling<S> {
        FilmSampling::new(&self.film_side)
    }

    /// Whether a film ray lacks a point of the unit disk because the mapping requests another lens sample.
    pub fn requests_redraw(&self, disk: [f64; 2]) -> bool {
        self.film_side.mapping == DiskMapping::Rejection && disk.iter().any(|x| x.is_nan())
    }

    /// Returns the reason why a film ray of the direct path gives no ray; `trace` traces a ray through the
    /// lens.
    pub fn why_none<T>(&self, ray: FilmRays<f64>, trace: impl FnOnce(Ray) -> Result<T, Blocked>) -> Outcome {
        let FilmRays { point, disk, slopes, area_per_pi } = ray;
        if self.requests_redraw(disk) {
            return Outcome::Redraw;
        }
        if area_per_pi.is_nan() {
            return Outcome::Blocked(Blocked::Clipped);
        }
        // A ray within rounding of an edge may be blocked in the camera's tracer but pass here.
        let traced = trace(film_ray(point, self.film_side.z, slopes));
        Outcome::Blocked(traced.err().unwrap_or(Blocked::Clipped))
    }

    /// Returns the world-space ray, with its weight, of a film ray that `ray` continues in front of the lens;
    /// `None` if the ray or the weight is out of range. `share` is the remaining fraction of the ray's light
    /// divided by the probability of its path.
    pub fn world_ray(
        &self,
        film_ray: &FilmRays<f64>,
        ray: Ray,
        share: f64,
        time: f32,
    ) -> Option<(WorldRay, f32)> {
        let FilmRays { slopes, area_per_pi, .. } = *film_ray;
        let weight =
            self.weight.map_or(1.0, |weight| weight * (PI * area_per_pi * cos4(slopes) * share)) as f32;
        let ray = self.placement.world_ray(ray, self.units_per_mm, time);
        let is_valid = share > 0.0 && ray.is_sound() && weight.is_finite();
        is_valid.then_some((ray, weight.max(f32::MIN_POSITIVE)))
    }

    /// Returns the whole body in the precision `S`.
    pub fn lane_body<S: KernelScalar>(&self) -> LaneBody<S> {
        LaneBody {
            film: self.film_sampling(),
            film_z: self.film_side.z,
            weight: self.weight.map(|weight| S::from_f64(PI * weight)),
            to_world: ToWorld::new(&self.placement, self.units_per_mm),
        }
    }
}

/// A [`CameraBody`] for lanes of one precision. The type does not depend on the lens's tracer, so that code
/// for it is compiled once.
pub struct LaneBody<S> {
    pub film: FilmSampling<S>,
    /// z of the film, lens space, mm.
    pub film_z: f64,
    /// Factor from the product of cos⁴ and the slope area per sample, divided by π, to a ray's weight; `None`
    /// for weight 1. The sampler divides areas by π, so that a disk's area is its radius squared; this factor
    /// contains the π.
    pub weight: Option<S>,
    pub to_world: ToWorld<S>,
}

impl<S: KernelScalar> LaneBody<S> {
    /// Returns the weights of rays, given the slope area that each represents, and the mask of the rays that
    /// have a weight.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn weights<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, end: &End<L>, area_per_pi: L) -> (L, L::Mask) {
        let End { passed, weight_root, left, .. } = *end;
        // This comparison is false for NaN.
        let passed = L::both(passed, area_per_pi.less_equal(area_per_pi));
        let weight = match self.weight {
            // The weight of a ray that passes must not underflow to 0, the weight of a blocked ray.
            Some(weight) => ((weight_root * weight_root) * ((area_per_pi * left) * L::splat(cpu, weight)))
                .larger(L::splat(cpu, S::from_f64(f32::MIN_POSITIVE.into()))),
            None => L::splat(cpu, S::ONE),
        };
        (weight, L::both(passed, weight.less_equal(L::splat(cpu, S::from_f64(f32::MAX.into())))))
    }
}
