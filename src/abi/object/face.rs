//! The camera objects of the C++ face: their layout, and the functions of `pbrt-shim/shim.h` that make and end one.

use std::ffi::c_void;

use super::host_part::HostPart;

/// `realistic_shim_parts`.
#[repr(C)]
pub struct Parts {
    pub rust: *mut c_void,
    pub generate: unsafe extern "C" fn(*const c_void, *const c_void, *mut c_void) -> f32,
    pub release: unsafe extern "C" fn(*mut c_void),
    pub host: HostPart,
}

/// Bytes of a host's members between a camera's vtable pointer and its Rust part: `REALISTIC_SHIM_HOST_MEMBERS`.
pub const HOST_MEMBERS: usize = 56;

unsafe extern "C" {
    fn realistic_shim_camera_new(parts: *const Parts) -> *mut c_void;
    fn realistic_shim_camera_delete(camera: *mut c_void);
}

/// A camera object with a host's vtable and members, or NULL when memory is out.
pub fn camera_new(parts: &Parts) -> *mut c_void {
    // SAFETY: the parts are read during the call only.
    unsafe { realistic_shim_camera_new(parts) }
}

/// Deletes a camera object as a host does.
///
/// # Safety
/// `camera` is NULL or of [`camera_new`], and nobody uses it any more.
pub unsafe fn camera_delete(camera: *mut c_void) {
    // SAFETY: the caller's promise.
    unsafe { realistic_shim_camera_delete(camera) }
}
