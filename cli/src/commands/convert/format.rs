//! The formats in which a lens can be written.

use super::{code_v, optiland, sequence::Sequence, table, zemax};
use realistic_optics::prescription::{Prescription, read};
use std::path::Path;

/// A format, named by the ending of its files.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The project's own table
    Dat,
    /// Zemax text
    Zmx,
    /// CODE V's commands
    Seq,
    /// JSON of Optiland
    Json,
}

/// A lens in some format.
#[derive(Debug)]
pub struct Written {
    pub text: String,
    /// Sentences about everything that the format cannot state, and about additions for it.
    pub notes: Vec<String>,
}

impl Format {
    /// Every format with the ending of its files.
    const ENDINGS: [(Self, &str); 4] =
        [(Self::Dat, "dat"), (Self::Zmx, "zmx"), (Self::Seq, "seq"), (Self::Json, "json")];

    /// Returns the format of a file's name; `None` for another ending.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?;
        Self::ENDINGS.iter().find(|(_, own)| ending.eq_ignore_ascii_case(own)).map(|(format, _)| *format)
    }

    /// Returns the endings, for messages.
    pub fn endings() -> String {
        Self::ENDINGS.map(|(_, ending)| format!(".{ending}")).join(", ")
    }

    /// Writes a lens.
    ///
    /// # Errors
    /// The rays of the lens would be others in this format; the text gives the surface.
    pub fn write(self, lens: &Prescription) -> Result<Written, String> {
        type Writer = fn(&Sequence<'_>, &mut Vec<String>) -> Result<String, String>;
        let writer: Writer = match self {
            Self::Dat => return Ok(Written { text: table::write(lens), notes: Vec::new() }),
            Self::Zmx => |sequence, notes| Ok(zemax::write(sequence, notes)),
            Self::Seq => code_v::write,
            Self::Json => |sequence, notes| Ok(optiland::write(sequence, notes)),
        };
        if !lens.is_round() {
            return Err("tilted, decentred and cylindrical surfaces and mirrors are written as the project's own table (.dat) \
                        alone"
                .to_owned());
        }
        let as_read = lens.remarks.iter().map(|remark| format!("{AS_READ}{remark}"));
        let mut notes: Vec<String> = as_read.collect();
        let sequence = Sequence::of(lens, &mut notes);
        let text = writer(&sequence, &mut notes)?;
        // The user has the warnings of the lens itself already.
        notes.retain(|note| !note.starts_with(AS_READ));
        Ok(Written { text, notes })
    }

    /// Whether a line only states how the lens was read or what was left out.
    fn is_note(self, line: &str) -> bool {
        match self {
            Self::Dat => line.starts_with(table::REMARK),
            Self::Zmx => zemax::NOTES.iter().any(|start| line.starts_with(start)),
            Self::Seq => line.starts_with(code_v::NOTE),
            Self::Json => line.trim_start().starts_with("\"comment\": "),
        }
    }

    /// Whether a file holds exactly what this program writes for the lens in it.
    pub fn is_written_by_us(self, bytes: &[u8]) -> bool {
        let text = String::from_utf8_lossy(bytes);
        let Ok(lens) = read("old", bytes) else { return false };
        let Ok(again) = self.write(&lens) else { return false };
        // Notes depend on the file from which this one was converted.
        let counts = |line: &&str| !self.is_note(line);
        let [old, new]: [Vec<&str>; 2] =
            [&*text, &again.text].map(|text| text.lines().filter(counts).collect());
        old.len() == new.len() && old.iter().zip(&new).all(|(old, new)| is_same(old, new))
    }
}

/// Returns whether two lines have the same words, up to the rounding of numbers: some readers keep the curvature of a
/// surface, not its radius.
fn is_same(one: &str, other: &str) -> bool {
    let number = |word: &str| word.trim_end_matches(',').parse::<f64>();
    let is_close = |(one, other): (&str, &str)| {
        one == other
            || matches!((number(one), number(other)), (Ok(one), Ok(other))
                if (one - other).abs() <= 2.0 * f64::EPSILON * one.abs())
    };
    let [words, others] = [one, other].map(str::split_whitespace);
    words.clone().count() == others.clone().count() && words.zip(others).all(is_close)
}

/// The beginning of a note about a statement of the source that was interpreted differently.
const AS_READ: &str = "as it was read: ";

#[cfg(test)]
mod tests;
