//! Rays of many samples at once.

use crate::camera::{RayArrays, RealisticCamera, SampleArrays};

impl RealisticCamera {
    /// [`RealisticCamera::ray`] of many samples, the same to the last bit. Where there is no ray the weight is 0, and
    /// the other numbers are left as they are.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn rays(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        let n = samples.checked_len();
        assert_eq!(n, rays.checked_len(), "a batch needs as much room as it has samples");
        if !self.tracer.many(samples, rays) {
            return (0..n).for_each(|i| rays.set(i, self.ray(&samples.get(i))));
        }
        let placement = self.placement();
        let RayArrays { mint, maxt, time, weight, .. } = rays;
        for (array, end) in [(mint, placement.clip[0]), (maxt, placement.clip[1])] {
            if let Some(array) = array {
                fill(array, weight, weight, |_| end);
            }
        }
        if let Some(time) = time {
            fill(time, weight, samples.time, |number| placement.time(number));
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
