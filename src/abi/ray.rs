//! The exported `GenerateRay`: one ray of a camera, however it was made.

use super::boundary;
use super::object;
use super::types::{realistic_camera, realistic_ray, realistic_sample};

/// One ray of a camera of this library, made by `CreateCamera` or by a C caller.
///
/// Returns the weight; exactly 0 for a ray that the lens blocks. When a pointer is NULL or
/// `camera` is another library's camera, returns 0 and leaves the ray alone.
///
/// # Safety
/// `camera` is NULL or points to an object of at least 8 bytes that lives during the call;
/// `sample` and `ray` are NULL or valid.
#[unsafe(no_mangle)]
#[allow(non_snake_case)]
pub unsafe extern "C" fn GenerateRay(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    boundary::ray(0.0, || {
        // SAFETY: the caller's promise.
        let parts = unsafe { (object::handle_of(camera), sample.as_ref(), ray.as_mut()) };
        match parts {
            (Some(handle), Some(sample), Some(ray)) => handle.generate_exact(sample, ray),
            _ => 0.0,
        }
    })
}
