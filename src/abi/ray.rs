//! One ray of a camera, however it was made.

use super::boundary;
use super::object;
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
        handle.camera().trace_neighbours(sample, &mut rays);
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
