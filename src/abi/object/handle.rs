//! The camera in an object ([`Handle`]), and what a pbrt-v1 host keeps there besides its rays ([`HostPart`]).

#[cfg(realistic_shim)]
use std::sync::atomic::{AtomicU64, Ordering};
use std::{ffi::c_void, mem::offset_of};

use crate::{
    abi::{
        boundary::Failure,
        types::{realistic_ray, realistic_reason, realistic_sample},
    },
    camera::{Camera, Host, Log, Outcome, Parameters, Sample, WorldRay},
    trace::Blocked,
};

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
    /// Builds a camera, from a donor if there is one.
    ///
    /// # Errors
    /// What is wrong, and what to give instead.
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

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// A number that no other camera of this process has or had; not 0.
    #[cfg(realistic_shim)]
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Why a sample that a batch blocks has no ray, at a wavelength, nm, or the camera's own, in the ABI's words.
    pub fn reason(&self, sample: &Sample, wavelength: Option<f32>) -> realistic_reason {
        match self.camera.generate(sample, wavelength) {
            // Another tracer, which a tolerance allows single calls, lets it through: it is that near an edge.
            Outcome::Ray(..) => realistic_reason::Clipped,
            Outcome::Blocked(reason) => reason.into(),
            Outcome::Redraw => realistic_reason::Redraw,
            Outcome::Shut => realistic_reason::Shut,
            Outcome::Wavelength => realistic_reason::Wavelength,
        }
    }
}

// The ABI's structures are the camera's by layout: a pointer to one may be cast to the other.
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

/// A host's members of a camera; nobody reads them in a C-made camera. The end of `realistic_shim_parts`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct HostPart {
    /// The host's film, which the camera deletes in the end; NULL for none.
    pub film: *mut c_void,
    /// Row-major, for column vectors.
    pub world_to_camera: [f32; 16],
    /// Its inverse.
    pub camera_to_world: [f32; 16],
    /// World units.
    pub hither: f32,
    /// World units.
    pub yon: f32,
    /// When the shutter opens.
    pub shutter_open: f32,
    /// When the shutter closes.
    pub shutter_close: f32,
}

impl HostPart {
    /// What a host keeps of a camera; `film` and the two matrices are its own.
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
