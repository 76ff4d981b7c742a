//! What a pbrt-v1 host keeps in its cameras besides their rays.

use std::ffi::c_void;

use crate::camera::Camera;

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
