//! One ray of a camera, however it was made.

use super::boundary;
use super::float_environment;
use super::object;
use super::types::{realistic_camera, realistic_ray, realistic_sample};
use crate::camera::{Sample, WorldRay};

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
            float_environment::for_ray(|| handle.camera().trace_one(sample, ray, &mut weight));
        }
        true
    });
    if is_done { weight } else { 0.0 }
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
