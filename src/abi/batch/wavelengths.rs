//! Many rays in one call, each at a wavelength of its own.

use std::{mem::size_of, slice};

use super::{
    super::{
        boundary::{self, Failure, memory, realistic_status},
        object::{self, Handle},
        types::{
            realistic_camera, realistic_ray, realistic_rays_soa, realistic_reason, realistic_sample,
            realistic_samples_soa,
        },
    },
    arrays::{
        RAYS, SAMPLES, are_aligned, columns_of, ray_arrays, rays_of, required, required_arrays,
        sample_arrays, samples_of, stride,
    },
    blocks::{BLOCK, Outcomes, RayRoom, SampleRoom, read_columns, write_columns},
    rays::{realistic_camera_generate_rays, realistic_camera_generate_rays_soa},
    structures::{RayStructures, SampleStructures},
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
        prepare(handle)?;
        let samples = SampleStructures { first: samples, stride: sample_stride };
        let rays = RayStructures { first: rays, stride: ray_stride };
        // SAFETY: the arrays have room for `n` elements, and i * stride does not overflow.
        unsafe {
            in_blocks(
                handle,
                n,
                |first, count, room| samples.read(first, count, room),
                |i| wavelengths_nm.byte_add(i * wavelength_stride).read_unaligned(),
                |first, count, room| rays.write(first, count, room),
                weights,
                reasons,
            );
        }
        Ok(())
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
    if wavelengths_nm.is_null() {
        // SAFETY: the caller's promise.
        return unsafe { realistic_camera_generate_rays_soa(camera, n, samples, rays) };
    }
    boundary::status(|| {
        // SAFETY: the caller's promise.
        unsafe {
            let (handle, samples, rays) = arrays_of(camera, n, samples, rays)?;
            if n == 0 {
                return Ok(());
            }
            prepare(handle)?;
            let is_aligned = samples_of(samples).iter().all(|array| array.is_aligned())
                && are_aligned(rays)
                && wavelengths_nm.is_aligned();
            if is_aligned {
                let (asked, mut found) = (sample_arrays(samples, n), ray_arrays(rays, n));
                let wavelengths = slice::from_raw_parts(wavelengths_nm, n);
                handle.camera().rays_at(&asked, wavelengths, &mut found);
                let reason = |i| handle.reason_at(&asked.get(i), wavelengths[i]);
                give_reasons(rays.reason, found.weight, reason);
            } else {
                let (from, to) = (samples_of(samples), columns_of(rays));
                in_blocks(
                    handle,
                    n,
                    |first, count, room| read_columns(from, first, count, room),
                    |i| wavelengths_nm.add(i).read_unaligned(),
                    |first, count, room| {
                        let [columns @ .., weight] = room.arrays(count);
                        write_columns(&to, first, &columns, weight);
                    },
                    rays.weight,
                    rays.reason,
                );
            }
        }
        Ok(())
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
            prepare(handle)?;
            let (from, to) = (samples_of(samples), columns_of(rays));
            in_blocks(
                handle,
                4 * n,
                |first, count, room| {
                    for (from, to) in from.iter().zip(room.arrays_mut(count)) {
                        for (i, number) in to.iter_mut().enumerate() {
                            *number = from.add((first + i) / 4).read_unaligned();
                        }
                    }
                },
                |i| wavelengths_nm.add(i).read_unaligned(),
                |first, count, room| {
                    let [columns @ .., weight] = room.arrays(count);
                    write_columns(&to, first, &columns, weight);
                },
                rays.weight,
                rays.reason,
            );
        }
        Ok(())
    })
}

/// The camera and the structures of a call, which must be there with all arrays that must.
///
/// # Safety
/// The pointers are NULL or valid.
unsafe fn arrays_of<'a>(
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

/// Asks for memory where a first request is going to build something.
fn prepare(handle: &Handle) -> Result<(), Failure> {
    if handle.camera().is_ready_for_wavelengths() { Ok(()) } else { memory::to_build() }
}

/// What becomes of `n` samples at wavelengths, block by block: `read` reads samples, `wavelength` one of the wavelengths,
/// and `write` takes what became of them.
///
/// # Safety
/// `weights` has room for `n` elements; `reasons` too, or it is NULL.
unsafe fn in_blocks(
    handle: &Handle,
    n: usize,
    read: impl Fn(usize, usize, &mut SampleRoom),
    wavelength: impl Fn(usize) -> f32,
    write: impl Fn(usize, usize, &RayRoom),
    weights: *mut f32,
    reasons: *mut realistic_reason,
) {
    let (mut samples, mut rays) = (SampleRoom::new(), RayRoom::new());
    let mut wavelengths = [0.0; BLOCK];
    samples.set_all(n, [0.0; 5]);
    rays.clear(handle.camera(), n);
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        read(first, count, &mut samples);
        for (i, to) in wavelengths[..count].iter_mut().enumerate() {
            *to = wavelength(first + i);
        }
        let asked = samples.samples(count);
        handle.camera().rays_at(&asked, &wavelengths[..count], &mut rays.rays(handle.camera(), count));
        write(first, count, &rays);
        let weight = rays.weights(count);
        // SAFETY: the caller's promise; weights need not be aligned.
        unsafe {
            weights.add(first).cast::<u8>().copy_from(weight.as_ptr().cast(), size_of_val(weight));
            let reasons = if reasons.is_null() { reasons } else { reasons.add(first) };
            give_reasons(reasons, weight, |i| handle.reason_at(&asked.get(i), wavelengths[i]));
        }
    }
}

/// Why samples have these weights, where a caller asks; `reason` says it of one that has no ray.
///
/// # Safety
/// `reasons` is NULL or has room for as many.
unsafe fn give_reasons(
    reasons: *mut realistic_reason,
    weights: &[f32],
    reason: impl Fn(usize) -> realistic_reason,
) {
    if reasons.is_null() {
        return;
    }
    for (i, weight) in weights.iter().enumerate() {
        let reason = if *weight > 0.0 { realistic_reason::Ok } else { reason(i) };
        // SAFETY: the caller's promise.
        unsafe { reasons.add(i).write_unaligned(reason) };
    }
}
