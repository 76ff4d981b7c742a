//! Focusing on an object in the scene, and metering, with the camera's rays only: like a photographer who looks
//! through the lens.

use crate::host::plugin::{Camera, Plugin, PluginError, Warn};
use crate::host::scene::{LEVEL, Scene};
use realistic::ffi::{realistic_ray, realistic_sample};
use realistic_camera::{Model, Parameters};
use realistic_lab::render::Rays;
use std::sync::Arc;

/// Largest distance, mm, by which a lens is moved back: a kilometre.
const FARTHEST: f32 = 1e6;

/// Builds the camera, from a donor if there is one, and focuses it on the scene's subject unless the parameters give
/// a focus. A lens that cannot focus so near is moved back by doubling the distance until it can. Also returns the
/// displacement, mm.
///
/// # Errors
/// The plugin reports an error.
pub fn build(
    plugin: &Arc<Plugin>,
    donor: Option<&Camera>,
    parameters: &Parameters,
    size: [u32; 2],
    scene: &Scene,
    warn: Warn<'_>,
) -> Result<(Camera, f32), PluginError> {
    let mut parameters = parameters.clone();
    if parameters.model == Some(Model::Orthographic) && parameters.screen_window.is_none() {
        parameters.screen_window = Some(window(&parameters, size, scene));
    }
    if parameters.focus_distance.is_some() || parameters.film_distance.is_some() {
        return Ok((Camera::new(plugin, donor, &parameters, size, &scene.pose, warn)?, 0.0));
    }
    // Rays of ghosts do not meet at the image.
    let trial = Parameters { ghosts: None, ..parameters.clone() };
    let unfocused = Camera::new(plugin, None, &trial, size, &LEVEL, &|_| ())?;
    let info = unfocused.info()?;
    let subject = (scene.subject)(info.focal_length_mm, info.film_diagonal);
    let mut back = 0.0;
    let (focus, last) = loop {
        match focus_distance(plugin, &unfocused, &trial, size, f64::from(subject + back)) {
            Err(PluginError::Unreachable(_)) if back < FARTHEST => back = 2.0 * (subject + back) - subject,
            Err(PluginError::Unreachable(error)) => {
                return Err(PluginError::Unreachable(format!(
                    "focusing on the scene's subject: {error} (give --focus-distance or --film-distance to focus elsewhere)"
                )));
            }
            found => break found?,
        }
    };
    parameters.focus_distance = focus;
    let donor = last.as_ref().unwrap_or(&unfocused);
    let pose = scene.moved_back(back).pose;
    Ok((Camera::new(plugin, Some(donor), &parameters, size, &pose, warn)?, back))
}

/// Returns the focus distance, in world units, that focuses a subject at this distance in front of the lens, mm;
/// `None` for a camera without focus. Also returns the last camera tried. A focus distance is measured from the film,
/// which moves with the focus and lies behind a lens of unknown length. The function therefore finds the point where
/// the rays of a focused camera meet, and corrects the focus distance by the difference.
fn focus_distance(
    plugin: &Arc<Plugin>,
    unfocused: &Camera,
    parameters: &Parameters,
    size: [u32; 2],
    subject: f64,
) -> Result<(Option<f64>, Option<Camera>), PluginError> {
    const LENS_LENGTH_GUESS: f64 = 100.0;
    const CORRECTIONS: u32 = 3;
    let mm = parameters.mm_per_unit.unwrap_or(1.0);
    let mut trial = parameters.clone();
    let mut last: Option<Camera> = None;
    let mut distance = subject + LENS_LENGTH_GUESS;
    for _ in 0..CORRECTIONS {
        trial.focus_distance = Some(distance / mm);
        let donor = last.as_ref().unwrap_or(unfocused);
        let camera = Camera::new(plugin, Some(donor), &trial, size, &LEVEL, &|_| ())?;
        let meeting = AxialRays::of(|rays| camera.rays(rays), size)?.meeting();
        last = Some(camera);
        let Some(meeting) = meeting else { return Ok((None, last)) };
        distance += subject - meeting * mm;
    }
    Ok((Some(distance / mm), last))
}

