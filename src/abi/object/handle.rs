//! The camera in an object ([`Handle`]), and the members that a pbrt-v1 host reads there ([`HostPart`]).

#[cfg(realistic_shim)]
use std::sync::atomic::{AtomicU64, Ordering};
use std::{ffi::c_void, mem::offset_of};

use crate::abi::{
    boundary::Failure,
    types::{realistic_ray, realistic_reason, realistic_sample},
};
use ::realistic_camera::{Camera, Host, Log, Outcome, Parameters, Sample, WorldRay};
use realistic_optics::trace::Blocked;

/// A built camera. Immutable.
#[derive(Debug)]
pub struct Handle {
    camera: Camera,
    #[cfg(realistic_shim)]
    serial: u64,
}

/// Serial number of the next camera. The address of a camera would not be unique, because a new camera may
/// lie where one was freed.
#[cfg(realistic_shim)]
static SERIAL: AtomicU64 = AtomicU64::new(1);

impl Handle {
    /// Builds a camera; a donor speeds this up.
    ///
    /// # Errors
    /// The message states which input is wrong and what to give instead.
    pub fn build(
        donor: Option<&Camera>,
        parameters: &Parameters,
        host: &Host,
        log: Log<'_>,
    ) -> Result<Self, Failure> {
        let camera = Camera::build_from(donor, parameters, host, log)?;
        Ok(Self {
            camera,
            #[cfg(realistic_shim)]
            serial: SERIAL.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// Returns the camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Returns the camera's serial number, which is not 0 and which no other camera of this process has or
    /// had.
    #[cfg(realistic_shim)]
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Returns the ABI's reason for a sample that a batch blocks; `wavelength`, nm, defaults to the camera's
    /// own.
    pub fn reason(&self, sample: &Sample, wavelength: Option<f32>) -> realistic_reason {
        match self.camera.generate(sample, wavelength) {
            // With a tolerance, single calls may use another tracer than batches. Near an edge, that tracer
            // may pass a ray that the batch blocks.
            Outcome::Ray(..) => realistic_reason::Clipped,
            Outcome::Blocked(reason) => reason.into(),
            Outcome::Redraw => realistic_reason::Redraw,
            Outcome::Shut => realistic_reason::Shut,
            Outcome::Wavelength => realistic_reason::Wavelength,
        }
    }
}

// The ABI's structures have the same layout as the camera's, so a pointer to one may be cast to a pointer to
// the other.
const _: () = {
    assert!(size_of::<realistic_sample>() == size_of::<Sample>());
    assert!(offset_of!(realistic_sample, image_y) == offset_of!(Sample, image_y));
    assert!(offset_of!(realistic_sample, lens_u) == offset_of!(Sample, lens_u));
    assert!(offset_of!(realistic_sample, lens_v) == offset_of!(Sample, lens_v));
    assert!(offset_of!(realistic_sample, time) == offset_of!(Sample, time));
    assert!(size_of::<realistic_ray>() == size_of::<WorldRay>());
    assert!(offset_of!(realistic_ray, d) == offset_of!(WorldRay, direction));
    assert!(offset_of!(realistic_ray, mint) == offset_of!(WorldRay, mint));
    assert!(offset_of!(realistic_ray, maxt) == offset_of!(WorldRay, maxt));
    assert!(offset_of!(realistic_ray, time) == offset_of!(WorldRay, time));
};

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

/// The members of a camera that a host reads; in a camera made from C, nobody reads them. They form the end
/// of `realistic_shim_parts`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct HostPart {
    /// The host's film, which the camera's destructor deletes; NULL if there is none.
    pub film: *mut c_void,
    /// Matrix from world to camera space, row-major, for column vectors.
    pub world_to_camera: [f32; 16],
    /// Inverse of `world_to_camera`: the matrix from camera to world space.
    pub camera_to_world: [f32; 16],
    /// Near clip distance, world units.
    pub hither: f32,
    /// Far clip distance, world units.
    pub yon: f32,
    /// Opening time of the shutter.
    pub shutter_open: f32,
    /// Closing time of the shutter.
    pub shutter_close: f32,
}

impl HostPart {
    /// Returns the members of a camera that a host reads; `film` and the two matrices come from the host.
    pub fn of(
        camera: &Camera,
        film: *mut c_void,
        world_to_camera: [f32; 16],
        camera_to_world: [f32; 16],
    ) -> Self {
        let [hither, yon] = camera.clip();
        let [shutter_open, shutter_close] = camera.shutter_interval();
        Self { film, world_to_camera, camera_to_world, hither, yon, shutter_open, shutter_close }
    }
}
