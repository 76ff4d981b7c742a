//! What a camera asks of whatever traces its lens.

use std::fmt;

use super::arrays::{RayArrays, SampleArrays};
use crate::{
    camera::ray::Sample,
    sampling::film_rays::FilmRays,
    trace::{Blocked, Ray, kernel::Grouping},
};

/// A lens between a film and the world, compiled for one way of tracing.
pub(crate) trait Tracer: Send + Sync {
    /// Writes origins, directions and weights of samples' rays, in arrays that all have one length. Of a ray that is
    /// blocked only the weight is written, 0. The shape changes no bit.
    fn trace(&self, shape: Grouping, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>);

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
