//! A camera's rays, complete: those of its own wavelength or of the samples' own, with the ranges and the times that the tracer
//! leaves to do.

use std::sync::Arc;

use super::{
    spectral::{Spectral, WAVELENGTHS},
    tracer::Tracer,
};
use crate::{
    camera::{
        placement::Placement,
        rays::{Rays, Sample, Samples, WAVELENGTH, WorldRay},
    },
    plan::Entry,
};

/// What makes the rays of a camera of any model. Where there is no ray the weight is 0, and the other numbers are left as
/// they are.
#[derive(Clone, Debug)]
pub(crate) struct RayMaker {
    /// Of single calls.
    one: Arc<dyn Tracer>,
    /// Of batches: the same, but where a tolerance lets another be faster.
    many: Arc<dyn Tracer>,
    placement: Placement,
    /// Where all rays begin and end; `None` where the tracer says it of each.
    range: Option<[f32; 2]>,
    /// What traces at wavelengths of their own; `None`: they change nothing.
    spectral: Option<Arc<Spectral>>,
}

impl RayMaker {
    pub fn new(one: Arc<dyn Tracer>, many: Arc<dyn Tracer>, placement: Placement) -> Self {
        let range = (!one.writes_range()).then_some(placement.clip);
        Self { one, many, placement, range, spectral: None }
    }

    /// Has wavelengths matter.
    pub fn set_spectral(&mut self, spectral: Spectral) {
        self.spectral = Some(Arc::new(spectral));
    }

    /// What traces at wavelengths of their own, where they matter.
    pub fn spectral(&self) -> Option<&Spectral> {
        self.spectral.as_deref()
    }

    /// Where the camera stands, its clip range and when its shutter is open.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Whether there are rays at a wavelength, nm.
    pub fn has_wavelength(&self, wavelength: f32) -> bool {
        self.spectral().map_or(&WAVELENGTHS, Spectral::range).contains(&wavelength)
    }

    /// Whether the tracer minds wavelengths itself, or there are rays at all of these, which are slices.
    pub fn has_all(&self, samples: &Samples<'_>) -> bool {
        let is_inside = |all, nm: &f32| all & WAVELENGTHS.contains(nm);
        self.spectral().is_some() || samples.column(WAVELENGTH).iter().fold(true, is_inside)
    }

    /// Whether four rays take less time in one call than in four.
    pub fn gains_by_four(&self) -> bool {
        self.one.gains_by_four()
    }

    /// The ray of a sample with its weight, positive; `None` where there is none.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.trace(Entry::One, &Samples::of(sample), &mut Rays::of(&mut ray, &mut weight));
        (weight > 0.0).then_some((ray, weight))
    }

    /// Makes a ray of each sample. The columns are slices. Of a camera whose rays wavelengths do not change they are ignored.
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
