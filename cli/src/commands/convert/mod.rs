//! `realistic convert`: writes a lens file of any supported format, or a lens of the catalogue, as the project's own
//! table.

mod table;

use crate::arguments::LensChoice;
use crate::console;
use crate::failure::Failure;
use crate::files::{is_stdout, save};
use realistic_optics::prescription::{MAX_FILE_BYTES, read};
use std::path::{Path, PathBuf};

/// The options of `convert`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    lens: LensChoice,
    /// Table to write, .dat; - for standard output
    #[arg(value_name = "OUT", value_parser = table_path)]
    word: Option<PathBuf>,
    /// The same as OUT
    #[arg(short, long, value_name = "FILE", value_parser = table_path)]
    out: Option<PathBuf>,
    /// Write over a file that was not made by `convert`, such as a table written by hand
    #[arg(long)]
    force: bool,
}

fn table_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_table = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("dat"));
    if is_table || is_stdout(&path) {
        return Ok(path);
    }
    Err("the project's own table is written, and no other format; give a name that ends in .dat, or - for standard output"
        .to_owned())
}

/// Writes the table and reports its path.
///
/// # Errors
/// There is no such lens, the contents of an existing file would be lost, or the file cannot be written.
pub fn run(args: &Args) -> Result<(), Failure> {
    let (lens, out) = lens_and_out(args)?;
    let opened = lens.open_as_it_is()?;
    let text = table::write(&opened.prescription);
    if let Some(input) = &opened.parameters().lens_file
        && is_same_file(Path::new(input), &out)
    {
        return Err(Failure::Usage(format!("{} is the lens itself; give OUT another name", out.display())));
    }
    if !args.force && has_other_work(&out) {
        return Err(Failure::Other(format!(
            "{} is there and was not written by `convert`: its comments and layout would be lost; give another name, or \
             --force to write over it",
            out.display()
        )));
    }
    save(&out, text.as_bytes()).map_err(|error| Failure::cannot_write(&out, &error))?;
    Ok(console::report(&format!("{}\n", out.display()), &out)?)
}

/// Parses the arguments: if a flag gives the lens, the only positional word is OUT.
fn lens_and_out(args: &Args) -> Result<(LensChoice, PathBuf), Failure> {
    let mut lens = args.lens.clone();
    let is_alone = args.word.is_none() && args.out.is_none();
    let word = if is_alone { lens.word_beside_a_flag() } else { None };
    let word = word.map(|word| table_path(&word)).transpose().map_err(Failure::Usage)?;
    match (args.word.clone().or(word), args.out.clone()) {
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
fn has_other_work(out: &Path) -> bool {
    let found = out.metadata().ok().filter(std::fs::Metadata::is_file);
    let is_ours = || crate::files::read(out, MAX_FILE_BYTES).is_ok_and(|old| is_written_by_us(&old));
    !is_stdout(out) && found.is_some_and(|found| found.len() > MAX_FILE_BYTES || !is_ours())
}

/// Whether a file holds exactly what this program writes for the lens in it.
fn is_written_by_us(bytes: &[u8]) -> bool {
    let Ok(lens) = read("old.dat", bytes) else { return false };
    // Remarks depend on the file from which the table was converted.
    let of_another = |line: &&str| !line.starts_with(table::REMARK);
    let text = String::from_utf8_lossy(bytes);
    text.lines().filter(of_another).eq(table::write(&lens).lines())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_written_by_hand_are_distinguished_from_converted_ones() {
        for name in realistic_optics::prescription::catalogue::names() {
            let mut lens = realistic_optics::prescription::catalogue::find(name).unwrap();
            lens.remarks = vec!["something was taken in another way".to_owned()];
            let text = table::write(&lens);
            assert!(is_written_by_us(text.as_bytes()), "{name}");
            assert!(!is_written_by_us(format!("{text}# a note\n").as_bytes()), "{name}");
        }
        assert!(!is_written_by_us(b"20  5   1.5  10\n-20 40 1 10\n") && !is_written_by_us(b"no lens"));
    }
}
