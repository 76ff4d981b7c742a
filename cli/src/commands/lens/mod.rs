//! `realistic lens`: the first-order report of a lens.

mod facts;
mod list;
mod positions;
mod table;

use crate::failure::Failure;
use crate::lens_and_film::{FilmPlace, FilmSize, LensChoice};
use facts::Facts;
use std::io::Write as _;

/// What `lens` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: Option<LensChoice>,
    /// List the lenses of the catalogue: focal length, f-number, field of view, interfaces, year
    #[arg(long, exclusive = true)]
    list: bool,
    #[command(flatten)]
    place: FilmPlace,
    #[command(flatten)]
    film: FilmSize,
    /// Write JSON; keys carry units, null is what does not exist or lies at infinity
    #[arg(long)]
    json: bool,
}

/// Prints the report.
///
/// # Errors
/// No such lens, or one that cannot be set up as asked.
pub fn run(args: &Args) -> Result<(), Failure> {
    let Some(choice) = args.lens.as_ref().filter(|_| !args.list) else {
        return Ok(std::io::stdout().write_all(list::text().as_bytes())?);
    };
    let (prescription, lens) = choice.open(&args.place)?;
    // A lens that makes no image is worth a report without one.
    let film_distance = args.place.film_distance_if_any(&lens)?;
    let facts = Facts::of(&prescription, &lens, film_distance, args.film.diagonal);
    let positions = positions::all(&prescription, lens.wavelength, choice.stop(), args.film.diagonal);
    let text = if args.json {
        let mut value = facts.json();
        value["rows"] = table::json(&prescription, &lens);
        value["positions"] = positions::json(&positions);
        format!("{value:#}\n")
    } else {
        facts.text() + &positions::text(&positions) + "\n" + &table::text(&prescription, &lens)
    };
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}
