//! `realistic draw`: the cross-section of a lens.

use crate::drawing::{picture, section};
use crate::failure::Failure;
use crate::lens_and_film::{FilmPlace, FilmSize, LensChoice};
use realistic::lens::{Lens, first_order::FirstOrder};
use std::io::Write as _;
use std::path::PathBuf;

/// What `draw` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    #[command(flatten)]
    place: FilmPlace,
    #[command(flatten)]
    film: FilmSize,
    /// Rays per bundle, spread over the beam that gets through and a little beyond
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = clap::value_parser!(u32).range(1..=999))]
    rays: u32,
    /// Drawing to write, .svg or .png [default: the lens's name with .svg]
    #[arg(long, value_name = "FILE", value_parser = picture::path)]
    out: Option<PathBuf>,
}

/// Draws the lens and says where to.
///
/// # Errors
/// No such lens, or a file that cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let (prescription, lens) = args.lens.open()?;
    let film_distance = args.place.film_distance_if_any(&lens)?.unwrap_or_else(|| stand_in(&lens));
    let [edge_sagitta, _] = lens.rear().sagitta_range();
    if film_distance + edge_sagitta <= 0.0 {
        return Err(FilmPlace::in_lens(&lens, film_distance));
    }
    let scene = section::Scene {
        title: prescription.title.as_deref(),
        film_distance,
        film_diagonal: args.film.diagonal,
        rays: args.rays,
    };
    let out = args.out.clone().unwrap_or_else(|| {
        let name = prescription.name.rsplit('/').next().unwrap_or_default();
        PathBuf::from(format!("{name}.svg"))
    });
    picture::write(&section::draw(&lens, &scene), &out)?;
    Ok(writeln!(std::io::stdout(), "{}", out.display())?)
}

/// A lens that makes no image still lets light through to film somewhere behind it.
fn stand_in(lens: &Lens) -> f64 {
    let rear = lens.rear();
    let room = -2.0 * rear.sagitta_range()[0];
    let size = FirstOrder::of(lens).map_or(2.0 * rear.semi_diameter, |optics| optics.focal_length.abs());
    size.min(4.0 * rear.semi_diameter).max(room)
}
