//! Many rays in one call, each at a wavelength of its own.

use std::{array, mem::size_of};

use super::{
    super::{
        boundary::{self, realistic_status},
        object,
        types::{
            realistic_camera, realistic_ray, realistic_rays_soa, realistic_reason, realistic_sample,
            realistic_samples_soa,
        },
    },
    arrays::{arrays_of, required, stride},
    columns::{Column, ColumnMut, Reasons},
    rays::realistic_camera_generate_rays,
    request::Request,
};

/// Rays of `n` samples, each at its own wavelength, the same as by `realistic_generate_ray_at`: `wavelengths_nm[i]` lies
/// `i * wavelength_stride` bytes from the first (0: tightly packed). With `wavelengths_nm` NULL every ray is at the
/// camera's own wavelength, and the call is `realistic_camera_generate_rays`. All else as there.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; the arrays have room for `n` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_rays_at(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_sample,
    sample_stride: usize,
    wavelengths_nm: *const f32,
    wavelength_stride: usize,
    rays: *mut realistic_ray,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_status {
    if wavelengths_nm.is_null() {
        // SAFETY: the caller's promise.
        return unsafe {
            realistic_camera_generate_rays(
                camera,
                n,
                samples,
                sample_stride,
                rays,
                ray_stride,
                weights,
                reasons,
            )
        };
    }
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let handle = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?;
        let sample_stride = stride("sample_stride", sample_stride, size_of::<realistic_sample>(), n)?;
        let wavelength_stride = stride("wavelength_stride", wavelength_stride, size_of::<f32>(), n)?;
        let ray_stride = stride("ray_stride", ray_stride, size_of::<realistic_ray>(), n)?;
        if n == 0 {
            return Ok(());
        }
        required("samples", samples)?;
        required("rays", rays)?;
        required("weights", weights)?;
        let (sample_stride, ray_stride) = (sample_stride as isize, ray_stride as isize);
        let number = |k: usize| Column {
            first: samples.cast::<f32>().wrapping_add(k),
            stride: sample_stride,
            shared_by: 1,
        };
        let room = |k: usize| match k {
            0..9 => ColumnMut { first: rays.cast::<f32>().wrapping_add(k), stride: ray_stride },
            _ => ColumnMut::packed(weights),
        };
        let wavelengths = Column { first: wavelengths_nm, stride: wavelength_stride as isize, shared_by: 1 };
        let request = Request {
            handle,
            n,
            samples: array::from_fn(number),
            wavelengths: Some(wavelengths),
            rays: array::from_fn(room),
            neighbours: None,
            reasons: Reasons::packed(reasons),
        };
        // SAFETY: the arrays have room for `n` elements, and i * stride does not overflow.
        unsafe { request.answer() }
    })
}

/// Rays of `n` samples, each at its own wavelength (`n` of them, nm), given and taken as structure of arrays. With
/// `wavelengths_nm` NULL every ray is at the camera's own wavelength, and the call is
/// `realistic_camera_generate_rays_soa`. All else as there.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; `samples` and `rays` are NULL or valid, and they and
/// `wavelengths_nm` are NULL or have room for `n` elements and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_rays_at_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    wavelengths_nm: *const f32,
    rays: *const realistic_rays_soa,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        unsafe {
            let (handle, samples, rays) = arrays_of(camera, n, samples, rays)?;
            let wavelengths = (!wavelengths_nm.is_null()).then(|| Column::packed(wavelengths_nm));
            Request { wavelengths, ..Request::of_arrays(handle, n, samples, rays) }.answer()
        }
    })
}

/// Four rays of each of `n` samples, at four wavelengths (nm) each: the ray of sample i at `wavelengths_nm[4 i + k]` is
/// ray 4 i + k, the same as by `realistic_generate_ray_at`. `samples` has arrays of `n` elements; `wavelengths_nm` and the
/// arrays of `rays` have 4 `n`. All else as in `realistic_camera_generate_rays_at_soa`.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; `samples` and `rays` are NULL or valid; the arrays are NULL or have
/// room for `n` or 4 `n` elements and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_hero_rays_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    wavelengths_nm: *const f32,
    rays: *const realistic_rays_soa,
) -> realistic_status {
    boundary::status(|| {
        boundary::fits_memory(n, 4 * size_of::<f32>())?;
        // SAFETY: the caller's promise.
        unsafe {
            let (handle, samples, rays) = arrays_of(camera, n, samples, rays)?;
            if n == 0 {
                return Ok(());
            }
            required("wavelengths_nm", wavelengths_nm)?;
            let mut request = Request::of_arrays(handle, 4 * n, samples, rays);
            request.samples.iter_mut().for_each(|column| column.shared_by = 4);
            request.wavelengths = Some(Column::packed(wavelengths_nm));
            request.answer()
        }
    })
}
