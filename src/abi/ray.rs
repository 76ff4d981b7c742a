//! One ray of a camera, however it was made.

use super::boundary;
use super::object::{self, Handle};
use super::types::{
    REALISTIC_HAS_RX, REALISTIC_HAS_RY, realistic_camera, realistic_ray, realistic_ray_differential,
    realistic_sample,
};
use crate::camera::{RayArrays, RayBlock, Sample, WorldRay};

/// One ray of a camera of this library, made by `CreateCamera` or by `realistic_camera_new`.
///
/// Returns the weight, positive. For a ray that the lens blocks, when a pointer is NULL, and when
/// `camera` is another library's camera, returns exactly 0 and leaves the ray as it is.
///
/// # Safety
/// `camera` is NULL or points to an object of at least 8 bytes that lives during the call;
/// `sample` and `ray` are NULL or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_ray(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    // Where the tracer writes it, to be read once.
    let mut weight = 0.0;
    let is_done = boundary::ray(false, || {
        // SAFETY: the caller's promise.
        let parts = unsafe {
            (object::handle_of(camera), sample.cast::<Sample>().as_ref(), ray.cast::<WorldRay>().as_mut())
        };
        if let (Some(handle), Some(sample), Some(ray)) = parts {
            boundary::float_environment::for_ray(|| handle.camera().trace_one(sample, ray, &mut weight));
        }
        true
    });
    if is_done { weight } else { 0.0 }
}

/// One ray of a camera at a wavelength, nm.
///
/// The index of each glass is that of its own formula at this wavelength, from 380 to 780 nm. Everything else stands as
/// the camera's own wavelength has it: film, stop, groups, and what `weighting` divides by. A lens file without dispersion
/// data has the same rays at every wavelength, as have the models other than "lens". The first call for a wavelength
/// prepares the camera, once and for all threads, which takes some milliseconds. With a `tolerance` or a named
/// `refraction`, rays at a wavelength are traced exactly all the same.
///
/// Returns the weight, positive. Returns exactly 0, and leaves the ray as it is, where `realistic_generate_ray` does, and
/// when the wavelength is not a number from 380 to 780.
///
/// # Safety
/// As `realistic_generate_ray`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_ray_at(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    wavelength_nm: f32,
    ray: *mut realistic_ray,
) -> f32 {
    boundary::ray(0.0, || {
        // SAFETY: the caller's promise.
        let parts = unsafe {
            (object::handle_of(camera), sample.cast::<Sample>().as_ref(), ray.cast::<WorldRay>().as_mut())
        };
        let (Some(handle), Some(sample), Some(ray)) = parts else { return 0.0 };
        let mut weight = 0.0;
        boundary::float_environment::in_default(|| {
            if is_ready(handle) {
                handle.camera().trace_one_at(sample, wavelength_nm, ray, &mut weight);
            }
        });
        weight
    })
}

/// The rays of one sample at four wavelengths (nm), traced side by side, for hosts whose paths carry four (A. Wilkie et
/// al., "Hero Wavelength Spectral Sampling", *Computer Graphics Forum* 33(4), 2014): each as `realistic_generate_ray_at` has
/// it.
///
/// Writes `weights`, and of `rays` those whose weight is positive. Returns how many that are; 0, and nothing written, when
/// a pointer is NULL or `camera` is another library's.
///
/// # Safety
/// As `realistic_generate_ray`; `wavelengths_nm`, `rays` and `weights` are NULL or have four elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_hero_rays(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    wavelengths_nm: *const f32,
    rays: *mut realistic_ray,
    weights: *mut f32,
) -> u32 {
    boundary::ray(0, || {
        // SAFETY: the caller's promise.
        let parts = unsafe {
            (
                object::handle_of(camera),
                sample.cast::<Sample>().as_ref(),
                wavelengths_nm.cast::<[f32; 4]>().as_ref(),
                rays.cast::<[realistic_ray; 4]>().as_mut(),
                weights.cast::<[f32; 4]>().as_mut(),
            )
        };
        let (Some(handle), Some(sample), Some(wavelengths), Some(rays), Some(weights)) = parts else {
            return 0;
        };
        let found = boundary::float_environment::in_default(|| {
            if is_ready(handle) { handle.camera().hero_rays(sample, wavelengths) } else { [None; 4] }
        });
        let mut count = 0;
        for ((found, ray), weight) in found.into_iter().zip(rays).zip(weights) {
            *weight = found.map_or(0.0, |(_, weight)| weight);
            if let Some((found, _)) = found {
                *ray = found.into();
                count += 1;
            }
        }
        count
    })
}

/// Whether rays at a wavelength can be asked for: there is memory for what the first of them builds.
fn is_ready(handle: &Handle) -> bool {
    handle.camera().is_ready_for_wavelengths() || boundary::memory::to_build().is_ok()
}

