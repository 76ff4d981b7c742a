//! The cameras whose estimates are compared: every way to sample the pupil and the lens numbers.

use super::subject::FILM_DIAGONAL;
use crate::camera::{CameraError, Host, Outcome, Parameters, Raster, RealisticCamera, Sample};

/// The ways to sample the pupil, by the parameter `pupil`.
pub const PUPILS: &[&str] = &["rear", "disk", "warped"];
/// The ways from lens numbers to the unit disk, by the parameter `disk`.
pub const DISKS: &[&str] = &["concentric", "polar", "rejection"];

/// A camera as a host would build it for a lens of the catalogue focused at infinity.
///
/// # Errors
/// As [`RealisticCamera::build`].
pub fn camera(lens: &str, raster: Raster, given: Parameters) -> Result<RealisticCamera, CameraError> {
    let parameters = Parameters {
        specfile: Some(lens.to_owned()),
        filmdiag: Some(FILM_DIAGONAL),
        focusdistance: Some(f64::INFINITY),
        ..given
    };
    RealisticCamera::build(&parameters, &Host::new(raster, None), &mut |_, _| {})
}

/// A ray in lens space, mm, and its weight.
pub type Shot = ([f32; 3], [f32; 3], f32);

/// What a camera makes of a sample: nothing where the sample is to be drawn again, a weight of 0 where the
/// lens blocks it.
pub fn shoot(camera: &RealisticCamera, sample: &Sample) -> Option<Shot> {
    match camera.generate(sample) {
        Outcome::Ray(ray, weight) => Some((ray.origin, ray.direction, weight)),
        Outcome::Blocked(_) | Outcome::Shut => Some(([0.0; 3], [0.0, 0.0, 1.0], 0.0)),
        Outcome::Redraw => None,
    }
}
