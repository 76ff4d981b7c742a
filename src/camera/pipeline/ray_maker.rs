//! A camera's rays, complete: one, four, many. What the tracer leaves to do is each ray's range and time.

use std::sync::Arc;

use super::{
    arrays::{OneRay, RayArrays, RayBlock, SampleArrays, SampleBlock, SampleStore},
    spectral::{Spectral, WAVELENGTHS},
    tracer::Tracer,
};
use crate::camera::{
    placement::Placement,
    ray::{Sample, WorldRay},
};

/// What makes the rays of a camera of any model. Where there is no ray the weight is 0, and the other numbers are left as
/// they are.
#[derive(Clone, Debug)]
pub(crate) struct RayMaker {
    /// Of rays one by one, and four side by side.
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

    /// Where all rays begin and end; `None` where each has a range of its own.
    #[inline]
    pub fn range(&self) -> Option<[f32; 2]> {
        self.range
    }

    /// The ray of a sample with its weight, positive; `None` where there is none.
    pub fn ray(&self, sample: &Sample) -> Option<(WorldRay, f32)> {
        let (mut ray, mut weight) = Default::default();
        self.one(sample, &mut ray, &mut weight);
        (weight > 0.0).then_some((ray, weight))
    }

    /// Writes a sample's ray and its weight.
    #[inline(always)]
    pub fn one(&self, sample: &Sample, ray: &mut WorldRay, weight: &mut f32) {
        self.one.one(sample, &mut OneRay { ray: &mut *ray, weight: &mut *weight });
        self.complete_one(sample, ray, *weight);
    }

    /// [`RayMaker::one`] of four samples of one time side by side, the same to the last bit; `false`, and nothing done,
    /// where that takes as long as one after the other.
    #[inline]
    pub fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        let made = self.one.four(samples, rays);
        if made {
            self.complete_four(samples.sample(0).time, rays);
        }
        made
    }

    /// [`RayMaker::one`] of many samples, the same to the last bit, in arrays that all have one length.
    #[inline]
    pub fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        self.many.many(samples, rays);
        self.complete(samples, rays);
    }

    /// Gives a ray its range and time, where there is one.
    #[inline(always)]
    fn complete_one(&self, sample: &Sample, ray: &mut WorldRay, weight: f32) {
        if weight > 0.0 {
            if let Some(range) = self.range {
                [ray.mint, ray.maxt] = range;
            }
            ray.time = self.placement.time(sample.time);
        }
    }

    /// Gives four rays of one time their ranges and that time.
    #[inline(always)]
    fn complete_four(&self, time: f32, rays: &mut RayBlock<4>) {
        if let Some(range) = self.range {
            rays.set_range(range);
        }
        rays.set_time(self.placement.time(time));
    }

    /// Gives many rays their ranges and times.
    #[inline(always)]
    fn complete(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        let RayArrays { mint, maxt, time, weight, .. } = rays;
        if let Some([first, last]) = self.range {
            for (array, end) in [(mint, first), (maxt, last)] {
                if let Some(array) = array {
                    fill(array, weight, weight, |_| end);
                }
            }
        }
        if let Some(time) = time {
            fill(time, weight, samples.time, |number| self.placement.time(number));
        }
    }
}

/// Rays at wavelengths of their own, nm.
impl RayMaker {
    /// Whether there are rays at a wavelength.
    pub fn has_wavelength(&self, wavelength: f32) -> bool {
        self.spectral().map_or(&WAVELENGTHS, Spectral::range).contains(&wavelength)
    }

    /// [`RayMaker::ray`] where wavelengths change nothing but whether there is a ray.
    fn ray_at(&self, sample: &Sample, wavelength: f32) -> Option<(WorldRay, f32)> {
        if self.has_wavelength(wavelength) { self.ray(sample) } else { None }
    }

    /// [`RayMaker::one`] at a wavelength.
    pub fn one_at(&self, sample: &Sample, wavelength: f32, ray: &mut WorldRay, weight: &mut f32) {
        *weight = 0.0;
        if let Some(spectral) = self.spectral() {
            spectral.tracer().one(sample, wavelength, &mut OneRay { ray: &mut *ray, weight: &mut *weight });
            self.complete_one(sample, ray, *weight);
        } else if self.has_wavelength(wavelength) {
            self.one(sample, ray, weight);
        }
    }

    /// Four rays of samples of one time, each at its own wavelength: the bits of [`RayMaker::one_at`].
    pub fn four_at(&self, samples: &SampleBlock<4>, wavelengths: &[f32; 4], rays: &mut RayBlock<4>) {
        if let Some(spectral) = self.spectral() {
            spectral.tracer().four(samples, wavelengths, rays);
            self.complete_four(samples.sample(0).time, rays);
            return;
        }
        let traced = self.four(samples, rays);
        for (i, wavelength) in wavelengths.iter().enumerate() {
            if !traced {
                rays.arrays(4).set(i, self.ray(&samples.sample(i)));
            }
            if !self.has_wavelength(*wavelength) {
                rays.arrays(4).weight[i] = 0.0;
            }
        }
    }

    /// [`RayMaker::one_at`] of many samples, the same to the last bit, in arrays that all have one length.
    pub fn many_at(&self, samples: &SampleArrays<'_>, wavelengths: &[f32], rays: &mut RayArrays<'_>) {
        match self.spectral() {
            Some(spectral) => {
                spectral.tracer().many(samples, wavelengths, rays);
                self.complete(samples, rays);
            }
            None if wavelengths.iter().all(|wavelength| self.has_wavelength(*wavelength)) => {
                self.many(samples, rays)
            }
            None => {
                for (i, wavelength) in wavelengths.iter().enumerate() {
                    rays.set(i, self.ray_at(&samples.sample(i), *wavelength));
                }
            }
        }
    }
}

/// Writes what `number` makes of each of `of`, where there is a ray. Without a branch, so that the compiler makes vectors
/// of it.
#[inline(always)]
fn fill(array: &mut [f32], weight: &[f32], of: &[f32], number: impl Fn(f32) -> f32) {
    for ((to, weight), of) in array.iter_mut().zip(weight).zip(of) {
        let number = number(*of);
        *to = if *weight > 0.0 { number } else { *to };
    }
}
