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
    /// Traces batches: the same tracer, unless a tolerance allows a faster one.
    many: Arc<dyn Tracer>,
    placement: Placement,
    /// Start and end of all rays; `None` if the tracer writes those of each.
    range: Option<[f32; 2]>,
    /// Traces rays at wavelengths of their own; `None` if wavelengths change nothing.
    spectral: Option<Arc<Spectral>>,
}

impl RayMaker {
    pub fn new(one: Arc<dyn Tracer>, many: Arc<dyn Tracer>, placement: Placement) -> Self {
        let range = (!one.writes_range()).then_some(placement.clip);
        Self { one, many, placement, range, spectral: None }
    }

    /// Makes the rays depend on wavelengths.
    pub fn set_spectral(&mut self, spectral: Spectral) {
        self.spectral = Some(Arc::new(spectral));
    }

    /// Returns the tracer of rays at wavelengths of their own, if wavelengths matter.
    pub fn spectral(&self) -> Option<&Spectral> {
        self.spectral.as_deref()
    }

    /// Returns the camera's pose, its clip range and its shutter interval.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Whether there are rays at a wavelength, nm.
    pub fn has_wavelength(&self, wavelength: f32) -> bool {
        self.spectral().map_or(&WAVELENGTHS, Spectral::range).contains(&wavelength)
    }

    /// Whether the tracer handles wavelengths itself, or all wavelengths of the samples have rays. The columns are
    /// slices.
    pub fn has_all(&self, samples: &Samples<'_>) -> bool {
        let is_inside = |all, nm: &f32| all & WAVELENGTHS.contains(nm);
        self.spectral().is_some() || samples.column(WAVELENGTH).iter().fold(true, is_inside)
    }

    /// Whether four rays take less time in one call than in four.
    pub fn gains_by_four(&self) -> bool {
        self.one.gains_by_four()
    }

    /// Returns the ray of a sample with its weight, positive; `None` for a blocked sample.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.trace(Entry::One, &Samples::of(sample), &mut Rays::of(&mut ray, &mut weight));
        (weight > 0.0).then_some((ray, weight))
    }

    /// Makes a ray of each sample. The columns are slices. Wavelengths are ignored if they do not change the camera's
    /// rays.
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
