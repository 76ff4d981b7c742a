//! Camera objects: a [`Handle`] in the shape that the ABI hands out.
//!
//! Where the C++ face is built the object has a pbrt-v1 host's vtable and members, so that
//! one kind of camera serves C callers and that host alike. Elsewhere it is a tagged box.

use super::handle::Handle;
use super::types::realistic_camera;
use crate::camera::Camera;

/// What a host keeps in a camera besides the rays; nobody reads it in a C-made camera.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(realistic_shim), expect(dead_code, reason = "only a pbrt-v1 host has such members"))]
pub struct HostPart {
    /// The host's film, which the camera deletes in the end; NULL for none.
    pub film: *mut std::ffi::c_void,
    /// Row-major, for column vectors.
    pub world_to_camera: [f32; 16],
    /// Its inverse.
    pub camera_to_world: [f32; 16],
    /// World units.
    pub hither: f32,
    /// World units.
    pub yon: f32,
    /// When the shutter opens.
    pub shutter_open: f32,
    /// When the shutter closes.
    pub shutter_close: f32,
}

impl HostPart {
    /// What a host keeps of a camera; `film` and the two matrices are its own.
    pub fn of(
        camera: &Camera,
        film: *mut std::ffi::c_void,
        world_to_camera: [f32; 16],
        camera_to_world: [f32; 16],
    ) -> Self {
        let [hither, yon] = camera.clip();
        let [shutter_open, shutter_close] = camera.shutter_interval();
        Self { film, world_to_camera, camera_to_world, hither, yon, shutter_open, shutter_close }
    }
}

pub use implementation::{delete, handle_of, new};

#[cfg(realistic_shim)]
mod implementation {
    use super::super::boundary;
    use super::super::shim::{self, Parts};
    use super::super::types::{realistic_ray, realistic_sample};
    use super::{Handle, HostPart, realistic_camera};
    use std::ffi::c_void;

    /// Makes a camera object. `None` when memory is out; then the film stays the host's.
    pub fn new(handle: Handle, host: &HostPart) -> Option<*mut realistic_camera> {
        let rust = Box::into_raw(Box::new(handle));
        let camera = shim::camera_new(&Parts {
            rust: rust.cast(),
            generate,
            release,
            film: host.film,
            world_to_camera: host.world_to_camera,
            camera_to_world: host.camera_to_world,
            hither: host.hither,
            yon: host.yon,
            shutter_open: host.shutter_open,
            shutter_close: host.shutter_close,
        });
        if camera.is_null() {
            // SAFETY: just made from a box, and no camera took it.
            drop(unsafe { Box::from_raw(rust) });
            return None;
        }
        Some(camera.cast())
    }

    /// The handle in a camera of [`new`]; `None` for NULL and for any other object.
    ///
    /// # Safety
    /// `camera` is NULL, or a live camera of [`new`], or 8 bytes can be read there.
    pub unsafe fn handle_of<'a>(camera: *const realistic_camera) -> Option<&'a Handle> {
        // SAFETY: the caller's promise; the Rust part of our camera is a boxed `Handle`,
        // never changed until the camera is deleted.
        unsafe { shim::camera_rust(camera.cast()).cast::<Handle>().as_ref() }
    }

    /// Ends a camera of [`new`], its film with it. False, and nothing done, when it is none.
    ///
    /// # Safety
    /// As [`handle_of`], and nobody uses the camera any more.
    pub unsafe fn delete(camera: *mut realistic_camera) -> bool {
        // SAFETY: the caller's promise.
        unsafe {
            let ours = !shim::camera_rust(camera.cast()).is_null();
            if ours {
                shim::camera_delete(camera.cast());
            }
            ours
        }
    }

    /// The vtable's first slot. A pbrt-v1 host passes its own `Sample` and `Ray`.
    unsafe extern "C" fn generate(rust: *const c_void, sample: *const c_void, ray: *mut c_void) -> f32 {
        // SAFETY: `rust` is the handle of `new`; the host's structures begin with ours
        // (a test compares the layouts), are valid and are not shared during the call.
        let (handle, sample, ray) = unsafe {
            (&*rust.cast::<Handle>(), &*sample.cast::<realistic_sample>(), &mut *ray.cast::<realistic_ray>())
        };
        // The fallback is what a blocked ray gives here: a weight of 0 would make the host
        // read an uninitialised alpha.
        boundary::ray(f32::MIN_POSITIVE, || handle.generate_for_host(sample, ray))
    }

    /// From the camera's destructor.
    unsafe extern "C" fn release(rust: *mut c_void) {
        boundary::ray((), || {
            // SAFETY: made from a box in `new`; the destructor runs once.
            drop(unsafe { Box::from_raw(rust.cast::<Handle>()) });
        });
    }
}

#[cfg(not(realistic_shim))]
mod implementation {
    use super::{Handle, HostPart, realistic_camera};

    /// Its address is the tag; it must not share one with another constant.
    static TAG: u8 = 0x52;

    #[repr(C)]
    struct Plain {
        tag: *const u8,
        handle: Handle,
    }

    /// Makes a camera object. There is no host here that a film could belong to.
    pub fn new(handle: Handle, _host: &HostPart) -> Option<*mut realistic_camera> {
        Some(Box::into_raw(Box::new(Plain { tag: &raw const TAG, handle })).cast())
    }

    /// The handle in a camera of [`new`]; `None` for NULL and for any other object.
    ///
    /// # Safety
    /// `camera` is NULL, or a live camera of [`new`], or a pointer can be read there.
    pub unsafe fn handle_of<'a>(camera: *const realistic_camera) -> Option<&'a Handle> {
        let plain = camera.cast::<Plain>();
        if plain.is_null() || !plain.is_aligned() {
            return None;
        }
        // SAFETY: the caller's promise; past the tag only when the object is ours.
        unsafe { (*plain.cast::<*const u8>() == &raw const TAG).then(|| &(*plain).handle) }
    }

    /// Ends a camera of [`new`]. False, and nothing done, when it is none.
    ///
    /// # Safety
    /// As [`handle_of`], and nobody uses the camera any more.
    pub unsafe fn delete(camera: *mut realistic_camera) -> bool {
        // SAFETY: the caller's promise; the tag says that it came from a box in `new`.
        unsafe {
            let ours = handle_of(camera).is_some();
            if ours {
                drop(Box::from_raw(camera.cast::<Plain>()));
            }
            ours
        }
    }
}
