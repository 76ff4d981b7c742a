//! What `realistic plan` is asked for: arguments in, cameras out.

use crate::failure::Failure;
use crate::lens_and_film::{FilmChoice, FilmPlace, LensChoice, not_negative, set_parameters};
use realistic::camera::{CameraError, Host, Log, Parameters, Raster, RealisticCamera};

/// What `plan` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    #[command(flatten)]
    place: FilmPlace,
    #[command(flatten)]
    film: FilmChoice,
    /// Pixels that 99.9 % of the rays may be off, for a faster model of the lens [default: 0, exact rays]
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = not_negative)]
    tolerance: Option<f64>,
    /// Another camera parameter, as `render --help` lists them; may be given again
    #[arg(long = "param", value_name = "NAME=VALUE")]
    parameters: Vec<String>,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
}

/// A camera to be built in several ways.
pub struct Order {
    parameters: Parameters,
    pub host: Host,
}

impl Order {
    /// What the arguments ask for.
    ///
    /// # Errors
    /// A parameter is refused.
    pub fn of(args: &Args) -> Result<Self, Failure> {
        let mut parameters = Parameters::default();
        let [xres, yres] = args.film.size;
        let mut host = Host::new(Raster { xres, yres }, None);
        args.lens.give(&mut parameters, &mut host)?;
        args.place.give(&mut parameters);
        args.film.give(&mut parameters);
        parameters.tolerance = args.tolerance;
        set_parameters(&mut parameters, &args.parameters)?;
        Ok(Self { parameters, host })
    }

    /// The tolerance asked for, pixels.
    pub fn tolerance(&self) -> f64 {
        self.parameters.tolerance.unwrap_or(0.0)
    }

    /// The camera, with or without leaving out.
    ///
    /// # Errors
    /// It cannot be built.
    pub fn camera(&self, leave_out: bool, tolerance: f64, log: Log<'_>) -> Result<RealisticCamera, Failure> {
        let parameters = Parameters { tolerance: Some(tolerance), ..self.parameters.clone() };
        let host = Host { leave_out, ..self.host.clone() };
        RealisticCamera::build(&parameters, &host, log).map_err(|error| match error {
            CameraError::Parameter(error) => error.into(),
            other => Failure::Other(other.to_string()),
        })
    }
}