/// Returns the screen window, in world units, for which an orthographic camera sees as much as a 40 mm lens sees at
/// the scene's subject.
fn window(parameters: &Parameters, [width, height]: [u32; 2], scene: &Scene) -> [f64; 4] {
    /// Half of the shorter side of 24 x 36 mm, divided by the focal length.
    const TANGENT: f64 = 12.0 / 40.0;
    let subject = f64::from((scene.subject)(40.0, 43.3));
    let half = TANGENT * subject / parameters.mm_per_unit.unwrap_or(1.0);
    let aspect = parameters.frame_aspect_ratio.unwrap_or(f64::from(width) / f64::from(height));
    let [x, y] = if aspect > 1.0 { [aspect * half, half] } else { [half, half / aspect] };
    [-x, x, -y, y]
}

/// Rays from the middle of the film through the whole lens.
pub struct AxialRays {
    rays: Vec<realistic_ray>,
    weights: Vec<f32>,
}

impl AxialRays {
    /// Requests the rays of the camera.
    ///
    /// # Errors
    /// The plugin's error.
    pub fn of(
        camera: impl FnOnce(Rays<'_>) -> Result<(), PluginError>,
        size: [u32; 2],
    ) -> Result<Self, PluginError> {
        const SIDE: u8 = 64;
        let steps = || (0..SIDE).map(|step| (f32::from(step) + 0.5) / f32::from(SIDE));
        let [image_x, image_y] = size.map(|side| side as f32 / 2.0);
        let samples: Vec<_> = steps()
            .flat_map(|lens_u| steps().map(move |lens_v| (lens_u, lens_v)))
            .map(|(lens_u, lens_v)| realistic_sample { image_x, image_y, lens_u, lens_v, time: 0.5 })
            .collect();
        let mut rays = vec![realistic_ray::default(); samples.len()];
        let mut weights = vec![0.0; samples.len()];
        camera(Rays { samples: &samples, rays: &mut rays, weights: &mut weights })?;
        Ok(Self { rays, weights })
    }

    /// Returns the mean weight, which is the film's irradiance for a scene of radiance 1.
    pub fn mean_weight(&self) -> f32 {
        self.weights.iter().sum::<f32>() / self.weights.len() as f32
    }

    /// Returns the z, in world units, at which the rays' spot as seen from the lens is smallest; `None` if all rays
    /// start at one point. The fit is linear in 1/z, so it stays accurate for distant points.
    fn meeting(&self) -> Option<f64> {
        let (mut size, mut turn) = (0.0, 0.0);
        for (ray, weight) in self.rays.iter().zip(&self.weights) {
            let [x, y, z] = ray.o.map(f64::from);
            let [dx, dy, dz] = ray.d.map(f64::from);
            let weight = f64::from(*weight);
            if weight > 0.0 && dz > 0.0 {
                let slope = [dx / dz, dy / dz];
                let foot = [x - slope[0] * z, y - slope[1] * z];
                size += weight * (foot[0] * foot[0] + foot[1] * foot[1]);
                turn -= weight * (slope[0] * foot[0] + slope[1] * foot[1]);
            }
        }
        (size > 0.0).then(|| size / turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lens of radius 10 at z = 0 that sends every ray to (0, 0, 500).
    fn perfect(rays: Rays<'_>) -> Result<(), PluginError> {
        rays.fill(|sample, ray| {
            let [x, y] = [sample.lens_u, sample.lens_v].map(|u| 20.0 * u - 10.0);
            let length = (x * x + y * y + 250_000.0).sqrt();
            ray.o = [x, y, 0.0];
            ray.d = [-x / length, -y / length, 500.0 / length];
            if sample.lens_u < 0.5 { 0.0 } else { 2.0 }
        });
        Ok(())
    }

    #[test]
    fn rays_meet_where_the_lens_sends_them() {
        let rays = AxialRays::of(perfect, [30, 20]).unwrap();
        assert!((rays.meeting().unwrap() - 500.0).abs() < 1e-3);
        assert_eq!(rays.mean_weight(), 1.0);
    }
}
