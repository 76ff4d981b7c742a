//! Many rays in one call, as pbrt's array of structures and as structure of arrays.

mod blocks;

use std::{mem::size_of, slice};

use self::blocks::{BLOCK, RayRoom, RayStructures, SampleRoom, SampleStructures};
use super::boundary::{self, Failure, realistic_status};
use super::object::{self, Handle};
use super::types::{
    realistic_camera, realistic_ray, realistic_rays_soa, realistic_reason, realistic_sample,
    realistic_samples_soa,
};
use crate::camera::{RayArrays, Sample, SampleArrays};

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
                in_blocks(
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
    // SAFETY: the caller's promise.
    unsafe { give_reasons(handle, rays.reason, |i| (asked.get(i), found.weight[i]), n) };
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
    // SAFETY: the caller's promise, and elements `first` to `first + count` of each array.
    unsafe {
        in_blocks(
            handle,
            n,
            |first, count, room| {
                for (from, to) in from.iter().zip(room.arrays_mut(count)) {
                    for (i, number) in to.iter_mut().enumerate() {
                        *number = from.add(first + i).read_unaligned();
                    }
                }
            },
            |first, count, room| {
                let [numbers @ .., weight] = room.arrays(count);
                for (to, from) in [ox, oy, oz, dx, dy, dz, mint, maxt, time].into_iter().zip(numbers) {
                    for i in (0..count).filter(|&i| !to.is_null() && weight[i] > 0.0) {
                        to.add(first + i).write_unaligned(from[i]);
                    }
                }
            },
            weights,
            reasons,
        );
    }
}

/// Why samples have the weights that they have, where a caller asks. Found out apart, because it costs more than a ray.
///
/// # Safety
/// `reasons` is NULL or has room for `n` elements.
unsafe fn give_reasons(
    handle: &Handle,
    reasons: *mut realistic_reason,
    of: impl Fn(usize) -> (Sample, f32),
    n: usize,
) {
    if reasons.is_null() {
        return;
    }
    for i in 0..n {
        let (sample, weight) = of(i);
        let reason = if weight > 0.0 { realistic_reason::Ok } else { handle.reason(&sample) };
        // SAFETY: the caller's promise.
        unsafe { reasons.add(i).write_unaligned(reason) };
    }
}

/// Rays of `n` samples, block by block: `read` reads samples, `write` takes what became of them.
///
/// # Safety
/// `weights` has room for `n` elements; `reasons` too, or it is NULL.
#[inline(always)]
unsafe fn in_blocks(
    handle: &Handle,
    n: usize,
    read: impl Fn(usize, usize, &mut SampleRoom),
    write: impl Fn(usize, usize, &RayRoom),
    weights: *mut f32,
    reasons: *mut realistic_reason,
) {
    let (mut samples, mut rays) = (SampleRoom::new(), RayRoom::new());
    samples.clear(n);
    rays.clear(n);
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        read(first, count, &mut samples);
        let asked = samples.samples(count);
        handle.camera().rays(&asked, &mut rays.rays(count));
        write(first, count, &rays);
        let [.., weight] = rays.arrays(count);
        // SAFETY: the caller's promise; weights need not be aligned.
        unsafe {
            weights.add(first).cast::<u8>().copy_from(weight.as_ptr().cast(), size_of_val(weight));
            let reasons = if reasons.is_null() { reasons } else { reasons.add(first) };
            give_reasons(handle, reasons, |i| (asked.get(i), weight[i]), count);
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
