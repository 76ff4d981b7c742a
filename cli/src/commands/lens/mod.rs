//! `realistic lens`: the first-order report of a lens.

mod facts;
mod list;
mod positions;
mod table;

use crate::drawing::{catalogue, picture};
use crate::failure::Failure;
use crate::lens_and_film::{FilmPlace, FilmSize, LensChoice};
use facts::Facts;
use std::io::Write as _;
use std::path::PathBuf;

/// What `lens` can be told.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: Option<LensChoice>,
    /// List the lenses of the catalogue: focal length, f-number, field of view, interfaces, year; with =FILE.svg or
    /// =FILE.png draw them on one page
    #[arg(long, exclusive = true, value_name = "FILE", num_args = 0..=1, require_equals = true,
          value_parser = picture::path)]
    list: Option<Option<PathBuf>>,
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
    let choice = match (&args.list, &args.lens) {
        (None, Some(choice)) => choice,
        (Some(Some(out)), _) => {
            picture::write(&catalogue::draw(&list::drawn()), out)?;
            return Ok(writeln!(std::io::stdout(), "{}", out.display())?);
        }
        (Some(None), _) | (None, None) => return Ok(std::io::stdout().write_all(list::text().as_bytes())?),
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
