//! The cameras whose estimates are compared: one for every sampling of the pupil and every mapping to the unit disk.

use crate::subject::FILM_DIAGONAL;
use realistic_camera::{Camera, CameraError, Host, Parameters, Raster, Sample, sampling::DiskMapping};

/// Values of the parameter `pupil`: the samplings of the pupil.
pub const PUPILS: &[&str] = &["rear", "disk", "warped"];
/// Values of the parameter `disk`: the mappings from the lens sample (u, v) to the unit disk.
pub const DISKS: &[&str] = &["concentric", "polar", "rejection"];

/// A camera that traces one ray per call.
#[derive(Debug)]
pub struct Single {
    camera: Camera,
    mapping: DiskMapping,
}

/// Builds a camera as a host would, for a lens of the catalogue focused at infinity.
///
/// # Errors
/// The errors of [`Camera::build`].
pub fn camera(lens: &str, raster: Raster, given: Parameters) -> Result<Single, CameraError> {
    let parameters = Parameters {
        lens_file: Some(lens.to_owned()),
        film_diagonal: Some(FILM_DIAGONAL),
        focus_distance: Some(f64::INFINITY),
        ..given
    };
    let mapping = parameters.disk.unwrap_or_default();
    let camera = Camera::build(&parameters, &Host::new(raster, None), &mut |_, _| {})?;
    Ok(Single { camera, mapping })
}

/// A ray in lens space, mm, and its weight.
pub type Shot = ([f32; 3], [f32; 3], f32);

impl Single {
    /// Traces a sample. Returns `None` if the mapping rejects the sample, and a weight of 0 if the lens
    /// blocks it.
    pub fn shoot(&self, sample: &Sample) -> Option<Shot> {
        if let Some((ray, weight)) = self.camera.ray(sample) {
            return Some((ray.origin, ray.direction, weight));
        }
        // Only the mapping rejects samples.
        self.mapping.map(sample.lens_u.into(), sample.lens_v.into())?;
        Some(([0.0; 3], [0.0, 0.0, 1.0], 0.0))
    }
}

impl std::ops::Deref for Single {
    type Target = Camera;

    fn deref(&self) -> &Camera {
        &self.camera
    }
}
