//! A camera in the terms of the ABI.

#[cfg(realistic_shim)]
use std::sync::atomic::{AtomicU64, Ordering};

use super::boundary::{Failure, realistic_status};
#[cfg(realistic_shim)]
use super::triples;
use super::types::{realistic_ray, realistic_reason, realistic_sample};
use crate::camera::{Camera, CameraError, Host, Level, Outcome, Parameters, Sample, WorldRay};
use crate::imaging::focus::FocusError;
use crate::trace::Blocked;

/// A built camera. Immutable.
#[derive(Debug)]
pub struct Handle {
    camera: Camera,
    #[cfg(realistic_shim)]
    serial: u64,
}

/// The next camera's number. An address would not do: a new camera may lie where one was freed.
#[cfg(realistic_shim)]
static SERIAL: AtomicU64 = AtomicU64::new(1);

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
        let camera = Camera::build(parameters, host, log)?;
        Ok(Self {
            camera,
            #[cfg(realistic_shim)]
            serial: SERIAL.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// A number that no other camera of this process has or had; not 0.
    #[cfg(realistic_shim)]
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// A ray for a host's vtable: a blocked one has the smallest normal weight and is
    /// complete all the same, because a pbrt-v1 host reads an uninitialised alpha for weight 0.
    #[cfg(realistic_shim)]
    pub fn generate_for_host(&self, sample: &realistic_sample, ray: &mut realistic_ray) -> f32 {
        let sample = fresh(sample);
        let weight = triples::ray(self, &sample, ray);
        if weight > 0.0 {
            return weight;
        }
        *ray = self.camera.substitute(&{ sample }).into();
        f32::MIN_POSITIVE
    }

    /// Writes a ray and returns its exact weight; 0, and nothing written, where there is none.
    #[inline(always)]
    pub fn ray(&self, sample: &realistic_sample, ray: &mut realistic_ray) -> f32 {
        put(self.camera.ray(&fresh(sample)), ray)
    }

    /// What becomes of a sample, in the ABI's words.
    pub fn reason(&self, sample: &Sample) -> realistic_reason {
        match self.camera.generate(sample) {
            Outcome::Ray(..) => realistic_reason::Ok,
            Outcome::Blocked(reason) => reason.into(),
            Outcome::Redraw => realistic_reason::Redraw,
            Outcome::Shut => realistic_reason::Shut,
        }
    }
}

/// Writes a ray, if there is one, and returns its weight; else 0.
#[inline(always)]
pub(super) fn put(found: Option<(WorldRay, f32)>, to: &mut realistic_ray) -> f32 {
    let Some((ray, weight)) = found else { return 0.0 };
    *to = ray.into();
    weight
}

/// A sample that its caller has just written, number by number: each is read by itself (volatile, or the compiler makes
/// one load of four), because a wide load would wait until all of them have left the store buffer, and so
/// for everything before them: the call before.
#[inline(always)]
fn fresh(sample: &realistic_sample) -> Sample {
    let realistic_sample { image_x, image_y, lens_u, lens_v, time } = sample;
    // SAFETY: references to numbers that there are.
    let [image_x, image_y, lens_u, lens_v, time] = unsafe {
        [
            (&raw const *image_x).read_volatile(),
            (&raw const *image_y).read_volatile(),
            (&raw const *lens_u).read_volatile(),
            (&raw const *lens_v).read_volatile(),
            (&raw const *time).read_volatile(),
        ]
    };
    Sample { image_x, image_y, lens_u, lens_v, time }
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
            | CameraError::NoFilmDistance(_)
            | CameraError::FilmInLens { .. }
            | CameraError::PupilAtInfinity
            | CameraError::DarkAxis { .. }
            | CameraError::Weight { .. }
            | CameraError::Transform(_)
            | CameraError::Raster { .. } => realistic_status::InvalidParameter,
        };
        Self::new(status, error.to_string())
    }
}
