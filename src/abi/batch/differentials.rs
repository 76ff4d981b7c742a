//! Many rays with their differentials in one call.

use std::mem::size_of;

use super::{
    super::{
        boundary::{self, Failure, realistic_status},
        exchange::{check_size, required_arrays},
        object,
        types::{
            realistic_camera, realistic_ray_differential, realistic_rays_soa, realistic_reason,
            realistic_sample, realistic_samples_soa,
        },
    },
    arrays::{RAYS, arrays_of, neighbour_columns, rays_of, required, stride},
    blocks::{DifferentialRoom, in_blocks},
    columns::{Column, Reasons},
    request::Request,
    structures::{DifferentialStructures, SampleStructures},
};

/// Rays with differentials of `n` samples, the same as by `realistic_generate_ray_differential`. Strides, alignment,
/// `weights` and `reasons` as in `realistic_camera_generate_rays`. `struct_size` must be set in the first of `rays`; a
/// `ray_stride` of 0 is that size.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; the arrays have room for `n` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_ray_differentials(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_sample,
    sample_stride: usize,
    rays: *mut realistic_ray_differential,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_status {
    const SIZE: usize = size_of::<realistic_ray_differential>();
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let handle = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?;
        let sample_stride = stride("sample_stride", sample_stride, size_of::<realistic_sample>(), n)?;
        let ray_stride = stride("ray_stride", ray_stride, SIZE, n)?;
        if n == 0 {
            return Ok(());
        }
        required("samples", samples)?;
        required("rays", rays)?;
        required("weights", weights)?;
        // SAFETY: not NULL; the first field is always there.
        let size = unsafe { (&raw const (*rays).struct_size).read_unaligned() };
        check_size("realistic_ray_differential", size, SIZE, SIZE)?;
        let samples = SampleStructures { first: samples, stride: sample_stride };
        let rays = DifferentialStructures { first: rays, stride: ray_stride };
        // SAFETY: the arrays have room for `n` elements, and i * stride does not overflow.
        unsafe {
            in_blocks::<DifferentialRoom>(
                handle,
                n,
                |first, count, room| samples.read(first, count, room),
                |first, count, room| rays.write(first, count, room),
                weights,
                Reasons::packed(reasons),
            );
        }
        Ok(())
    })
}

/// Rays with differentials of `n` samples given and taken as structure of arrays: `rays` as in
/// `realistic_camera_generate_rays_soa`, `rx` one pixel to the right, `ry` one pixel down. Of `rx` and `ry` the origins,
/// directions and weights are written, and the other arrays may be NULL: where a weight is positive there is that
/// neighbour; where the lens blocks it the weight is 0 and the ray's own origin and direction stand in its place; where
/// the ray itself is blocked the three weights are 0 and the other numbers are left as they are.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; `samples`, `rays`, `rx` and `ry` are NULL or valid, and
/// their arrays are NULL or have room for `n` elements and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_ray_differentials_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    rays: *const realistic_rays_soa,
    rx: *const realistic_rays_soa,
    ry: *const realistic_rays_soa,
) -> realistic_status {
    // SAFETY: the caller's promise.
    boundary::status(|| unsafe { in_arrays(camera, n, samples, None, rays, [rx, ry]) })
}

/// Rays with differentials of `n` samples, each at its own wavelength (`n` of them, nm), the same as by
/// `realistic_generate_ray_differential_at`. With `wavelengths_nm` NULL every ray is at the camera's own wavelength, and the
/// call is `realistic_camera_generate_ray_differentials_soa`. All else as there.
///
/// # Safety
/// As `realistic_camera_generate_ray_differentials_soa`; `wavelengths_nm` is NULL or has `n` elements, and does not overlap
/// the other arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_ray_differentials_at_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    wavelengths_nm: *const f32,
    rays: *const realistic_rays_soa,
    rx: *const realistic_rays_soa,
    ry: *const realistic_rays_soa,
) -> realistic_status {
    let wavelengths = (!wavelengths_nm.is_null()).then(|| Column::packed(wavelengths_nm));
    // SAFETY: the caller's promise.
    boundary::status(|| unsafe { in_arrays(camera, n, samples, wavelengths, rays, [rx, ry]) })
}

/// Rays and their neighbours in a caller's arrays.
///
/// # Safety
/// As [`realistic_camera_generate_ray_differentials_at_soa`].
unsafe fn in_arrays(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    wavelengths: Option<Column>,
    rays: *const realistic_rays_soa,
    [rx, ry]: [*const realistic_rays_soa; 2],
) -> Result<(), Failure> {
    // SAFETY: the caller's promise for all.
    unsafe {
        let (handle, samples, rays) = arrays_of(camera, n, samples, rays)?;
        let rx = rx.as_ref().ok_or_else(|| boundary::null("rx"))?;
        let ry = ry.as_ref().ok_or_else(|| boundary::null("ry"))?;
        if n > 0 {
            for (name, rays) in [("rx", rx), ("ry", ry)] {
                required_arrays(name, RAYS, rays_of(rays).map(|array| array.cast_const()))?;
            }
        }
        let neighbours = Some([rx, ry].map(neighbour_columns));
        Request { wavelengths, neighbours, ..Request::of_arrays(handle, n, samples, rays) }.answer()
    }
}
