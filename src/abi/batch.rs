//! Many rays in one call, as pbrt's array of structures and as structure of arrays.

use std::{mem::size_of, slice};

use super::boundary::{self, Failure, realistic_status};
use super::object::{self, Handle};
use super::types::{
    realistic_camera, realistic_ray, realistic_rays_soa, realistic_reason, realistic_sample,
    realistic_samples_soa,
};
use crate::camera::{BLOCK, RayArrays, RayBlock, Sample, SampleArrays, SampleBlock, WorldRay};

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
        // SAFETY: element i of each array; the strides leave room for an element and i * stride does not overflow.
        unsafe {
            in_blocks(
                handle,
                n,
                |i| samples.byte_add(i * sample_stride).cast::<Sample>().read_unaligned(),
                |i, ray| rays.byte_add(i * ray_stride).cast::<WorldRay>().write_unaligned(ray),
                weights,
                reasons,
            );
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
        for (name, array) in [
            ("samples.image_x", samples.image_x),
            ("samples.image_y", samples.image_y),
            ("samples.lens_u", samples.lens_u),
            ("samples.lens_v", samples.lens_v),
            ("samples.time", samples.time),
        ] {
            required(name, array)?;
        }
        for (name, array) in [
            ("rays.ox", rays.ox),
            ("rays.oy", rays.oy),
            ("rays.oz", rays.oz),
            ("rays.dx", rays.dx),
            ("rays.dy", rays.dy),
            ("rays.dz", rays.dz),
            ("rays.weight", rays.weight),
        ] {
            required(name, array)?;
        }
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
    let from = [samples.image_x, samples.image_y, samples.lens_u, samples.lens_v, samples.time];
    let [ox, oy, oz] = [rays.ox, rays.oy, rays.oz];
    let [dx, dy, dz] = [rays.dx, rays.dy, rays.dz];
    let to = [ox, oy, oz, dx, dy, dz, rays.weight, rays.mint, rays.maxt, rays.time];
    if !from.iter().all(|array| array.is_aligned()) || !to.iter().all(|array| array.is_aligned()) {
        // SAFETY: element i of each array, which nothing aligns.
        return unsafe { all_of_unaligned(handle, n, from, to, rays.reason) };
    }
    // SAFETY: aligned, not NULL or not asked for, and of `n` elements that nothing else refers to.
    let (asked, mut found) = unsafe {
        let [image_x, image_y, lens_u, lens_v, time] = from.map(|array| slice::from_raw_parts(array, n));
        let room = |array: *mut f32| slice::from_raw_parts_mut(array, n);
        let optional = |array: *mut f32| (!array.is_null()).then(|| slice::from_raw_parts_mut(array, n));
        let found = RayArrays {
            origin: [room(ox), room(oy), room(oz)],
            direction: [room(dx), room(dy), room(dz)],
            mint: optional(rays.mint),
            maxt: optional(rays.maxt),
            time: optional(rays.time),
            weight: room(rays.weight),
        };
        (SampleArrays { image_x, image_y, lens_u, lens_v, time }, found)
    };
    handle.camera().rays(&asked, &mut found);
    if !rays.reason.is_null() {
        for (i, weight) in found.weight.iter().enumerate() {
            // SAFETY: the caller's promise.
            unsafe { rays.reason.add(i).write_unaligned(reason(handle, &asked.get(i), *weight)) };
        }
    }
}

/// [`all_of_arrays`] by copies.
///
/// # Safety
/// As there, but for the alignment; `from` and the first seven of `to` are not NULL.
unsafe fn all_of_unaligned(
    handle: &Handle,
    n: usize,
    from: [*const f32; 5],
    to: [*mut f32; 10],
    reasons: *mut realistic_reason,
) {
    let [ox, oy, oz, dx, dy, dz, weights, mint, maxt, time] = to;
    // SAFETY: the caller's promise, and element i of each array.
    unsafe {
        in_blocks(
            handle,
            n,
            |i| {
                let [image_x, image_y, lens_u, lens_v, time] =
                    from.map(|array| array.add(i).read_unaligned());
                Sample { image_x, image_y, lens_u, lens_v, time }
            },
            |i, ray| {
                let ([x, y, z], [u, v, w]) = (ray.origin, ray.direction);
                let numbers = [x, y, z, u, v, w, ray.mint, ray.maxt, ray.time];
                for (array, number) in [ox, oy, oz, dx, dy, dz, mint, maxt, time].into_iter().zip(numbers) {
                    if !array.is_null() {
                        array.add(i).write_unaligned(number);
                    }
                }
            },
            weights,
            reasons,
        );
    }
}

/// Why a sample has this weight. Found out apart, because it costs more than a ray.
fn reason(handle: &Handle, sample: &Sample, weight: f32) -> realistic_reason {
    if weight > 0.0 { realistic_reason::Ok } else { handle.reason(sample) }
}

/// Rays of `n` samples, read one after the other and written so, block by block.
///
/// # Safety
/// `weights` has room for `n` elements; `reasons` too, or it is NULL.
unsafe fn in_blocks(
    handle: &Handle,
    n: usize,
    read: impl Fn(usize) -> Sample,
    write: impl Fn(usize, WorldRay),
    weights: *mut f32,
    reasons: *mut realistic_reason,
) {
    let (mut samples, mut rays) = (SampleBlock::<BLOCK>::new(), RayBlock::<BLOCK>::new());
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        (0..count).for_each(|i| samples.set(i, &read(first + i)));
        let asked = samples.arrays(count);
        handle.camera().rays(&asked, &mut rays.arrays(count));
        for i in 0..count {
            if let Some((ray, _)) = rays.get(i) {
                write(first + i, ray);
            }
            // SAFETY: the caller's promise.
            unsafe {
                weights.add(first + i).write_unaligned(rays.weight(i));
                if !reasons.is_null() {
                    let reason = reason(handle, &asked.get(i), rays.weight(i));
                    reasons.add(first + i).write_unaligned(reason);
                }
            }
        }
    }
}

fn required<T>(name: &str, array: *const T) -> Result<(), Failure> {
    if array.is_null() { Err(boundary::null(name)) } else { Ok(()) }
}

fn stride(name: &str, given: usize, size: usize, n: usize) -> Result<usize, Failure> {
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
