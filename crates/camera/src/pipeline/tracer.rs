//! The interface of the tracers of a camera's rays.

use std::fmt;

use crate::{
    rays::Rays,
    samples::{Sample, Samples},
    sampling::film_rays::FilmRays,
};

/// A camera model compiled for one method of tracing, which makes world rays from samples. The columns of
/// samples and rays are slices.
pub trait Tracer: Send + Sync {
    /// Writes the origin, direction and weight of each sample's ray, and the ray's range if the model
    /// determines it. For a blocked ray, only the weight 0 is written. The number of samples does not change
    /// any bit.
    fn trace(&self, samples: &Samples<'_>, rays: &mut Rays<'_>);

    /// Whether the tracer writes the ranges of rays. Otherwise the range is the camera's clip range.
    fn writes_range(&self) -> bool {
        false
    }

    /// Whether tracing four rays side by side takes less time than tracing them one after the other.
    fn gains_by_four(&self) -> bool {
        true
    }
}

/// A [`Tracer`] of rays that leave a film.
pub trait LensTracer: Tracer {
    /// Returns the film ray of a sample, at the wavelength `wavelength`, nm, if rays have wavelengths of
    /// their own.
    fn film_ray(&self, sample: &Sample, wavelength: Option<f32>) -> FilmRays<f64>;
}

impl fmt::Debug for dyn Tracer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Tracer")
    }
}

impl fmt::Debug for dyn LensTracer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LensTracer")
    }
}
