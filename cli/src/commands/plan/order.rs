//! The cameras that `realistic plan` builds, from its arguments.

use crate::arguments::{CameraChoice, FilmSize, host, size_film};
use crate::failure::Failure;
use realistic_camera::{Camera, Host, Log, Parameters};

/// The options of `plan`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    camera: CameraChoice,
    #[command(flatten)]
    film: FilmSize,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
}

/// A camera to be built in several variants.
pub struct CameraOrder {
    pub parameters: Parameters,
    pub host: Host,
}

impl CameraOrder {
    /// Makes the order from the arguments of the command.
    ///
    /// # Errors
    /// A parameter is invalid.
    pub fn of(args: &Args) -> Result<Self, Failure> {
        let mut parameters = args.camera.with_a_lens()?;
        let host = host(&mut parameters, args.film.raster())?;
        size_film(&mut parameters, &host);
        Ok(Self { parameters, host })
    }

    /// Returns the requested tolerance, pixels.
    pub fn tolerance(&self) -> f64 {
        self.parameters.tolerance.unwrap_or(0.0)
    }

    /// Builds the camera.
    ///
    /// # Errors
    /// The camera cannot be built, or its model is not "lens": other models have nothing to plan.
    pub fn camera(&self, log: Log<'_>) -> Result<Camera, Failure> {
        self.parameters.require_lens()?;
        Ok(Camera::build(&self.parameters, &self.host, log)?)
    }
}
