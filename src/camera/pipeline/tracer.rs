//! What a camera asks of whatever traces its lens.

use std::fmt;

use super::arrays::{OneRay, RayArrays, RayBlock, SampleArrays, SampleBlock};
use crate::{
    camera::ray::Sample,
    sampling::film_rays::FilmRays,
    trace::{Blocked, Ray},
};

/// A lens between a film and the world, compiled for one way of tracing.
pub(crate) trait Tracer: Send + Sync {
    /// Writes origin, direction and weight of a sample's ray. Of a blocked one only the weight is written, 0.
    fn one(&self, sample: &Sample, ray: &mut OneRay<'_>);

    /// [`Tracer::one`] of four samples side by side, the same to the last bit; `false`, and nothing done, where that takes
    /// as long as one after the other.
    fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool;

    /// [`Tracer::one`] of many samples, the same to the last bit, in arrays that all have one length.
    fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>);

    /// The film ray that a sample asks for.
    fn film_ray(&self, sample: &Sample) -> FilmRays<f64>;

    /// Why a ray from the film that does not get through is blocked.
    fn reason(&self, ray: Ray) -> Blocked;
}

impl fmt::Debug for dyn Tracer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Tracer")
    }
}
