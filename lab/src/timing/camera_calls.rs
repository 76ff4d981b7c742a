//! The two kinds of camera calls whose times are compared: one call for a block of samples, and one call per sample;
//! and the samples for them.

use std::hint::black_box;

use crate::columns::{RayColumns, SampleColumns};
use realistic_camera::{Raster, Rays, Sample, Samples};

use crate::{BLOCK, subject::quasirandom::spread};

/// Returns samples that are nearly evenly spread over an image, its pupils and the exposure time. Another `shift` gives
/// other samples.
pub fn samples(count: usize, Raster { xres, yres }: Raster, shift: f64) -> SampleColumns {
    let mut block = SampleColumns::new(count);
    let across = |share: f64, pixels: u32| (f64::from(pixels) * share) as f32;
    for (i, [x, y, u, v, time]) in spread::<5>(shift).take(count).enumerate() {
        let (image_x, image_y) = (across(x, xres), across(y, yres));
        let [lens_u, lens_v, time] = [u, v, time].map(|number| number as f32);
        block.set(i, &Sample { image_x, image_y, lens_u, lens_v, time });
    }
    block
}

/// Requests the rays of a block of samples in one call, `rays`.
pub fn in_one_call(samples: &SampleColumns, rays: impl FnOnce(&Samples<'_>, &mut Rays<'_>)) {
    let mut found = RayColumns::new(BLOCK);
    rays(&samples.first(BLOCK), &mut found.first(BLOCK));
    black_box(&found);
}

/// Requests the rays of a block of samples one by one, each waiting for the previous one. `ray` generates one ray and
/// returns its weight.
pub fn one_by_one(samples: &SampleColumns, ray: impl Fn(&Sample) -> Option<f32>) {
    let mut carry = 0.0;
    for i in 0..BLOCK {
        let mut sample = samples.first(BLOCK).get(i);
        // The carry is too small to change the sum, but makes each ray wait for the previous one.
        sample.image_x += carry;
        carry = ray(&sample).map_or(0.0, |weight| weight * 1e-30);
    }
    black_box(carry);
}
