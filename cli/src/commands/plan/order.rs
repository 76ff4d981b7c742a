//! What `realistic plan` is asked for: arguments in, cameras out.

use crate::arguments::{CameraChoice, FilmSize, host, size_film};
use crate::failure::Failure;
use realistic::unstable::camera::{Camera, Host, Log, Model, ParameterError, Parameters};

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
    /// It cannot be built, or is of another model than "lens", of which there is nothing to plan.
    pub fn camera(&self, log: Log<'_>) -> Result<Camera, Failure> {
        if let Some(model) = self.parameters.model.filter(|model| *model != Model::Lens) {
            let (value, range) = (format!("\"{model}\""), "\"lens\"".to_owned());
            return Err(ParameterError::Range { name: "model", value, range }.into());
        }
        Ok(Camera::build(&self.parameters, &self.host, log)?)
    }
}
