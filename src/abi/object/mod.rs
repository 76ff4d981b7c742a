//! Camera objects: a [`Handle`] in the layout that the ABI returns, and the check whether an object is such a
//! camera.
//!
//! If the C++ part is built, the object has the vtable and members of a pbrt-v1 host's camera, so that one
//! kind of camera serves both C callers and that host. Otherwise the object is a tagged box. In both cases
//! the first word identifies the object, without a call.
//!
//! `handle` defines the camera in an object; `tagged` defines a box with a tag, which also holds lenses;
//! `triples` serves the calls of a pbrt-v1 host.

mod handle;
mod tagged;
#[cfg(realistic_shim)]
mod triples;

use super::types::realistic_camera;

pub use handle::{Handle, HostPart};
pub use implementation::{delete, handle_of, new};
pub use tagged::Tagged;

#[cfg(realistic_shim)]
mod implementation {
    use super::{Handle, HostPart, realistic_camera, triples};
    use crate::abi::boundary;
    use ::realistic_camera::{Sample, WorldRay};
    use std::ffi::c_void;
    use std::ptr::null_mut;
    use std::sync::atomic::{AtomicPtr, Ordering};

    /// Parts of a camera that are passed to the C++ part: `realistic_shim_parts` of `pbrt-shim/shim.h`.
    #[repr(C)]
    struct ShimParts {
        rust: *mut c_void,
        generate: unsafe extern "C" fn(*const c_void, *const c_void, *mut c_void) -> f32,
        release: unsafe extern "C" fn(*mut c_void),
        host: HostPart,
    }

    /// Number of bytes of a host's members between a camera's vtable pointer and its Rust part:
    /// `REALISTIC_SHIM_HOST_MEMBERS`.
    const HOST_MEMBERS: usize = 56;

    unsafe extern "C" {
        fn realistic_shim_camera_new(parts: *const ShimParts) -> *mut c_void;
        fn realistic_shim_camera_delete(camera: *mut c_void);
    }

    /// Makes a camera object with a host's vtable and members; returns NULL if memory is exhausted.
    fn camera_new(parts: &ShimParts) -> *mut c_void {
        // SAFETY: the parts are read during the call only.
        unsafe { realistic_shim_camera_new(parts) }
    }

    /// Deletes a camera object as a host does.
    ///
    /// # Safety
    /// `camera` is NULL or was made by [`camera_new`], and nobody uses it any more.
    unsafe fn camera_delete(camera: *mut c_void) {
        // SAFETY: the caller's promise.
        unsafe { realistic_shim_camera_delete(camera) }
    }

    /// The beginning of a camera object as `camera.cpp` lays it out.
    #[repr(C)]
    struct Object {
        vtable: *mut c_void,
        host: [u8; HOST_MEMBERS],
        handle: *const Handle,
    }

    /// The vtable pointer that all cameras made here share; NULL before the first is made.
    static VTABLE: AtomicPtr<c_void> = AtomicPtr::new(null_mut());

    /// Makes a camera object; `None` if memory is exhausted, and then the host still owns the film.
    pub fn new(handle: Handle, host: &HostPart) -> Option<*mut realistic_camera> {
        let rust = Box::into_raw(Box::new(handle));
        let camera = camera_new(&ShimParts { rust: rust.cast(), generate, release, host: *host });
        if camera.is_null() {
            // SAFETY: `rust` was just made from a box, and no camera owns it.
            drop(unsafe { Box::from_raw(rust) });
            return None;
        }
        // SAFETY: the pointer is to a camera object, whose first word is its vtable pointer.
        VTABLE.store(unsafe { (*camera.cast::<Object>()).vtable }, Ordering::Relaxed);
        Some(camera.cast())
    }

    /// Returns the handle in a camera made by [`new`]; `None` for NULL and for any other object.
    ///
    /// # Safety
    /// `camera` is NULL or a live camera made by [`new`], or 8 bytes can be read there.
    #[inline]
    pub unsafe fn handle_of<'a>(camera: *const realistic_camera) -> Option<&'a Handle> {
        let object = camera.cast::<Object>();
        // A misaligned pointer cannot be one of our objects and is not read.
        if object.is_null() || !object.is_aligned() {
            return None;
        }
        // SAFETY: the caller's promise. Memory past the vtable pointer is read only if the object is ours;
        // its boxed `Handle` does not change until the camera is deleted.
        unsafe {
            let vtable = (&raw const (*object).vtable).read();
            let is_ours = !vtable.is_null() && vtable == VTABLE.load(Ordering::Relaxed);
            is_ours.then(|| &*(*object).handle)
        }
    }

    /// Deletes a camera made by [`new`] and its film. For any other object it does nothing and returns false.
    ///
    /// # Safety
    /// The promises of [`handle_of`]; also, nobody uses the camera any more.
    pub unsafe fn delete(camera: *mut realistic_camera) -> bool {
        // SAFETY: the caller's promise.
        unsafe {
            let is_ours = handle_of(camera).is_some();
            if is_ours {
                camera_delete(camera.cast());
            }
            is_ours
        }
    }

    /// Generates a ray; this is the vtable's first slot. A pbrt-v1 host passes its own `Sample` and `Ray`.
    unsafe extern "C" fn generate(rust: *const c_void, sample: *const c_void, ray: *mut c_void) -> f32 {
        // SAFETY: `rust` is the handle from `new`. The host's structures begin with ours (a test compares the
        // layouts), are valid, and are not shared during the call.
        let (handle, sample, ray) =
            unsafe { (&*rust.cast::<Handle>(), &*sample.cast::<Sample>(), &mut *ray.cast::<WorldRay>()) };
        // The fallback is the weight that a blocked ray has here, because a weight of 0 would make the host
        // read an uninitialised alpha.
        boundary::ray(f32::MIN_POSITIVE, || triples::generate(handle, sample, ray))
    }

    /// Frees the handle. The camera's destructor calls this.
    unsafe extern "C" fn release(rust: *mut c_void) {
        boundary::ray((), || {
            // SAFETY: the pointer was made from a box in `new`, and the destructor runs once.
            drop(unsafe { Box::from_raw(rust.cast::<Handle>()) });
        });
    }
}

#[cfg(not(realistic_shim))]
mod implementation {
    use super::{Handle, HostPart, Tagged, realistic_camera};

    static TAG: u8 = 0x52;

    /// Makes a camera object. Without a host, the object has no film.
    pub fn new(handle: Handle, _host: &HostPart) -> Option<*mut realistic_camera> {
        Some(Tagged::boxed(&TAG, handle).cast())
    }

    /// Returns the handle in a camera made by [`new`]; `None` for NULL and for any other object.
    ///
    /// # Safety
    /// `camera` is NULL or a live camera made by [`new`], or memory of the size of a pointer can be read
    /// there.
    pub unsafe fn handle_of<'a>(camera: *const realistic_camera) -> Option<&'a Handle> {
        // SAFETY: the caller's promise.
        unsafe { Tagged::of(camera.cast(), &TAG) }
    }

    /// Deletes a camera made by [`new`]. For any other object it does nothing and returns false.
    ///
    /// # Safety
    /// The promises of [`handle_of`]; also, nobody uses the camera any more.
    pub unsafe fn delete(camera: *mut realistic_camera) -> bool {
        // SAFETY: the caller's promise.
        unsafe { Tagged::<Handle>::free(camera.cast(), &TAG) }
    }
}
