//! A caller's structures of arrays: which arrays there must be, and as columns.

use super::{
    super::{
        boundary::{self, Failure},
        exchange::required_arrays,
        object::{self, Handle},
        types::{realistic_camera, realistic_rays_soa, realistic_samples_soa},
    },
    columns::{Column, ColumnMut},
};

/// The names of samples' arrays.
pub(super) const SAMPLES: [&str; 5] = ["image_x", "image_y", "lens_u", "lens_v", "time"];
/// The names of rays' arrays that must be there.
pub(super) const RAYS: [&str; 7] = ["ox", "oy", "oz", "dx", "dy", "dz", "weight"];

/// The arrays of samples.
#[inline(always)]
pub(super) fn samples_of(samples: &realistic_samples_soa) -> [*const f32; 5] {
    [samples.image_x, samples.image_y, samples.lens_u, samples.lens_v, samples.time]
}

/// The arrays of rays that must be there.
#[inline(always)]
pub(super) fn rays_of(rays: &realistic_rays_soa) -> [*mut f32; 7] {
    [rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz, rays.weight]
}

/// The samples in a caller's arrays.
pub(super) fn sample_columns(samples: &realistic_samples_soa) -> [Column; 5] {
    samples_of(samples).map(Column::packed)
}

/// The room for rays in a caller's arrays.
pub(super) fn ray_columns(rays: &realistic_rays_soa) -> [ColumnMut; 10] {
    let [ox, oy, oz, dx, dy, dz, weight] = rays_of(rays);
    [ox, oy, oz, dx, dy, dz, rays.mint, rays.maxt, rays.time, weight].map(ColumnMut::packed)
}

/// The room for neighbours in a caller's arrays.
pub(super) fn neighbour_columns(rays: &realistic_rays_soa) -> [ColumnMut; 7] {
    rays_of(rays).map(ColumnMut::packed)
}

/// The camera and the structures of a call, which must be there with all arrays that must.
///
/// # Safety
/// The pointers are NULL or valid.
pub(super) unsafe fn arrays_of<'a>(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    rays: *const realistic_rays_soa,
) -> Result<(&'a Handle, &'a realistic_samples_soa, &'a realistic_rays_soa), Failure> {
    // SAFETY: the caller's promise for all three.
    let (handle, samples, rays) = unsafe { (object::handle_of(camera), samples.as_ref(), rays.as_ref()) };
    let handle = handle.ok_or_else(boundary::not_a_camera)?;
    let samples = samples.ok_or_else(|| boundary::null("samples"))?;
    let rays = rays.ok_or_else(|| boundary::null("rays"))?;
    boundary::fits_memory(n, size_of::<f32>())?;
    if n > 0 {
        required_arrays("samples", SAMPLES, samples_of(samples))?;
        required_arrays("rays", RAYS, rays_of(rays).map(|array| array.cast_const()))?;
    }
    Ok((handle, samples, rays))
}

/// Refuses an array that is NULL.
pub(super) fn required<T>(name: &str, array: *const T) -> Result<(), Failure> {
    if array.is_null() { Err(boundary::null(name)) } else { Ok(()) }
}

/// The bytes from one element to the next: those given, or for 0 the `size` of one.
pub(super) fn stride(name: &str, given: usize, size: usize, n: usize) -> Result<usize, Failure> {
    let stride = if given == 0 { size } else { given };
    if stride < size {
        return Err(Failure::invalid(format!("{name} is {given}; it must be 0 or at least {size} bytes")));
    }
    boundary::fits_memory(n, stride)?;
    Ok(stride)
}
