//! `realistic blender`: a lens as a camera for Blender's Cycles.

use crate::arguments::{LensChoice, STOP_SHAPE, TRANSMISSION};
use crate::console;
use crate::failure::Failure;
use crate::files::{is_stdout, save};
use crate::osl::{OslCamera, ShaderRequest, Station, StationRequest, stations};
use realistic_base::message::fixed;
use realistic_camera::FocusBy;
use realistic_optics::prescription::Positions;
use std::path::PathBuf;

/// The options of `blender`.
#[derive(clap::Args, Debug)]
#[command(after_help = FILM)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Shader to write, .osl; - for standard output [default: the lens's name with .osl]
    #[arg(short, long, value_name = "FILE", value_parser = shader_path)]
    out: Option<PathBuf>,
    /// Give each sample its own wavelength: dispersion in colour
    #[arg(long)]
    dispersion: bool,
}

/// Diagonal of the largest sensor if none is given, mm.
const LARGEST: f64 = 52.0;
const FILM: &str = "Here --film-diagonal is that of the largest sensor, shifts included, 52 mm unless given: film points beyond its \
                    corners stay black. Without --zoom the shader has a zoom lens's whole range, and a parameter for it. Groups \
                    focus where the lens file says how; with --focus-by film the whole lens moves. --transmission bare, \
                    quarter-wave, v-coat, three-layer or file: what surfaces reflect and glasses absorb is lost.";

fn shader_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_shader = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("osl"));
    if is_shader || is_stdout(&path) {
        Ok(path)
    } else {
        Err("must end in .osl, or be - for standard output".to_owned())
    }
}

/// The groups of parameters that the command uses.
pub const GROUPS: &[&[&str]] = &[STOP_SHAPE, TRANSMISSION];

/// Writes the shader and reports its path.
///
/// # Errors
/// There is no such lens, it cannot become a camera of Blender, or the file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let opened = args.lens.open_with(GROUPS)?;
    let prescription = &opened.prescription;
    let parameters = opened.parameters();
    let layout = prescription.positions.as_ref().map(Positions::layout);
    let could_focus = layout.is_some_and(|layout| layout.steps > 1);
    // Groups focus if the lens file describes their movement for focusing.
    let by_groups = parameters.focus_by.map_or(could_focus, |by| by == FocusBy::Group);
    let station_request =
        StationRequest { lens: &opened.lens, stop: opened.stop(), zoom: parameters.zoom.as_ref(), by_groups };
    let (stations, start) = stations(prescription, station_request).unwrap_or_else(|error| {
        console::warn(&format!("{error}; the shader has the lens as its file begins"));
        (vec![Station::fixed(&opened.lens, 0.0)], 0)
    });
    let coatings = opened.coatings()?;
    let request = ShaderRequest {
        prescription,
        stations: &stations,
        start,
        reach: parameters.film_diagonal.unwrap_or(LARGEST) / 2.0,
        spectral: args.dispersion,
        coatings: coatings.as_deref(),
        could_zoom: layout.is_some_and(|layout| layout.zooms > 1),
        could_focus_by_groups: could_focus,
    };
    let camera = OslCamera::of(&request)?;
    let out = args.out.clone().unwrap_or_else(|| {
        let name = prescription.name.rsplit('/').next().unwrap_or_default();
        PathBuf::from(format!("{name}.osl"))
    });
    save(&out, camera.text.as_bytes()).map_err(|error| Failure::cannot_write(&out, &error))?;
    let [shortest, longest] = camera.focal_lengths.map(|length| fixed(length, 2));
    let focal_length = if shortest == longest { shortest } else { format!("{shortest} to {longest}") };
    let text = format!(
        "{}: f/{} {} mm, focus from {} mm in front of the lens, film to {} mm from the axis\n",
        out.display(),
        fixed(camera.fnumber, 2),
        focal_length,
        fixed(camera.nearest, 0),
        fixed(camera.reach, 2)
    );
    Ok(console::report(&text, &out)?)
}
