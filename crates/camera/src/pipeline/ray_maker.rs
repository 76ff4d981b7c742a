//! A camera's complete rays, at its own wavelength or at the samples' wavelengths, with the ranges and times that the
//! tracer does not write.

use std::sync::Arc;

use super::{
    spectral::{Spectral, WAVELENGTHS},
    tracer::Tracer,
};
use crate::{
    placement::Placement,
    plan::Entry,
    rays::{Rays, WorldRay},
    samples::{Sample, Samples, WAVELENGTH},
};

/// Makes the rays of a camera of any model. The weight of a blocked ray is 0, and its other numbers are left unchanged.
#[derive(Clone, Debug)]
pub struct RayMaker {
    /// Traces the rays of single calls.
    one: Arc<dyn Tracer>,
    /// Traces batches with the same tracer, unless a tolerance allows a faster one.
    many: Arc<dyn Tracer>,
    placement: Placement,
    /// Start and end common to all rays; `None` if the tracer writes start and end of each ray.
    range: Option<[f32; 2]>,
    /// Traces rays with wavelengths of their own; `None` if wavelengths do not change the rays.
    spectral: Option<Arc<Spectral>>,
}

impl RayMaker {
    pub fn new(one: Arc<dyn Tracer>, many: Arc<dyn Tracer>, placement: Placement) -> Self {
        let range = (!one.writes_range()).then_some(placement.clip);
        Self { one, many, placement, range, spectral: None }
    }

    /// Makes the rays depend on their wavelengths.
    pub fn set_spectral(&mut self, spectral: Spectral) {
        self.spectral = Some(Arc::new(spectral));
    }

    /// Returns the tracer of rays with wavelengths of their own; `None` if wavelengths do not change the
    /// rays.
    pub fn spectral(&self) -> Option<&Spectral> {
        self.spectral.as_deref()
    }

    /// Returns the camera's pose, its clip range and its shutter interval.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Whether the camera has rays at a wavelength, nm.
    pub fn has_wavelength(&self, wavelength: f32) -> bool {
        self.spectral().map_or(&WAVELENGTHS, Spectral::range).contains(&wavelength)
    }

    /// Whether the tracer checks wavelengths itself, or there are rays at all wavelengths of the samples. The
    /// columns are slices.
    pub fn has_all(&self, samples: &Samples<'_>) -> bool {
        let is_inside = |all, nm: &f32| all & WAVELENGTHS.contains(nm);
        self.spectral().is_some() || samples.column(WAVELENGTH).iter().fold(true, is_inside)
    }

    /// Whether tracing four rays in one call takes less time than in four calls.
    pub fn gains_by_four(&self) -> bool {
        self.one.gains_by_four()
    }

    /// Returns the ray of a sample and its weight, which is positive; `None` for a blocked sample.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.trace(Entry::One, &Samples::of(sample), &mut Rays::of(&mut ray, &mut weight));
        (weight > 0.0).then_some((ray, weight))
    }

    /// Makes a ray for each sample. All columns are slices. Wavelengths are ignored if they do not change the
    /// camera's rays.
    #[inline(always)]
    pub fn trace(&self, entry: Entry, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        match (self.spectral(), entry) {
            (Some(spectral), _) if samples.have_wavelengths() => spectral.tracer().trace(samples, rays),
            (_, Entry::One) => self.one.trace(samples, rays),
            (_, Entry::Many) => self.many.trace(samples, rays),
        }
        rays.complete(self.range, samples.column(4), |number| self.placement.time(number));
    }
}
