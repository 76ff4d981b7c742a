//! What a camera asks of whatever makes its rays: at its own wavelength, and at a wavelength per ray.

use std::fmt;

use super::arrays::{OneRay, RayArrays, RayBlock, SampleArrays, SampleBlock};
use crate::{
    camera::ray::Sample,
    sampling::film_rays::FilmRays,
    trace::{Blocked, Ray},
};

/// A camera model from sample to world ray, compiled for one way of tracing.
pub(crate) trait Tracer: Send + Sync {
    /// Writes origin, direction and weight of a sample's ray, and where the model has a say in it its range. Of a blocked
    /// one only the weight is written, 0.
    fn one(&self, sample: &Sample, ray: &mut OneRay<'_>);

    /// [`Tracer::one`] of four samples side by side, the same to the last bit; `false`, and nothing done, where that takes
    /// as long as one after the other.
    fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool;

    /// [`Tracer::one`] of many samples, the same to the last bit, in arrays that all have one length.
    fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>);

    /// Whether rays get their range here. Else it is the camera's clip range.
    fn writes_range(&self) -> bool {
        false
    }
}

/// A [`Tracer`] of a lens that blocks rays.
pub(crate) trait LensTracer: Tracer {
    /// The film ray that a sample asks for.
    fn film_ray(&self, sample: &Sample) -> FilmRays<f64>;

    /// Why a ray from the film, which a sample asks for and which does not get through, is blocked.
    fn reason(&self, sample: &Sample, ray: Ray) -> Blocked;
}

/// A lens from sample and wavelength (nm) to world ray. Where there is no ray only the weight is written, 0; so at
/// wavelengths at which the lens has no rays.
pub(crate) trait SpectralTracer: Send + Sync {
    /// Writes origin, direction and weight of a sample's ray.
    fn one(&self, sample: &Sample, wavelength: f32, ray: &mut OneRay<'_>);

    /// [`SpectralTracer::one`] of four samples side by side, the same to the last bit.
    fn four(&self, samples: &SampleBlock<4>, wavelengths: &[f32; 4], rays: &mut RayBlock<4>);

    /// [`SpectralTracer::one`] of many samples, the same to the last bit, in arrays that all have one length.
    fn many(&self, samples: &SampleArrays<'_>, wavelengths: &[f32], rays: &mut RayArrays<'_>);

    /// The film ray that a sample asks for.
    fn film_ray(&self, sample: &Sample, wavelength: f32) -> FilmRays<f64>;
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
