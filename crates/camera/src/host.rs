//! The host of a camera: its data besides the parameters.

use std::path::PathBuf;

use super::{
    film::Raster,
    placement::{motion::CameraMotion, transform::CameraToWorld},
};
use realistic_optics::prescription::SearchPath;

pub use realistic_base::message::{Level, Log};

/// Data of a host besides parameters.
#[derive(Clone, Debug)]
pub struct Host {
    /// Pixels of the image.
    pub raster: Raster,
    /// Transform from camera space to world space, at any time.
    pub to_world: CameraMotion,
    /// Directories that are searched for lens files after the working directory.
    pub search: SearchPath,
    /// Text of a lens file instead of `lens_file`, with its name in messages.
    pub lens_text: Option<(String, Vec<u8>)>,
    /// Whether the host can give a sample another (u, v).
    pub can_redraw: bool,
    /// Whether a tolerance may choose another model of the lens, and a motion in a closed shutter becomes one
    /// transform; false for comparisons. Without a tolerance the rays have the same bits.
    pub leave_out: bool,
}

impl Host {
    /// Returns a host whose camera space is its world space, and which searches for lens files along `PBRT_SEARCHPATH`
    /// and in the directory `beside`.
    pub fn new(raster: Raster, beside: Option<PathBuf>) -> Self {
        Self {
            raster,
            to_world: CameraToWorld::IDENTITY.into(),
            search: SearchPath::from_environment().then(beside.as_deref()),
            lens_text: None,
            can_redraw: true,
            leave_out: true,
        }
    }
}
