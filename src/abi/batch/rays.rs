//! Many rays in one call.

use std::mem::size_of;

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
    blocks::{RayRoom, in_blocks},
    columns::Reasons,
    request::Request,
    structures::{RayStructures, SampleStructures},
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
        let samples = SampleStructures { first: samples, stride: sample_stride };
        let rays = RayStructures { first: rays, stride: ray_stride };
        // SAFETY: the arrays have room for `n` elements, and i * stride does not overflow.
        unsafe {
            if n == 1 && samples.at(0).is_aligned() && rays.at(0).is_aligned() {
                let mut weight = 0.0;
                let sample = &*samples.at(0);
                handle.camera().trace_one(sample, &mut *rays.at(0), &mut weight);
                weights.write_unaligned(weight);
                Reasons::packed(reasons).give(0, &[weight], |_| handle.reason(sample));
            } else {
                in_blocks::<RayRoom>(
                    handle,
                    n,
                    |first, count, room| samples.read(first, count, room),
                    |first, count, room| rays.write(first, count, room),
                    weights,
                    Reasons::packed(reasons),
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
        // SAFETY: the caller's promise.
        unsafe {
            let (handle, samples, rays) = arrays_of(camera, n, samples, rays)?;
            Request::of_arrays(handle, n, samples, rays).answer()
        }
    })
}
