//! Comparisons of rays of the C ABI to the last bit.

use realistic::ffi::realistic_ray;

/// The content of a ray that was not written.
pub const UNTOUCHED: realistic_ray =
    realistic_ray { o: [-77.0; 3], d: [-78.0; 3], mint: -79.0, maxt: -80.0, time: -81.0 };

/// The bits of a ray and its weight.
pub type Bits = [u32; 10];

/// Returns the [`Bits`] of a ray.
pub fn bits(ray: &realistic_ray, weight: f32) -> Bits {
    let realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time } = *ray;
    [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight].map(f32::to_bits)
}
