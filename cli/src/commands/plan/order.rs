//! What `realistic plan` is asked for: arguments in, cameras out.

use crate::arguments::{CameraChoice, FilmSize, host, size_film};
use crate::failure::Failure;
use realistic::unstable::camera::{Host, Log, Parameters, RealisticCamera};

/// What `plan` can be told.
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

/// A camera to be built, in several ways.
pub struct Order {
    pub parameters: Parameters,
    pub host: Host,
}

impl Order {
    /// What the arguments ask for.
    ///
    /// # Errors
    /// A parameter is refused.
    pub fn of(args: &Args) -> Result<Self, Failure> {
        let mut parameters = args.camera.with_a_lens()?;
        let host = host(&mut parameters, args.film.raster())?;
        size_film(&mut parameters, &host);
        Ok(Self { parameters, host })
    }

    /// The tolerance asked for, pixels.
    pub fn tolerance(&self) -> f64 {
        self.parameters.tolerance.unwrap_or(0.0)
    }

    /// The camera.
    ///
    /// # Errors
    /// It cannot be built.
    pub fn camera(&self, log: Log<'_>) -> Result<RealisticCamera, Failure> {
        Ok(RealisticCamera::build(&self.parameters, &self.host, log)?)
    }
}
