//! A camera of the library that is linked into the tests, and statistics of pictures from it.

use crate::host::plugin::{Connections, PluginError, ScenePoints, connect, request_of};
use crate::image::Picture;
use realistic::ffi::*;
use realistic_lab::render::Rays;
use std::mem::MaybeUninit;
use std::ptr::null_mut;

/// Number of independent pictures of each kind.
pub const PICTURES: u32 = 16;

/// A camera of the linked library, wide open.
pub struct Linked(*mut realistic_camera);

// SAFETY: a camera is immutable, and is freed once.
unsafe impl Sync for Linked {}

impl Linked {
    /// Makes a camera for a picture of this size, focused at `focus_distance`, mm from the film.
    pub fn new([width, height]: [u32; 2], focus_distance: f64) -> Self {
        let mut options = MaybeUninit::<realistic_options>::zeroed();
        let mut camera = null_mut();
        // SAFETY: there is room for the whole structure, and its pointers live until the camera is built.
        unsafe {
            let size = size_of::<realistic_options>() as u32;
            assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
            let mut options = options.assume_init();
            (options.xres, options.yres, options.focus_distance) =
                (width as i32, height as i32, focus_distance);
            assert_eq!(realistic_camera_new(&options, &mut camera), realistic_status::Ok);
        }
        Self(camera)
    }

    /// Generates rays.
    pub fn rays(&self, rays: Rays<'_>) -> Result<(), PluginError> {
        let n = rays.samples.len();
        // SAFETY: the slices are of one length.
        let status = unsafe { realistic_camera_generate_batch(self.0, n, &request_of(rays)) };
        assert_eq!(status, realistic_status::Ok);
        Ok(())
    }

    /// Connects points to the camera.
    pub fn connect(&self, scene_points: &ScenePoints, found: &mut Connections) -> Result<(), PluginError> {
        unsafe extern "C" fn sample(
            camera: *const realistic_camera,
            n: usize,
            points: *const realistic_scene_points,
            aimed: *const realistic_aimed,
            importance: *const realistic_importance,
        ) -> i32 {
            // SAFETY: the caller's promise.
            unsafe { realistic_camera_sample_importance(camera, n, points, aimed, importance) as i32 }
        }
        // SAFETY: the camera is alive and belongs to this library.
        assert_eq!(unsafe { connect(sample, self.0, scene_points, found) }, 0);
        Ok(())
    }
}

impl Drop for Linked {
    fn drop(&mut self) {
        // SAFETY: the camera is freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

/// Returns the mean and the squared standard error of every value, over pictures with different seeds.
pub fn pictures(picture: impl Fn(u64) -> Picture) -> Vec<[f64; 2]> {
    let all: Vec<Picture> = (0..u64::from(PICTURES)).map(|seed| picture(100 + seed)).collect();
    let n = f64::from(PICTURES);
    (0..all[0].pixels.len() * 3)
        .map(|i| {
            let numbers = || all.iter().map(move |picture| f64::from(picture.pixels[i / 3][i % 3]));
            let mean = numbers().sum::<f64>() / n;
            [mean, numbers().map(|number| (number - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))]
        })
        .collect()
}
