//! What a camera asks of whatever makes its rays at wavelengths of their own.

use crate::{
    camera::{
        pipeline::arrays::{OneRay, RayArrays, RayBlock, SampleArrays, SampleBlock},
        ray::Sample,
    },
    sampling::film_rays::FilmRays,
};

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
