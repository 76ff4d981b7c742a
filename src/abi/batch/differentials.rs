//! Many rays with their differentials in one call.

use std::mem::size_of;

use super::{
    super::{
        boundary::{self, realistic_status},
        exchange::check_size,
        object::{self, Handle},
        types::{
            realistic_camera, realistic_ray_differential, realistic_rays_soa, realistic_reason,
            realistic_sample, realistic_samples_soa,
        },
    },
    arrays::{
        RAYS, SAMPLES, are_aligned, columns_of, neighbour_arrays, ray_arrays, rays_of, required,
        required_arrays, sample_arrays, samples_of, stride,
    },
    blocks::{DifferentialRoom, give_reasons, in_blocks, read_columns, write_columns},
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
                reasons,
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
    boundary::status(|| {
        // SAFETY: the caller's promise for all.
        let (handle, samples, [rays, rx, ry]) = unsafe {
            (object::handle_of(camera), samples.as_ref(), [rays, rx, ry].map(|rays| rays.as_ref()))
        };
        let handle = handle.ok_or_else(boundary::not_a_camera)?;
        let samples = samples.ok_or_else(|| boundary::null("samples"))?;
        let rays = rays.ok_or_else(|| boundary::null("rays"))?;
        let rx = rx.ok_or_else(|| boundary::null("rx"))?;
        let ry = ry.ok_or_else(|| boundary::null("ry"))?;
        boundary::fits_memory(n, size_of::<f32>())?;
        if n == 0 {
            return Ok(());
        }
        required_arrays("samples", SAMPLES, samples_of(samples))?;
        for (name, rays) in [("rays", rays), ("rx", rx), ("ry", ry)] {
            required_arrays(name, RAYS, rays_of(rays).map(|array| array.cast_const()))?;
        }
        let is_aligned = [rays, rx, ry].iter().all(|rays| are_aligned(rays));
        // SAFETY: the arrays that must be there are, and each has room for `n` elements.
        unsafe {
            if is_aligned && samples_of(samples).iter().all(|array| array.is_aligned()) {
                let asked = sample_arrays(samples, n);
                let mut found = ray_arrays(rays, n);
                let [mut rx, mut ry] = [rx, ry].map(|rays| neighbour_arrays(rays, n));
                handle.camera().ray_differentials(&asked, &mut found, &mut rx, &mut ry);
                give_reasons(handle, rays.reason, |i| (asked.get(i), found.weight[i]), n);
            } else {
                all_of_unaligned(handle, n, samples, rays, [rx, ry]);
            }
        }
        Ok(())
    })
}

/// Rays and their neighbours by copies.
///
/// # Safety
/// Every array that is not NULL has room for `n` elements and overlaps no other; the required ones are not NULL.
unsafe fn all_of_unaligned(
    handle: &Handle,
    n: usize,
    samples: &realistic_samples_soa,
    rays: &realistic_rays_soa,
    neighbours: [&realistic_rays_soa; 2],
) {
    let from = samples_of(samples);
    // SAFETY: the caller's promise.
    unsafe {
        in_blocks::<DifferentialRoom>(
            handle,
            n,
            |first, count, room| read_columns(from, first, count, room),
            |first, count, room| {
                let [columns @ .., weight] = room.rays.arrays(count);
                write_columns(&columns_of(rays), first, &columns, weight);
                for (to, room) in neighbours.iter().zip(&room.neighbours) {
                    let [columns @ .., found] = room.arrays(count);
                    write_columns(&columns_of(to)[..6], first, &columns, weight);
                    for (i, weight) in found.iter().enumerate() {
                        to.weight.add(first + i).write_unaligned(*weight);
                    }
                }
            },
            rays.weight,
            rays.reason,
        );
    }
}
