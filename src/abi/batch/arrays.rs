//! A caller's arrays: which there must be, and as slices.

use std::slice;

use super::super::{
    boundary::{self, Failure},
    types::{realistic_rays_soa, realistic_samples_soa},
};
use crate::camera::{NeighbourArrays, RayArrays, SampleArrays};

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

/// All arrays of rays but the weights, in the order of a ray's numbers.
#[inline(always)]
pub(super) fn columns_of(rays: &realistic_rays_soa) -> [*mut f32; 9] {
    [rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz, rays.mint, rays.maxt, rays.time]
}

/// Whether all arrays of rays begin where floats may.
#[inline(always)]
pub(super) fn are_aligned(rays: &realistic_rays_soa) -> bool {
    columns_of(rays).iter().all(|array| array.is_aligned()) && rays.weight.is_aligned()
}

/// The samples in a caller's arrays.
///
/// # Safety
/// The arrays are aligned and of `n` elements that nobody writes.
#[inline(always)]
pub(super) unsafe fn sample_arrays<'a>(samples: &realistic_samples_soa, n: usize) -> SampleArrays<'a> {
    // SAFETY: the caller's promise.
    let [image_x, image_y, lens_u, lens_v, time] =
        samples_of(samples).map(|array| unsafe { slice::from_raw_parts(array, n) });
    SampleArrays { image_x, image_y, lens_u, lens_v, time }
}

/// Room for rays in a caller's arrays.
///
/// # Safety
/// The arrays are aligned and of `n` elements that nothing else refers to, or NULL if they need not be there.
#[inline(always)]
pub(super) unsafe fn ray_arrays<'a>(rays: &realistic_rays_soa, n: usize) -> RayArrays<'a> {
    // SAFETY: the caller's promise.
    let room = |array: *mut f32| unsafe { slice::from_raw_parts_mut(array, n) };
    let [ox, oy, oz, dx, dy, dz, weight] = rays_of(rays).map(room);
    let [mint, maxt, time] =
        [rays.mint, rays.maxt, rays.time].map(|array| (!array.is_null()).then(|| room(array)));
    RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
}

/// Room for neighbours in a caller's arrays.
///
/// # Safety
/// The arrays are aligned and of `n` elements that nothing else refers to.
pub(super) unsafe fn neighbour_arrays<'a>(rays: &realistic_rays_soa, n: usize) -> NeighbourArrays<'a> {
    // SAFETY: the caller's promise.
    let room = |array: *mut f32| unsafe { slice::from_raw_parts_mut(array, n) };
    let [ox, oy, oz, dx, dy, dz, weight] = rays_of(rays).map(room);
    NeighbourArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], weight }
}

/// Refuses a structure of which one of these arrays is NULL.
#[inline(always)]
pub(super) fn required_arrays<const N: usize>(
    structure: &str,
    names: [&str; N],
    arrays: [*const f32; N],
) -> Result<(), Failure> {
    match arrays.iter().position(|array| array.is_null()) {
        Some(number) => Err(boundary::null(&format!("{structure}.{}", names[number]))),
        None => Ok(()),
    }
}

/// Refuses an array that is NULL.
pub(super) fn required<T>(name: &str, array: *const T) -> Result<(), Failure> {
    if array.is_null() { Err(boundary::null(name)) } else { Ok(()) }
}

/// The bytes from one element to the next: those given, or for 0 the `size` of one.
pub(super) fn stride(name: &str, given: usize, size: usize, n: usize) -> Result<usize, Failure> {
    let stride = if given == 0 { size } else { given };
    let wrong = if stride < size {
        format!("{name} is {given}; it must be 0 or at least {size} bytes")
    } else if stride.checked_mul(n).is_none_or(|bytes| isize::try_from(bytes).is_err()) {
        format!("n is {n}: no memory holds so many elements of {stride} bytes")
    } else {
        return Ok(stride);
    };
    Err(Failure::invalid(wrong))
}
