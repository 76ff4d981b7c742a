//! `realistic convert`: writes a lens file of any supported format, or a lens of the catalogue, as the project's own
//! table or in the format of a designers' program.
//!
//! `table` writes the project's own table, which states everything. The other writers (`zemax`, `code_v`, `optiland`)
//! state a `sequence`, with the media of `glasses`, and note what their formats have no words for.

mod code_v;
mod format;
mod glasses;
mod numbers;
mod optiland;
mod sequence;
mod table;
mod zemax;

use crate::arguments::LensChoice;
use crate::console;
use crate::failure::Failure;
use crate::files::{is_stdout, save};
use format::Format;
use realistic_optics::prescription::MAX_FILE_BYTES;
use std::path::{Path, PathBuf};

/// The options of `convert`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// File to write, whose ending is its format: .dat, .zmx, .seq or .json; - for standard output
    ///
    /// .dat is the project's own table, .zmx Zemax text, .seq CODE V's commands and .json JSON of Optiland. What the format
    /// cannot state is listed as warnings and, where the format has comments, in the file.
    #[arg(value_name = "OUT")]
    word: Option<PathBuf>,
    /// The same as OUT
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Format of standard output, or of a file with another ending; default dat
    #[arg(long = "as", value_name = "FORMAT")]
    format: Option<Format>,
    /// Write over a file that was not made by `convert`, such as a table written by hand
    #[arg(long)]
    force: bool,
}

/// Returns the format of the output: that of its ending, or of `--as`.
fn format(given: Option<Format>, out: &Path) -> Result<Format, Failure> {
    let of_ending = Format::of(out);
    match (given, of_ending) {
        (Some(given), Some(own)) if given != own => Err(Failure::Usage(format!(
            "{} has the ending of another format than --as; give it another name or leave --as out",
            out.display()
        ))),
        (Some(format), _) | (None, Some(format)) => Ok(format),
        (None, None) if is_stdout(out) => Ok(Format::Dat),
        (None, None) => Err(Failure::Usage(format!(
            "the ending of OUT is its format: give a name that ends in {}, or - for standard output, with --as for the format",
            Format::endings()
        ))),
    }
}

/// Writes the lens and reports the path of the file.
///
/// # Errors
/// There is no such lens, the contents of an existing file would be lost, or the file cannot be written. A lens whose
/// rays would be others in the format is an error, too.
pub fn run(args: &Args) -> Result<(), Failure> {
    let (lens, out) = lens_and_out(args)?;
    let format = format(args.format, &out)?;
    let opened = lens.open_as_it_is()?;
    let written = format.write(&opened.prescription).map_err(Failure::Other)?;
    if let Some(input) = &opened.parameters().lens_file
        && is_same_file(Path::new(input), &out)
    {
        return Err(Failure::Usage(format!("{} is the lens itself; give OUT another name", out.display())));
    }
    if !args.force && has_other_work(format, &out) {
        return Err(Failure::Other(format!(
            "{} is there and was not written by `convert`: its comments and layout would be lost; give another name, or \
             --force to write over it",
            out.display()
        )));
    }
    for note in &written.notes {
        console::warn(note);
    }
    save(&out, written.text.as_bytes()).map_err(|error| Failure::cannot_write(&out, &error))?;
    Ok(console::report(&format!("{}\n", out.display()), &out)?)
}

/// Parses the arguments: if a flag gives the lens, the only positional word is OUT.
fn lens_and_out(args: &Args) -> Result<(LensChoice, PathBuf), Failure> {
    let mut lens = args.lens.clone();
    let is_alone = args.word.is_none() && args.out.is_none();
    let word = if is_alone { lens.word_beside_a_flag() } else { None };
    match (args.word.clone().or(word.map(PathBuf::from)), args.out.clone()) {
        (Some(out), None) | (None, Some(out)) => Ok((lens, out)),
        (Some(_), Some(_)) => {
            Err(Failure::Usage("OUT and --out say the same thing; give one of them".to_owned()))
        }
        (None, None) => Err(Failure::Usage(
            "where to? Write `realistic convert IN OUT.dat`, OUT - for standard output".to_owned(),
        )),
    }
}

fn is_same_file(one: &Path, other: &Path) -> bool {
    one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}

/// Whether the file exists and holds anything but this program's output.
fn has_other_work(format: Format, out: &Path) -> bool {
    let found = out.metadata().ok().filter(std::fs::Metadata::is_file);
    let is_ours = || crate::files::read(out, MAX_FILE_BYTES).is_ok_and(|old| format.is_written_by_us(&old));
    !is_stdout(out) && found.is_some_and(|found| found.len() > MAX_FILE_BYTES || !is_ours())
}
