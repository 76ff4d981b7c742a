//! `realistic blender`: a lens as a camera for Blender's Cycles.

use crate::failure::Failure;
use crate::files::save;
use crate::lens_and_film::{FilmPlace, LensChoice, positive};
use crate::osl::{Camera, Request};
use realistic::message::fixed;
use std::io::Write as _;
use std::path::PathBuf;

/// What `blender` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    #[command(flatten)]
    place: FilmPlace,
    /// Shader to write; - for standard output [default: the lens's name with .osl]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Diagonal in mm of the largest sensor, shifts included: film points beyond its corners stay black
    #[arg(long = "filmdiag", value_name = "MM", default_value_t = 52.0, value_parser = positive)]
    diagonal: f64,
    /// A wavelength of its own for each sample: dispersion in colour
    #[arg(long)]
    dispersion: bool,
}

/// Writes the shader and says where to.
///
/// # Errors
/// No such lens, one that cannot be a camera of Blender's, or a file that cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let (prescription, lens) = args.lens.open(&args.place)?;
    let request = Request {
        prescription: &prescription,
        lens: &lens,
        reach: args.diagonal / 2.0,
        spectral: args.dispersion,
    };
    let camera = Camera::of(&request)?;
    let mut stdout = std::io::stdout();
    if args.out.as_ref().is_some_and(|out| out.as_os_str() == "-") {
        return Ok(stdout.write_all(camera.text.as_bytes())?);
    }
    let out = args.out.clone().unwrap_or_else(|| {
        let name = prescription.name.rsplit('/').next().unwrap_or_default();
        PathBuf::from(format!("{name}.osl"))
    });
    save(&out, camera.text.as_bytes()).map_err(|error| Failure::cannot_write(&out, &error))?;
    Ok(writeln!(
        stdout,
        "{}: f/{} {} mm, focus from {} mm in front of the lens, film to {} mm from the axis",
        out.display(),
        fixed(camera.fnumber, 2),
        fixed(camera.focal_length, 2),
        fixed(camera.nearest, 0),
        fixed(camera.reach, 2)
    )?)
}
