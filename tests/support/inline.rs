//! Rust versions of `realistic.h`'s inline functions, under the same names, and of other requests, under short names:
//! tests and benches link the library and do not see the header.

#![allow(
    dead_code,
    non_camel_case_types,
    clippy::too_many_arguments,
    reason = "C's names; nobody uses all of them"
)]

use std::ptr::{null, null_mut};

use realistic::ffi::*;

#[derive(Clone, Copy)]
pub struct realistic_samples_soa {
    pub image_x: *const f32,
    pub image_y: *const f32,
    pub lens_u: *const f32,
    pub lens_v: *const f32,
    pub time: *const f32,
}

#[derive(Clone, Copy)]
pub struct realistic_rays_soa {
    pub ox: *mut f32,
    pub oy: *mut f32,
    pub oz: *mut f32,
    pub dx: *mut f32,
    pub dy: *mut f32,
    pub dz: *mut f32,
    pub mint: *mut f32,
    pub maxt: *mut f32,
    pub time: *mut f32,
    pub weight: *mut f32,
    pub reason: *mut realistic_reason,
}

const NUMBER: isize = size_of::<f32>() as isize;

pub fn number(x: *const f32, stride: isize) -> realistic_input {
    realistic_input { x, y: null(), z: null(), stride }
}

pub fn room(x: *mut f32, stride: isize) -> realistic_output {
    realistic_output { x, y: null_mut(), z: null_mut(), stride }
}

fn pair(x: *const f32, stride: isize) -> realistic_input {
    realistic_input { x, y: x.wrapping_add(1), z: null(), stride }
}

/// Returns an output for vectors with adjacent components.
pub fn vector(x: *mut f32, stride: isize) -> realistic_output {
    realistic_output { x, y: x.wrapping_add(1), z: x.wrapping_add(2), stride }
}

fn stride(given: usize, size: usize) -> isize {
    match given {
        0 => size as isize,
        given if given < size => 1,
        given => given as isize,
    }
}

