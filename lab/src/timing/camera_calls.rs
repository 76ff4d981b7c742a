//! The two ways of asking a camera whose times are compared, a block of samples in one call and one call after the other; and
//! what it is asked.

use std::hint::black_box;

use realistic::unstable::camera::{Raster, RayArrays, RayBlock, Sample, SampleArrays, SampleBlock};

use crate::{BLOCK, subject::quasirandom::spread};

/// Samples nearly evenly spread over an image, its pupils and the time that the shutter is open. Another `shift` gives others.
pub fn samples<const N: usize>(Raster { xres, yres }: Raster, shift: f64) -> Box<SampleBlock<N>> {
    let mut block = Box::new(SampleBlock::<N>::new());
    let across = |share: f64, pixels: u32| (f64::from(pixels) * share) as f32;
    for (i, [x, y, u, v, time]) in spread::<5>(shift).take(N).enumerate() {
        let (image_x, image_y) = (across(x, xres), across(y, yres));
        let [lens_u, lens_v, time] = [u, v, time].map(|number| number as f32);
        block.set(i, &Sample { image_x, image_y, lens_u, lens_v, time });
    }
    block
}

/// Asks for the rays of a block of samples in one call, `rays`.
pub fn in_one_call(samples: &SampleBlock<BLOCK>, rays: impl FnOnce(&SampleArrays<'_>, &mut RayArrays<'_>)) {
    let mut found = RayBlock::<BLOCK>::new();
    rays(&samples.arrays(BLOCK), &mut found.arrays(BLOCK));
    black_box(&found);
}

/// Asks for the rays of a block of samples one by one, each of which waits for the one before. `ray` makes one, and tells its
/// weight.
pub fn one_by_one(samples: &SampleBlock<BLOCK>, ray: impl Fn(&Sample) -> Option<f32>) {
    let mut carry = 0.0;
    for i in 0..BLOCK {
        let mut sample = samples.arrays(BLOCK).get(i);
        // Too little to change the sum: each ray waits for the one before.
        sample.image_x += carry;
        carry = ray(&sample).map_or(0.0, |weight| weight * 1e-30);
    }
    black_box(carry);
}
