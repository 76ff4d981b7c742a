//! STAND-IN. Takes the place of the real camera until that is merged: a disk in front of
//! the film and a second one that vignettes, with just enough of the parameters' rules for
//! the host tests to run. Keep the signatures; replace the rest.

use std::fs;
use std::path::{Path, PathBuf};

use super::types::{realistic_ray, realistic_sample};
use crate::camera::parameters::Parameters;

/// How important a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// For who wants to know.
    Info,
    /// The camera works, and not quite as asked.
    Warning,
    /// There is no camera.
    Error,
}

/// A built camera.
#[derive(Debug)]
pub struct Handle {
    camera_to_world: [f32; 16],
    half: [f32; 2],
    scale: f32,
    distance: f32,
    clip: [f32; 2],
    shutter: [f32; 2],
}

const CATALOGUE: [&str; 5] = ["dgauss.100mm", "dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
const DISK: f32 = 8.0;
const DISK_DISTANCE: f32 = 30.0;

impl Handle {
    /// Builds a camera for a film of `xres` by `yres` pixels.
    ///
    /// # Errors
    /// A parameter is out of range, two say the same, or the lens cannot be read.
    pub fn build(
        parameters: &Parameters,
        xres: i32,
        yres: i32,
        camera_to_world: [f32; 16],
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<Self, String> {
        if xres < 1 || yres < 1 {
            return Err(format!("the film is {xres} by {yres} pixels"));
        }
        let both = |first: &str, second: &str| {
            Err(format!("\"{first}\" and \"{second}\" say the same thing in two ways; give one of them"))
        };
        if parameters.filmdistance.is_some() && parameters.focusdistance.is_some() {
            return both("filmdistance", "focusdistance");
        }
        if parameters.fnumber.is_some() && parameters.aperture_diameter.is_some() {
            return both("fnumber", "aperture_diameter");
        }
        if parameters.weighting.is_some() && parameters.simpleweighting.is_some() {
            return both("weighting", "simpleweighting");
        }
        if parameters.af_zones.is_some() {
            log(Level::Warning, "\"af_zones\": this host offers no autofocus; give \"focusdistance\"");
        }
        if let Some(specfile) = parameters.specfile.as_deref()
            && !CATALOGUE.contains(&specfile)
        {
            read(specfile)?;
        }
        let diagonal = parameters.filmdiag.unwrap_or(35.0) as f32;
        let (x, y) = (xres as f32, yres as f32);
        Ok(Self {
            camera_to_world,
            half: [x / 2.0, y / 2.0],
            scale: diagonal / x.hypot(y),
            distance: parameters.filmdistance.unwrap_or(40.0) as f32,
            clip: [parameters.hither.unwrap_or(1e-3) as f32, parameters.yon.unwrap_or(1e30) as f32],
            shutter: [
                parameters.shutteropen.unwrap_or(0.0) as f32,
                parameters.shutterclose.unwrap_or(1.0) as f32,
            ],
        })
    }

    /// A ray for a host's vtable: a blocked one has the smallest normal weight and is
    /// complete all the same.
    pub fn generate(&self, sample: &realistic_sample, ray: &mut realistic_ray) -> f32 {
        let (weight, whole) = self.trace(sample);
        *ray = whole;
        weight.max(f32::MIN_POSITIVE)
    }

    /// A ray with its exact weight: 0 when blocked.
    pub fn generate_exact(&self, sample: &realistic_sample, ray: &mut realistic_ray) -> f32 {
        let (weight, whole) = self.trace(sample);
        *ray = whole;
        weight
    }

    fn trace(&self, sample: &realistic_sample) -> (f32, realistic_ray) {
        let film =
            [(self.half[0] - sample.image_x) * self.scale, (sample.image_y - self.half[1]) * self.scale];
        let (radius, angle) = (DISK * sample.lens_u.sqrt(), std::f32::consts::TAU * sample.lens_v);
        let lens = [radius * angle.cos(), radius * angle.sin()];
        let slope = [(lens[0] - film[0]) / self.distance, (lens[1] - film[1]) / self.distance];
        let cosine = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let front = [lens[0] + slope[0] * DISK_DISTANCE, lens[1] + slope[1] * DISK_DISTANCE];
        let passes = front[0].hypot(front[1]) < DISK;
        let area = std::f32::consts::PI * DISK * DISK;
        let weight = if passes { area * cosine.powi(4) / (self.distance * self.distance) } else { 0.0 };
        let m = &self.camera_to_world;
        let direction: [f32; 3] =
            std::array::from_fn(|row| m[4 * row] * slope[0] + m[4 * row + 1] * slope[1] + m[4 * row + 2]);
        let length = direction.iter().map(|part| part * part).sum::<f32>().sqrt();
        let ray = realistic_ray {
            o: std::array::from_fn(|row| m[4 * row] * lens[0] + m[4 * row + 1] * lens[1] + m[4 * row + 3]),
            d: direction.map(|part| part / length),
            mint: self.clip[0],
            maxt: self.clip[1],
            time: self.shutter[0] + sample.time * (self.shutter[1] - self.shutter[0]),
        };
        (weight, ray)
    }
}

fn read(specfile: &str) -> Result<(), String> {
    let search = std::env::var_os("PBRT_SEARCHPATH").unwrap_or_default();
    let beside = super::plugin::plugin_path().and_then(|path| path.parent().map(Path::to_path_buf));
    let candidates = std::iter::once(PathBuf::from(specfile))
        .chain(std::env::split_paths(&search).map(|directory| directory.join(specfile)))
        .chain(beside.map(|directory| directory.join(specfile)));
    let text = candidates
        .into_iter()
        .find_map(|path| fs::read_to_string(path).ok())
        .ok_or_else(|| format!("no lens is called \"{specfile}\"; built in are {}", CATALOGUE.join(", ")))?;
    for (number, line) in text.lines().enumerate() {
        let rows = line.split('#').next().unwrap_or_default();
        if rows.split_whitespace().any(|word| word.parse::<f64>().is_err()) {
            return Err(format!("{specfile}:{}:1: a number was expected", number + 1));
        }
    }
    Ok(())
}
