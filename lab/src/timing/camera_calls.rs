//! The two ways of asking a camera whose times are compared: a block of samples in one call, and one call after the other.

use std::hint::black_box;

use realistic::unstable::camera::{RayBlock, RealisticCamera, SampleBlock};

use crate::BLOCK;

/// Asks for the rays of a block of samples in one call.
pub fn in_one_call(camera: &RealisticCamera, samples: &SampleBlock<BLOCK>) {
    let mut rays = RayBlock::<BLOCK>::new();
    camera.rays(&samples.arrays(BLOCK), &mut rays.arrays(BLOCK));
    black_box(&rays);
}

/// Asks for the rays of a block of samples one by one, each of which waits for the one before.
pub fn one_by_one(camera: &RealisticCamera, samples: &SampleBlock<BLOCK>) {
    let mut carry = 0.0;
    for i in 0..BLOCK {
        let mut sample = samples.arrays(BLOCK).get(i);
        // Too little to change the sum: each ray waits for the one before.
        sample.image_x += carry;
        carry = camera.ray(&sample).map_or(0.0, |(_, weight)| weight * 1e-30);
    }
    black_box(carry);
}
