//! Many rays in one call.

use std::mem::size_of;

use super::{
    super::{
        boundary::{self, realistic_status},
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
    blocks::{RayRoom, give_reasons, in_blocks, read_columns, write_columns},
    structures::{RayStructures, SampleStructures},
};
use crate::camera::{Sample, WorldRay};

/// Rays of `n` samples. Element i lies `i * stride` bytes from the first, so that arrays of a host's own
/// larger structures can be passed (pbrt-v1: 88 for `Sample`, 36 for `Ray`); a stride of 0 means tightly packed.
/// Nothing needs to be aligned beyond a byte.
///
/// `weights[i]` is 0 for a blocked ray, and `rays[i]` is then left as it is. `reasons` may be NULL. With `n` = 0
/// the arrays may be NULL. The arrays must not overlap.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; the arrays have room for `n` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_rays(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_sample,
    sample_stride: usize,
    rays: *mut realistic_ray,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let handle = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?;
        let sample_stride = stride("sample_stride", sample_stride, size_of::<realistic_sample>(), n)?;
        let ray_stride = stride("ray_stride", ray_stride, size_of::<realistic_ray>(), n)?;
        if n == 0 {
            return Ok(());
        }
        required("samples", samples)?;
        required("rays", rays)?;
        required("weights", weights)?;
        let samples = SampleStructures { first: samples, stride: sample_stride };
        let rays = RayStructures { first: rays, stride: ray_stride };
        // SAFETY: the arrays have room for `n` elements, and i * stride does not overflow.
        unsafe {
            if n == 1 && samples.at(0).is_aligned() && rays.at(0).is_aligned() {
                let mut weight = 0.0;
                let sample = &*samples.at(0);
                handle.camera().trace_one(sample, &mut *rays.at(0), &mut weight);
                weights.write_unaligned(weight);
                give_reasons(handle, reasons, |_| (*sample, weight), 1);
            } else {
                in_blocks::<RayRoom>(
                    handle,
                    n,
                    |first, count, room| samples.read(first, count, room),
                    |first, count, room| rays.write(first, count, room),
                    weights,
                    reasons,
                );
            }
        }
        Ok(())
    })
}

/// Rays of `n` samples given and taken as structure of arrays. Blocked rays as in
/// `realistic_camera_generate_rays`. In `rays` the arrays `mint`, `maxt`, `time` and `reason` may be NULL.
///
/// # Safety
/// `camera` is NULL or a live camera of this library; `samples` and `rays` are NULL or valid, and
/// their arrays are NULL or have room for `n` elements and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_rays_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    rays: *const realistic_rays_soa,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise for all three.
        let (handle, samples, rays) = unsafe { (object::handle_of(camera), samples.as_ref(), rays.as_ref()) };
        let handle = handle.ok_or_else(boundary::not_a_camera)?;
        let samples = samples.ok_or_else(|| boundary::null("samples"))?;
        let rays = rays.ok_or_else(|| boundary::null("rays"))?;
        if n == 0 {
            return Ok(());
        }
        required_arrays("samples", SAMPLES, samples_of(samples))?;
        required_arrays("rays", RAYS, rays_of(rays).map(|array| array.cast_const()))?;
        // SAFETY: the arrays that must be there are, and each has room for `n` elements.
        unsafe { all_of_arrays(handle, n, samples, rays) };
        Ok(())
    })
}

/// # Safety
/// Every array that is not NULL has room for `n` elements and overlaps no other; the required ones are not NULL.
unsafe fn all_of_arrays(
    handle: &Handle,
    n: usize,
    samples: &realistic_samples_soa,
    rays: &realistic_rays_soa,
) {
    if n == 1 {
        // SAFETY: the caller's promise.
        return unsafe { one_of_arrays(handle, samples, rays) };
    }
    let is_aligned = samples_of(samples).iter().all(|array| array.is_aligned()) && are_aligned(rays);
    if !is_aligned {
        // SAFETY: the caller's promise.
        return unsafe { all_of_unaligned(handle, n, samples, rays) };
    }
    // SAFETY: the caller's promise, and all is aligned.
    unsafe {
        let (asked, mut found) = (sample_arrays(samples, n), ray_arrays(rays, n));
        handle.camera().rays(&asked, &mut found);
        give_reasons(handle, rays.reason, |i| (asked.get(i), found.weight[i]), n);
    }
}

/// [`all_of_arrays`] of one sample, as a call of its own.
///
/// # Safety
/// As there.
unsafe fn one_of_arrays(handle: &Handle, samples: &realistic_samples_soa, rays: &realistic_rays_soa) {
    let (mut ray, mut weight) = (WorldRay::default(), 0.0);
    // SAFETY: the caller's promise; nothing needs to be aligned.
    unsafe {
        let sample = Sample {
            image_x: samples.image_x.read_unaligned(),
            image_y: samples.image_y.read_unaligned(),
            lens_u: samples.lens_u.read_unaligned(),
            lens_v: samples.lens_v.read_unaligned(),
            time: samples.time.read_unaligned(),
        };
        handle.camera().trace_one(&sample, &mut ray, &mut weight);
        rays.weight.write_unaligned(weight);
        if weight > 0.0 {
            let WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time } = ray;
            for (array, number) in
                columns_of(rays).into_iter().zip([ox, oy, oz, dx, dy, dz, mint, maxt, time])
            {
                if !array.is_null() {
                    array.write_unaligned(number);
                }
            }
        }
        give_reasons(handle, rays.reason, |_| (sample, weight), 1);
    }
}

/// [`all_of_arrays`] by copies.
///
/// # Safety
/// As there.
unsafe fn all_of_unaligned(
    handle: &Handle,
    n: usize,
    samples: &realistic_samples_soa,
    rays: &realistic_rays_soa,
) {
    let from = samples_of(samples);
    // SAFETY: the caller's promise.
    unsafe {
        in_blocks::<RayRoom>(
            handle,
            n,
            |first, count, room| read_columns(from, first, count, room),
            |first, count, room| {
                let [columns @ .., weight] = room.arrays(count);
                write_columns(&columns_of(rays), first, &columns, weight);
            },
            rays.weight,
            rays.reason,
        );
    }
}
