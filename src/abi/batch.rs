//! Many rays in one call, as pbrt's array of structures and as structure of arrays.

use std::mem::size_of;

use super::boundary::{self, Failure, realistic_status};
use super::handle::Handle;
use super::object;
use super::types::{
    realistic_camera, realistic_ray, realistic_rays_soa, realistic_reason, realistic_sample,
    realistic_samples_soa,
};

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
        for i in 0..n {
            // SAFETY: element i of each array; the strides leave room for an element and i * stride
            // does not overflow.
            unsafe {
                let sample = samples.byte_add(i * sample_stride).read_unaligned();
                let (ray, weight, reason) = handle.generate(&sample);
                if let Some(ray) = ray {
                    rays.byte_add(i * ray_stride).write_unaligned(ray);
                }
                weights.add(i).write_unaligned(weight);
                if !reasons.is_null() {
                    reasons.add(i).write_unaligned(reason);
                }
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
        for i in 0..n {
            // SAFETY: the arrays that must be there are, with room for `n` elements.
            unsafe { one_of_arrays(handle, samples, rays, i) };
        }
        Ok(())
    })
}

/// # Safety
/// `i` lies inside every array that is not NULL; the required ones are not.
unsafe fn one_of_arrays(
    handle: &Handle,
    samples: &realistic_samples_soa,
    rays: &realistic_rays_soa,
    i: usize,
) {
    // SAFETY: the caller's promise.
    unsafe {
        let read = |array: *const f32| array.add(i).read_unaligned();
        let write = |array: *mut f32, value| {
            if !array.is_null() {
                array.add(i).write_unaligned(value);
            }
        };
        let (ray, weight, reason) = handle.generate(&realistic_sample {
            image_x: read(samples.image_x),
            image_y: read(samples.image_y),
            lens_u: read(samples.lens_u),
            lens_v: read(samples.lens_v),
            time: read(samples.time),
        });
        write(rays.weight, weight);
        if !rays.reason.is_null() {
            rays.reason.add(i).write_unaligned(reason);
        }
        let Some(realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time }) = ray else {
            return;
        };
        for (array, value) in [
            (rays.ox, ox),
            (rays.oy, oy),
            (rays.oz, oz),
            (rays.dx, dx),
            (rays.dy, dy),
            (rays.dz, dz),
            (rays.mint, mint),
            (rays.maxt, maxt),
            (rays.time, time),
        ] {
            write(array, value);
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
