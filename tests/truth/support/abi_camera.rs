//! Cameras of the C ABI.

use std::ffi::CStr;
use std::mem::{MaybeUninit, size_of};
use std::ptr::null_mut;

use realistic::ffi::*;

/// A camera that is freed on drop.
pub struct Camera(pub *mut realistic_camera);

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: the camera was made by `camera` and is freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

/// Builds the default camera with 40 x 30 pixels; `set` changes its options.
pub fn camera(set: impl FnOnce(&mut realistic_options)) -> Camera {
    let mut options = MaybeUninit::<realistic_options>::zeroed();
    let mut camera = null_mut();
    // SAFETY: there is room for the whole structure; the strings are constants.
    unsafe {
        let size = size_of::<realistic_options>() as u32;
        assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
        let mut options = options.assume_init();
        (options.xres, options.yres) = (40, 30);
        set(&mut options);
        let status = realistic_camera_new(&options, &mut camera);
        assert_eq!(status, realistic_status::Ok, "{:?}", CStr::from_ptr(realistic_last_error()));
    }
    Camera(camera)
}
