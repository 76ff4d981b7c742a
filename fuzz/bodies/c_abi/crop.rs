//! A crop window, which is either refused or reported back, and changes no ray.

use std::ptr::null_mut;

use super::{LiveCamera, bytes::Bytes, last_error, no_info};
use realistic::ffi::*;

/// Checks a camera with a window, and panics if its rays differ from those of `full`, or if it
/// reports another window.
pub fn check(full: &LiveCamera<'_>, singles: &[(realistic_ray, f32)], bytes: &mut Bytes<'_>) {
    let mut options = *full.options;
    let (wide, high) = (options.xres.max(1) as usize, options.yres.max(1) as usize);
    let mut pixels = |most: usize| {
        let first = bytes.choice(most.min(256));
        [first, first + 1 + bytes.choice((most - first).min(256))]
    };
    let [[left, right], [top, bottom]] = [pixels(wide), pixels(high)];
    let inside = [left, top, right, bottom];
    options.crop = inside.map(|pixel| pixel as f64);
    let is_inside = bytes.choice(4) != 0;
    if !is_inside {
        options.crop[bytes.choice(4)] = bytes.number();
    }
    let mut camera = null_mut();
    // SAFETY: the options and all that they point to live during the call; so does `camera`.
    let status = unsafe { realistic_camera_new(&options, &mut camera) };
    if status != realistic_status::Ok {
        let message = last_error();
        assert!(!is_inside && camera.is_null() && message.contains("crop"), "{message} {options:?}");
        return;
    }
    let mut info = no_info();
    // SAFETY: the camera is live; there is a structure of its size.
    assert_eq!(unsafe { realistic_camera_get_info(camera, &mut info) }, realistic_status::Ok);
    if is_inside {
        assert_eq!(info.crop.map(|pixel| pixel as usize), inside, "{options:?}");
    }
    let cropped = LiveCamera { camera, samples: full.samples, options: &options };
    assert!(cropped.singles() == singles, "{options:?}");
    // SAFETY: no call uses the camera any more.
    unsafe { realistic_camera_free(camera) };
}
