//! `realistic lens`: the first-order report of a lens, and the fate of every statement of its file.

mod facts;
mod file;
mod list;
mod positions;
mod table;

use crate::arguments::LensChoice;
use crate::console;
use crate::drawing::{catalogue, output};
use crate::failure::Failure;
use facts::Facts;
use std::io::Write as _;
use std::path::PathBuf;

/// The options of `lens`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// List the lenses of the catalogue; with =FILE.svg or =FILE.png draw them on one page
    ///
    /// The list has the focal length as computed, the f-number as the lens file states it (in parentheses the computed one,
    /// where it states none), the field of view, the interfaces and the year.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true,
          value_parser = output::path)]
    list: Option<Option<PathBuf>>,
    /// Print the fate of every statement of the lens file with its place, and nothing else
    ///
    /// A row is a statement: used as stated, replaced (by what), left out (why), or informative, without effect on the
    /// lens. Places are line numbers, in an archive behind the name of the member.
    #[arg(long, conflicts_with_all = ["json", "list"])]
    report: bool,
    /// Write JSON; keys carry units, null means absent or at infinity
    #[arg(long)]
    json: bool,
}

/// Prints the report.
///
/// # Errors
/// There is no such lens, or it cannot be set up as requested.
pub fn run(args: &Args) -> Result<(), Failure> {
    if args.list.is_some() || !args.lens.is_given() {
        return list(args);
    }
    let opened = args.lens.open()?;
    if args.report {
        let report = file::report(&opened.prescription.findings);
        return Ok(std::io::stdout().write_all(report.as_bytes())?);
    }
    // The report of a lens that makes no image omits the film distance.
    let film_distance = opened.film_distance_if_any()?;
    let diagonal = opened.film_diagonal();
    let (prescription, lens) = (&opened.prescription, &opened.lens);
    let facts = Facts::of(prescription, lens, film_distance, diagonal);
    let positions = positions::all(prescription, lens.wavelength, opened.stop(), diagonal);
    let text = if args.json {
        let mut value = facts.json();
        value["rows"] = table::json(prescription, lens);
        value["positions"] = positions::json(&positions);
        value["file"] = file::json(&prescription.findings);
        format!("{value:#}\n")
    } else {
        let table = table::text(prescription, lens);
        facts.text() + &positions::text(&positions) + "\n" + &table + &file::text(&prescription.findings)
    };
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// Lists the catalogue: in words, as JSON, or as a drawing.
fn list(args: &Args) -> Result<(), Failure> {
    if args.lens.is_given() {
        return Err(Failure::Usage("--list shows every lens; leave out the lens and its options".to_owned()));
    }
    match &args.list {
        Some(Some(_)) if args.json => {
            Err(Failure::Usage("--list=FILE draws, and --json writes JSON; give one of them".to_owned()))
        }
        Some(Some(out)) => {
            output::write(&catalogue::draw(&list::drawn()), out)?;
            Ok(console::report(&format!("{}\n", out.display()), out)?)
        }
        _ if args.json => Ok(writeln!(std::io::stdout(), "{:#}", list::json())?),
        _ => Ok(std::io::stdout().write_all(list::text().as_bytes())?),
    }
}
