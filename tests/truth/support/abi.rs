//! Cameras of the C ABI, and their rays to the last bit.

use std::ffi::CStr;
use std::mem::{MaybeUninit, size_of};
use std::ptr::null_mut;

use realistic::abi::*;

/// One that is freed at its end.
pub struct Camera(pub *mut realistic_camera);

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: made by `camera`, freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

/// The default camera of 40 x 30 pixels, but for what `set` changes.
pub fn camera(set: impl FnOnce(&mut realistic_options)) -> Camera {
    let mut options = MaybeUninit::<realistic_options>::zeroed();
    let mut camera = null_mut();
    // SAFETY: room for the whole structure; the strings are constants.
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

/// What stands in a ray that nobody writes.
pub const UNTOUCHED: realistic_ray =
    realistic_ray { o: [-77.0; 3], d: [-78.0; 3], mint: -79.0, maxt: -80.0, time: -81.0 };

/// A ray and its weight, to the last bit.
pub type Bits = [u32; 10];

/// [`Bits`] of a ray.
pub fn bits(ray: &realistic_ray, weight: f32) -> Bits {
    let realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time } = *ray;
    [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight].map(f32::to_bits)
}
