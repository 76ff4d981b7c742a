//! What a host brings to a camera besides its parameters.

use std::path::PathBuf;

use super::{
    film::Raster,
    placement::{motion::CameraMotion, transform::CameraToWorld},
};
use crate::prescription::SearchPath;

pub use crate::message::{Level, Log};

/// What a host brings besides parameters.
#[derive(Clone, Debug)]
pub struct Host {
    /// Pixels of the image.
    pub raster: Raster,
    /// Camera space to world space, at any time.
    pub to_world: CameraMotion,
    /// Where lens files are looked for after the working directory.
    pub search: SearchPath,
    /// A lens file's text in the place of `specfile`, with the name it goes by in messages.
    pub lens_text: Option<(String, Vec<u8>)>,
    /// Whether the host can give a sample another (u, v).
    pub can_redraw: bool,
    /// Whether a tolerance may choose another model of the lens, and a motion in a closed shutter becomes one transform; false
    /// is for comparisons. Without a tolerance the rays have the same bits.
    pub leave_out: bool,
}

impl Host {
    /// A host whose camera space is its world space, and which looks for lens files along
    /// `PBRT_SEARCHPATH` and in the directory `beside`.
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
