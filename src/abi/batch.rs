//! Many rays in one call, as pbrt's array of structures and as structure of arrays.

use std::mem::size_of;

use super::boundary::{self, Failure, realistic_status};
use super::handle::Handle;
use super::object;
use super::types::{
    realistic_camera, realistic_ray, realistic_rays_soa, realistic_reason, realistic_sample,
    realistic_samples_soa,
};
use crate::camera::{BLOCK, RayBlock, Sample, SampleBlock, WorldRay};

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
                |i| samples.byte_add(i * sample_stride).read_unaligned().into(),
                |i, ray, weight, reason| {
                    if let Some(ray) = ray {
                        rays.byte_add(i * ray_stride).write_unaligned(ray.into());
                    }
                    weights.add(i).write_unaligned(weight);
                    if !reasons.is_null() {
                        reasons.add(i).write_unaligned(reason());
                    }
                },
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
/// Every array that is not NULL has room for `n` elements; the required ones are not NULL.
unsafe fn all_of_arrays(
    handle: &Handle,
    n: usize,
    samples: &realistic_samples_soa,
    rays: &realistic_rays_soa,
) {
    let mut block = (SampleBlock::new(), RayBlock::new());
    let (asked, found) = (&mut block.0, &mut block.1);
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        // SAFETY: the caller's promise; bytes are copied, so nothing needs to be aligned.
        unsafe {
            for (from, to) in [
                (samples.image_x, &mut asked.image_x),
                (samples.image_y, &mut asked.image_y),
                (samples.lens_u, &mut asked.lens_u),
                (samples.lens_v, &mut asked.lens_v),
                (samples.time, &mut asked.time),
            ] {
                copy(from.byte_add(first * size_of::<f32>()), to.as_mut_ptr(), count);
            }
        }
        handle.camera().rays(asked, count, found);
        let all_pass = found.weight[..count].iter().all(|weight| *weight > 0.0);
        let [ox, oy, oz] = &found.origin;
        let [dx, dy, dz] = &found.direction;
        for (from, to) in [
            (ox, rays.ox),
            (oy, rays.oy),
            (oz, rays.oz),
            (dx, rays.dx),
            (dy, rays.dy),
            (dz, rays.dz),
            (&found.mint, rays.mint),
            (&found.maxt, rays.maxt),
            (&found.time, rays.time),
        ] {
            if to.is_null() {
                continue;
            }
            // SAFETY: as above.
            unsafe {
                let to = to.add(first);
                if all_pass {
                    copy(from.as_ptr(), to, count);
                    continue;
                }
                for i in (0..count).filter(|&i| found.weight[i] > 0.0) {
                    to.add(i).write_unaligned(from[i]);
                }
            }
        }
        // SAFETY: as above.
        unsafe {
            copy(found.weight.as_ptr(), rays.weight.add(first), count);
            if !rays.reason.is_null() {
                for i in 0..count {
                    let reason = reason(handle, &asked.get(i), found.weight[i]);
                    rays.reason.add(first + i).write_unaligned(reason);
                }
            }
        }
    }
}

/// # Safety
/// `from` can be read and `to` written for `count` floats, and they do not overlap.
unsafe fn copy(from: *const f32, to: *mut f32, count: usize) {
    // SAFETY: the caller's promise; bytes need no alignment.
    unsafe { std::ptr::copy_nonoverlapping(from.cast::<u8>(), to.cast::<u8>(), count * size_of::<f32>()) }
}

/// Why a sample has this weight. Found out apart, because it costs more than a ray.
fn reason(handle: &Handle, sample: &Sample, weight: f32) -> realistic_reason {
    if weight > 0.0 { realistic_reason::Ok } else { handle.reason(sample) }
}

/// Rays of `n` samples, read one after the other and written so, block by block.
fn in_blocks(
    handle: &Handle,
    n: usize,
    read: impl Fn(usize) -> Sample,
    mut write: impl FnMut(usize, Option<WorldRay>, f32, &dyn Fn() -> realistic_reason),
) {
    let (mut samples, mut rays) = (SampleBlock::new(), RayBlock::new());
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        (0..count).for_each(|i| samples.set(i, &read(first + i)));
        handle.camera().rays(&samples, count, &mut rays);
        for i in 0..count {
            let ray = rays.get(i).map(|(ray, _)| ray);
            let weight = rays.weight[i];
            write(first + i, ray, weight, &|| reason(handle, &samples.get(i), weight));
        }
    }
}

fn required<T>(name: &str, array: *const T) -> Result<(), Failure> {
    if array.is_null() { Err(boundary::null(name)) } else { Ok(()) }
}

fn stride(name: &str, given: usize, size: usize, n: usize) -> Result<usize, Failure> {
    let stride = if given == 0 { size } else { given };
    let fits = stride >= size && stride.checked_mul(n).is_some_and(|bytes| isize::try_from(bytes).is_ok());
    fits.then_some(stride).ok_or_else(|| {
        Failure::new(
            realistic_status::InvalidParameter,
            format!("{name} is {given} for {n} elements; it must be 0 or at least {size} bytes"),
        )
    })
}
