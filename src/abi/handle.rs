//! A camera in the terms of the ABI.

use super::boundary::{Failure, realistic_status};
use super::types::{realistic_ray, realistic_reason, realistic_sample};
use crate::camera::{Camera, CameraError, Host, Level, Outcome, Parameters, Sample, WorldRay};
use crate::optics::focus::FocusError;
use crate::trace::Blocked;

/// A built camera. Immutable.
#[derive(Debug)]
pub struct Handle(Camera);

impl Handle {
    /// Builds a camera.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
    pub fn build(
        parameters: &Parameters,
        host: &Host,
        log: &mut dyn FnMut(Level, &str),
    ) -> Result<Self, Failure> {
        Ok(Self(Camera::build(parameters, host, log)?))
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.0
    }

    /// A ray for a host's vtable: a blocked one has the smallest normal weight and is
    /// complete all the same, because a pbrt-v1 host reads an uninitialised alpha for weight 0.
    pub fn generate_for_host(&self, sample: &realistic_sample, ray: &mut realistic_ray) -> f32 {
        let sample = Sample::from(*sample);
        let (complete, weight) = match self.0.generate(&sample) {
            Outcome::Ray(complete, weight) => (complete, weight),
            Outcome::Blocked(_) | Outcome::Redraw | Outcome::Shut => {
                (self.0.substitute(&sample), f32::MIN_POSITIVE)
            }
        };
        *ray = complete.into();
        weight
    }

    /// A ray with its exact weight and reason; `None` for the ray and weight 0 when there is none.
    pub fn generate(&self, sample: &realistic_sample) -> (Option<realistic_ray>, f32, realistic_reason) {
        match self.0.generate(&Sample::from(*sample)) {
            Outcome::Ray(ray, weight) => (Some(ray.into()), weight, realistic_reason::Ok),
            Outcome::Blocked(reason) => (None, 0.0, reason.into()),
            Outcome::Redraw => (None, 0.0, realistic_reason::Redraw),
            Outcome::Shut => (None, 0.0, realistic_reason::Shut),
        }
    }
}

impl From<realistic_sample> for Sample {
    fn from(sample: realistic_sample) -> Self {
        let realistic_sample { image_x, image_y, lens_u, lens_v, time } = sample;
        Self { image_x, image_y, lens_u, lens_v, time }
    }
}

impl From<WorldRay> for realistic_ray {
    fn from(ray: WorldRay) -> Self {
        let WorldRay { origin, direction, mint, maxt, time } = ray;
        Self { o: origin, d: direction, mint, maxt, time }
    }
}

impl From<Blocked> for realistic_reason {
    fn from(reason: Blocked) -> Self {
        match reason {
            Blocked::Missed => Self::Missed,
            Blocked::Clipped => Self::Clipped,
            Blocked::Reflected => Self::Reflected,
            Blocked::TurnedBack => Self::TurnedBack,
        }
    }
}

impl From<CameraError> for Failure {
    fn from(error: CameraError) -> Self {
        let status = match &error {
            CameraError::Source(_) => realistic_status::LensFile,
            CameraError::Focus(FocusError::TooNear { .. }) => realistic_status::UnreachableFocus,
            CameraError::Parameter(_)
            | CameraError::Lens(_)
            | CameraError::Focus(_)
            | CameraError::FilmInLens { .. }
            | CameraError::PupilAtInfinity
            | CameraError::DarkAxis { .. }
            | CameraError::Transform(_)
            | CameraError::Raster { .. } => realistic_status::InvalidParameter,
        };
        Self::new(status, error.to_string())
    }
}