pub fn realistic_request_of_structures(
    samples: *const realistic_sample,
    sample_stride: usize,
    rays: *mut realistic_ray,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_request {
    let (from, to) = (stride(sample_stride, 20), stride(ray_stride, 36));
    let mut request = realistic_request {
        weight: room(weights, NUMBER),
        reason: reasons,
        reason_stride: NUMBER,
        ..Default::default()
    };
    let (sample, ray) = (samples.cast::<f32>(), rays.cast::<f32>());
    if !samples.is_null() {
        (request.image, request.lens) = (pair(sample, from), pair(sample.wrapping_add(2), from));
        request.time = number(sample.wrapping_add(4), from);
    }
    if !rays.is_null() {
        (request.origin, request.direction) = (vector(ray, to), vector(ray.wrapping_add(3), to));
        [request.mint, request.maxt, request.ray_time] = [6, 7, 8].map(|k| room(ray.wrapping_add(k), to));
    }
    request
}

/// Calls the batch with arrays of structures.
///
/// # Safety
/// The requirements are those of the exported batch.
pub unsafe fn realistic_camera_generate_rays(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_sample,
    sample_stride: usize,
    rays: *mut realistic_ray,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_status {
    let request = realistic_request_of_structures(samples, sample_stride, rays, ray_stride, weights, reasons);
    // SAFETY: guaranteed by the caller.
    unsafe { realistic_camera_generate_batch(camera, n, &request) }
}

/// Returns the request of structures of arrays.
///
/// # Safety
/// The structures are NULL or valid.
pub unsafe fn realistic_request_of_arrays(
    samples: *const realistic_samples_soa,
    rays: *const realistic_rays_soa,
) -> realistic_request {
    let mut request = realistic_request::default();
    // SAFETY: guaranteed by the caller.
    let (samples, rays) = unsafe { (samples.as_ref(), rays.as_ref()) };
    if let Some(&realistic_samples_soa { image_x, image_y, lens_u, lens_v, time }) = samples {
        request.image = realistic_input { x: image_x, y: image_y, z: null(), stride: NUMBER };
        request.lens = realistic_input { x: lens_u, y: lens_v, z: null(), stride: NUMBER };
        request.time = number(time, NUMBER);
    }
    if let Some(rays) = rays {
        let [origin, direction, weight] = columns(rays);
        (request.origin, request.direction, request.weight) = (origin, direction, weight);
        [request.mint, request.maxt, request.ray_time] =
            [rays.mint, rays.maxt, rays.time].map(|x| room(x, NUMBER));
        (request.reason, request.reason_stride) = (rays.reason, NUMBER);
    }
    request
}

/// Returns outputs for origins, directions and weights.
fn columns(rays: &realistic_rays_soa) -> [realistic_output; 3] {
    let realistic_rays_soa { ox, oy, oz, dx, dy, dz, weight, .. } = *rays;
    [
        realistic_output { x: ox, y: oy, z: oz, stride: NUMBER },
        realistic_output { x: dx, y: dy, z: dz, stride: NUMBER },
        room(weight, NUMBER),
    ]
}

/// Calls the batch with structures of arrays.
///
/// # Safety
/// The requirements are those of the exported batch.
pub unsafe fn realistic_camera_generate_rays_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    rays: *const realistic_rays_soa,
) -> realistic_status {
    // SAFETY: guaranteed by the caller.
    unsafe { realistic_camera_generate_batch(camera, n, &realistic_request_of_arrays(samples, rays)) }
}

/// Calls the batch with arrays of structures, at wavelengths if any are given.
///
/// # Safety
/// The requirements are those of the exported batch.
pub unsafe fn rays_at(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_sample,
    sample_stride: usize,
    wavelengths: *const f32,
    wavelength_stride: usize,
    rays: *mut realistic_ray,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_status {
    let request = realistic_request {
        wavelength: number(wavelengths, stride(wavelength_stride, 4)),
        ..realistic_request_of_structures(samples, sample_stride, rays, ray_stride, weights, reasons)
    };
    // SAFETY: guaranteed by the caller.
    unsafe { realistic_camera_generate_batch(camera, n, &request) }
}

/// Calls the batch with structures of arrays, at wavelengths if any are given, with `PER_SAMPLE` for each sample.
///
/// # Safety
/// The requirements are those of the exported batch.
pub unsafe fn rays_at_soa<const PER_SAMPLE: u32>(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_samples_soa,
    wavelengths: *const f32,
    rays: *const realistic_rays_soa,
) -> realistic_status {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let request = realistic_request {
            wavelength: number(wavelengths, NUMBER),
            wavelengths_per_sample: PER_SAMPLE,
            ..realistic_request_of_arrays(samples, rays)
        };
        realistic_camera_generate_batch(camera, n, &request)
    }
}

/// Calls the batch with structures of arrays and neighbours, at wavelengths if any are given.
///
/// # Safety
/// The requirements are those of the exported batch; the structures are valid.
pub unsafe fn differentials_at_soa(
    camera: *const realistic_camera,
    n: usize,
    samples: &realistic_samples_soa,
    wavelengths: *const f32,
    rays: &realistic_rays_soa,
    rx: &realistic_rays_soa,
    ry: &realistic_rays_soa,
) -> realistic_status {
    let [[rx_origin, rx_direction, rx_weight], [ry_origin, ry_direction, ry_weight]] = [rx, ry].map(columns);
    // SAFETY: guaranteed by the caller.
    unsafe {
        let request = realistic_request {
            wavelength: number(wavelengths, NUMBER),
            rx_origin,
            rx_direction,
            rx_weight,
            ry_origin,
            ry_direction,
            ry_weight,
            ..realistic_request_of_arrays(samples, rays)
        };
        realistic_camera_generate_batch(camera, n, &request)
    }
}

/// Calls the batch with arrays of structures and neighbours: the batch writes into the structures, and `has` follows
/// from the neighbours' weights.
///
/// # Safety
/// The requirements are those of the exported batch.
pub unsafe fn differentials(
    camera: *const realistic_camera,
    n: usize,
    samples: *const realistic_sample,
    sample_stride: usize,
    rays: *mut realistic_ray_differential,
    ray_stride: usize,
    weights: *mut f32,
    reasons: *mut realistic_reason,
) -> realistic_status {
    let to = stride(ray_stride, size_of::<realistic_ray_differential>());
    let mut beside = vec![[0.0_f32; 2]; n];
    let first = beside.as_mut_ptr().cast::<f32>();
    // SAFETY: guaranteed by the caller; only addresses are computed.
    unsafe {
        let part = |x: *mut [f32; 3]| vector(x.cast(), to);
        let request = realistic_request {
            rx_origin: part(&raw mut (*rays).rx_o),
            rx_direction: part(&raw mut (*rays).rx_d),
            rx_weight: room(first, 2 * NUMBER),
            ry_origin: part(&raw mut (*rays).ry_o),
            ry_direction: part(&raw mut (*rays).ry_d),
            ry_weight: room(first.wrapping_add(1), 2 * NUMBER),
            ..realistic_request_of_structures(
                samples,
                sample_stride,
                &raw mut (*rays).ray,
                to as usize,
                weights,
                reasons,
            )
        };
        let status = realistic_camera_generate_batch(camera, n, &request);
        for (i, [rx, ry]) in beside.into_iter().enumerate() {
            if weights.add(i).read_unaligned() > 0.0 {
                let has = u32::from(rx > 0.0) * REALISTIC_HAS_RX + u32::from(ry > 0.0) * REALISTIC_HAS_RY;
                (&raw mut (*rays.byte_add(i * to as usize)).has).write_unaligned(has);
            }
        }
        status
    }
}

/// Returns a request for one wavelength; the wavelength must outlive the request.
pub fn at(wavelength: &f32) -> realistic_request {
    realistic_request { wavelength: number(wavelength, 0), ..Default::default() }
}

/// Generates a ray at a wavelength.
///
/// # Safety
/// The requirements are those of `realistic_generate_ray`.
pub unsafe fn ray_at(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    wavelength: f32,
    ray: *mut realistic_ray,
) -> f32 {
    // SAFETY: guaranteed by the caller.
    unsafe { realistic_generate_ray(camera, sample, &at(&wavelength), ray) }
}

/// Generates a ray with differentials at a wavelength.
///
/// # Safety
/// The requirements are those of `realistic_generate_ray_differential`.
pub unsafe fn differential_at(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    wavelength: f32,
    ray: *mut realistic_ray_differential,
) -> f32 {
    // SAFETY: guaranteed by the caller.
    unsafe { realistic_generate_ray_differential(camera, sample, &at(&wavelength), ray) }
}

/// Generates the rays of four wavelengths of one sample; returns the call's weight.
///
/// # Safety
/// The requirements are those of `realistic_generate_ray`; the arrays are NULL or have four elements.
pub unsafe fn hero_rays(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    wavelengths: *const f32,
    rays: *mut realistic_ray,
    weights: *mut f32,
) -> f32 {
    let request = realistic_request {
        wavelengths_per_sample: 4,
        wavelength: number(wavelengths, NUMBER),
        weight: room(weights, NUMBER),
        ..Default::default()
    };
    // SAFETY: guaranteed by the caller.
    unsafe { realistic_generate_ray(camera, sample, &request, rays) }
}
