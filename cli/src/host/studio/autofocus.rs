//! The host's side of autofocus: the plugin requests distances in the scene, or the contrast of trial pictures.

use crate::host::plugin::{self, Plugin, PluginError, Warn};
use crate::host::render::{Settings, render};
use crate::host::scene::Scene;
use crate::host::scene::shapes::Ray;
use crate::image::Picture;
use ::realistic_camera::{Parameters, autofocus::Rule};
use glam::Vec3;
use indicatif::ProgressBar;
use rayon::ThreadPool;
use realistic::ffi::{realistic_camera, realistic_ray, realistic_zone};
use realistic_lab::render::Rays;
use std::ffi::c_void;

/// The measurement that the plugin requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Method {
    /// Distances along a few rays
    Distance,
    /// Contrast of trial pictures
    Contrast,
}

/// Data of the callbacks.
pub struct Autofocus<'a> {
    /// Plugin that makes the cameras.
    pub plugin: &'a Plugin,
    /// Threads for the trial pictures.
    pub pool: &'a ThreadPool,
    /// Scene in front of the camera.
    pub scene: &'a Scene,
    /// Parameters of the camera, without a focus.
    pub parameters: &'a Parameters,
    /// Width and height of the picture.
    pub size: [u32; 2],
}

impl Autofocus<'_> {
    /// Returns the film distance, mm, that focuses the zones, given as left, top, width and height.
    ///
    /// # Errors
    /// The plugin's error: there is nothing to focus on, or a zone lies outside the picture.
    pub fn film_distance(
        &self,
        zones: &[[f32; 4]],
        rule: Rule,
        method: Method,
        warn: Warn<'_>,
    ) -> Result<f64, PluginError> {
        let (options, _strings) =
            plugin::c_options(self.plugin, self.parameters, self.size, &self.scene.pose, &warn)?;
        let zone = |&[left, top, width, height]: &[f32; 4]| realistic_zone {
            left,
            top,
            right: left + width,
            bottom: top + height,
        };
        let zones: Vec<realistic_zone> = zones.iter().map(zone).collect();
        let mut found = f64::NAN;
        let user = std::ptr::from_ref(self).cast_mut().cast();
        // SAFETY: the options, the zones, `warn` and `self` live until the end of this function; the
        // callbacks cast `user` to its true type.
        let status = unsafe {
            (self.plugin.functions.autofocus)(
                &options,
                zones.as_ptr(),
                zones.len(),
                rule as i32,
                (method == Method::Distance).then_some(distance),
                (method == Method::Contrast).then_some(contrast),
                user,
                &mut found,
            )
        };
        self.plugin.check(status)?;
        Ok(found)
    }

    fn mm_per_unit(&self) -> f32 {
        self.parameters.mm_per_unit.unwrap_or(1.0) as f32
    }

    fn distance(&self, ray: &realistic_ray) -> f64 {
        let mm = self.mm_per_unit();
        let origin = Vec3::from_array(ray.o) * mm;
        let ray = Ray { origin, direction: Vec3::from_array(ray.d), time: ray.time };
        self.scene.nearest(&ray, 0.0).map_or(f64::INFINITY, |(hit, _)| f64::from(hit.distance / mm))
    }

    /// Returns the mean square difference between the brightness of neighbouring pixels, relative to the mean
    /// brightness, in small pictures of the zone. Each squared difference is the product of the differences in two
    /// pictures with independent noise. The noise therefore averages out and does not raise the contrast of a blurred
    /// trial picture with few rays.
    fn contrast(&self, camera: *const realistic_camera, zone: &realistic_zone) -> Result<f64, PluginError> {
        const RAYS: u32 = 16_384;
        /// Largest contrast that still looks even to the eye.
        const VISIBLE: f64 = 0.01;
        let corner = [zone.left, zone.top].map(|side| side as u32);
        let end = [zone.right, zone.bottom].map(|side| side.ceil() as u32);
        let size = [0, 1].map(|axis| end[axis] - corner[axis]);
        let spp = (RAYS / (size[0] * size[1])).clamp(2, 64);
        let trial = Trial { plugin: self.plugin, camera };
        let render_trial = |seed: u64| {
            let mm_per_unit = self.mm_per_unit();
            let settings = Settings { corner, mm_per_unit, ..Settings::plain(size, spp, seed) };
            let render = || render(|rays| trial.rays(rays), self.scene, &settings, &ProgressBar::hidden());
            let (picture, _) = self.pool.install(render)?;
            Ok::<_, PluginError>(brightness(&picture))
        };
        let (one, two) = (render_trial(1)?, render_trial(2)?);
        let mean = one.iter().chain(&two).sum::<f64>() / (2 * one.len()) as f64;
        let steps = |values: &[f64]| {
            let rows = values.chunks_exact(size[0] as usize);
            let beside = rows.flat_map(|row| row.windows(2)).map(|pair| pair[1] - pair[0]);
            let below = values.iter().zip(values.iter().skip(size[0] as usize)).map(|(a, b)| a - b);
            beside.chain(below).collect::<Vec<f64>>()
        };
        let product: f64 = steps(&one).iter().zip(steps(&two)).map(|(a, b)| a * b).sum();
        let contrast = product / one.len() as f64 / (mean * mean);
        Ok(if contrast > VISIBLE * VISIBLE { contrast } else { 0.0 })
    }
}

/// Returns the square root of the luminance of every pixel, so that a lamp does not dominate.
fn brightness(picture: &Picture) -> Vec<f64> {
    let light = |[r, g, b]: &[f32; 3]| f64::from((0.2126 * r + 0.7152 * g + 0.0722 * b).max(0.0).sqrt());
    picture.pixels.iter().map(light).collect()
}

/// The camera that the plugin passes to a callback.
struct Trial<'a> {
    plugin: &'a Plugin,
    camera: *const realistic_camera,
}

// SAFETY: the ABI states that any number of threads may request rays.
unsafe impl Sync for Trial<'_> {}

impl Trial<'_> {
    fn rays(&self, rays: Rays<'_>) -> Result<(), PluginError> {
        // SAFETY: the camera is the plugin's and lives until the callback returns.
        unsafe { plugin::generate(self.plugin, self.camera, rays) }
    }
}

unsafe extern "C" fn distance(user: *mut c_void, ray: *const realistic_ray) -> f64 {
    // SAFETY: `user` is the pointer that `film_distance` passed, and the plugin passes a ray.
    unsafe { (*user.cast::<Autofocus<'_>>()).distance(&*ray) }
}

unsafe extern "C" fn contrast(
    user: *mut c_void,
    camera: *const realistic_camera,
    zone: *const realistic_zone,
) -> f64 {
    // SAFETY: as above, but the plugin passes a camera and a zone.
    unsafe { (*user.cast::<Autofocus<'_>>()).contrast(camera, &*zone) }.unwrap_or(f64::NAN)
}
