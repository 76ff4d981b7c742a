//! The data that a host supplies besides the parameters.

use std::path::PathBuf;

use super::{
    film::Raster,
    placement::{motion::CameraMotion, transform::CameraToWorld},
};
use realistic_optics::prescription::SearchPath;

pub use realistic_base::message::{Level, Log};

/// The data that a host supplies besides the parameters.
#[derive(Clone, Debug)]
pub struct Host {
    /// Width and height of the image, pixels.
    pub raster: Raster,
    /// Transform from camera space to world space, at any time.
    pub to_world: CameraMotion,
    /// Directories that are searched for lens files after the working directory.
    pub search: SearchPath,
    /// Text of a lens and the name that messages use for it; it replaces the file of `lens_file`.
    pub lens_text: Option<(String, Vec<u8>)>,
    /// Whether the host can draw another lens sample (u, v).
    pub can_redraw: bool,
    /// Whether simplifications are allowed: a tolerance may select an approximate model of the lens, and a
    /// motion during which the shutter is closed may become a single transform. It is false in comparisons.
    /// Without a tolerance the rays have the same bits either way.
    pub leave_out: bool,
}

impl Host {
    /// Returns a host whose camera space is its world space and whose lens files are searched for along
    /// `PBRT_SEARCHPATH`, in the directory `beside` and in the collections of `REALISTIC_LENSES`.
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