/// One ray with its differentials: the ray of the sample, and those of the same lens and time sample one pixel to the
/// right and one pixel down, in little more than the time of one. They have the bits that `realistic_generate_ray` gives
/// for samples at `image_x` + 1 and at `image_y` + 1. `ray->struct_size` must be set.
///
/// Returns the weight of the sample's ray, positive. Returns exactly 0, and leaves `ray` as it is, where
/// `realistic_generate_ray` does, and when `ray->struct_size` is none that this library knows.
///
/// # Safety
/// `camera` is NULL or points to an object of at least 8 bytes that lives during the call;
/// `sample` and `ray` are NULL or valid, `ray` for its `struct_size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_ray_differential(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray_differential,
) -> f32 {
    // SAFETY: the caller's promise.
    unsafe {
        differential(camera, sample, ray, |handle, sample, rays| {
            boundary::float_environment::for_ray(|| handle.camera().trace_neighbours(sample, rays));
        })
    }
}

/// One ray at a wavelength, nm, with its differentials: the ray of the sample, and those of the same lens and time sample
/// and the same wavelength one pixel to the right and one pixel down. They have the bits that `realistic_generate_ray_at`
/// gives for samples at `image_x` + 1 and at `image_y` + 1. `ray->struct_size` must be set.
///
/// Returns the weight of the sample's ray, positive. Returns exactly 0, and leaves `ray` as it is, where
/// `realistic_generate_ray_at` does, and when `ray->struct_size` is none that this library knows.
///
/// # Safety
/// As `realistic_generate_ray_differential`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_ray_differential_at(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    wavelength_nm: f32,
    ray: *mut realistic_ray_differential,
) -> f32 {
    // SAFETY: the caller's promise.
    unsafe {
        differential(camera, sample, ray, |handle, sample, rays| {
            boundary::float_environment::in_default(|| {
                if is_ready(handle) {
                    handle.camera().trace_neighbours_at(sample, wavelength_nm, rays);
                }
            });
        })
    }
}

/// A ray with its differentials, as `trace` makes them: a sample's ray in the first place, then its neighbours.
///
/// # Safety
/// As [`realistic_generate_ray_differential`].
#[inline(always)]
unsafe fn differential(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray_differential,
    trace: impl FnOnce(&Handle, &Sample, &mut RayBlock<4>),
) -> f32 {
    boundary::ray(0.0, || {
        if ray.is_null() {
            return 0.0;
        }
        // SAFETY: not NULL; the first field is always there.
        let size = unsafe { (&raw const (*ray).struct_size).read() } as usize;
        if size != size_of::<realistic_ray_differential>() {
            return 0.0;
        }
        // SAFETY: the caller's promise, and the size is right.
        let parts = unsafe { (object::handle_of(camera), sample.cast::<Sample>().as_ref(), &mut *ray) };
        let (Some(handle), Some(sample), ray) = parts else { return 0.0 };
        let mut rays = RayBlock::new();
        trace(handle, sample, &mut rays);
        if rays.weight(0) > 0.0 {
            give(&mut rays, ray);
        }
        rays.weight(0)
    })
}

/// Hands out a ray and its neighbours, number by number, as they were written in vectors.
#[inline(always)]
fn give(rays: &mut RayBlock<4>, to: &mut realistic_ray_differential) {
    let RayArrays { origin, direction, mint, maxt, time, weight } = rays.arrays(4);
    let first = |array: Option<&mut [f32]>| array.map_or(0.0, |array| array[0]);
    // Of a neighbour that is missing, the ray itself.
    let [rx, ry] = [1, 2].map(|place| if weight[place] > 0.0 { place } else { 0 });
    to.has = u32::from(rx != 0) * REALISTIC_HAS_RX + u32::from(ry != 0) * REALISTIC_HAS_RY;
    for axis in 0..3 {
        let (o, d) = (&*origin[axis], &*direction[axis]);
        (to.ray.o[axis], to.rx_o[axis], to.ry_o[axis]) = (o[0], o[rx], o[ry]);
        (to.ray.d[axis], to.rx_d[axis], to.ry_d[axis]) = (d[0], d[rx], d[ry]);
    }
    (to.ray.mint, to.ray.maxt, to.ray.time) = (first(mint), first(maxt), first(time));
}

/// [`realistic_generate_ray`] under the name and with the types that the assignment gives it: for
/// `const Camera *`, `const Sample *` and `Ray *` of a pbrt-v1 host.
///
/// # Safety
/// As [`realistic_generate_ray`].
#[unsafe(no_mangle)]
#[allow(non_snake_case)]
pub unsafe extern "C" fn GenerateRay(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    // SAFETY: the caller's promise.
    unsafe { realistic_generate_ray(camera, sample, ray) }
}
