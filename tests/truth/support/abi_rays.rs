//! Rays of the C ABI to the last bit.

use realistic::unstable::abi::realistic_ray;

/// What stands in a ray that nobody writes.
pub const UNTOUCHED: realistic_ray =
    realistic_ray { o: [-77.0; 3], d: [-78.0; 3], mint: -79.0, maxt: -80.0, time: -81.0 };

/// A ray and its weight, to the last bit.
pub type Bits = [u32; 10];

/// [`Bits`] of a ray.
pub fn bits(ray: &realistic_ray, weight: f32) -> Bits {
    let realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time } = *ray;
    [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight].map(f32::to_bits)
}
