//! The reader of lens files: the front, which tells the format by the text, and a file or room for each format: the
//! project's own [`table`], [`optical_bench`] text, [`zemax`] and [`flaresim`] files, and [`agf`] catalogues of glass. Every
//! format makes rows, and [`surfaces`] makes checked interfaces of them; files of other programs are [`foreign`].
//!
//! To add a format: a file here that makes a [`Prescription`] of a text, within the limits, with a `SurfaceRow` per
//! surface; how it is known, in [`Format::of`]; malformed files among its tests, a right one among those that
//! `tests/abi/fuzz_bodies.rs` mutates, and its description in `docs/lens-format.md` and `docs/lenses.md`.
//!
//! A file has at most [`MAX_FILE_BYTES`] bytes, `MAX_INTERFACES` interfaces and as many lines that define a glass;
//! its name and the names of its glasses have at most [`MAX_NAME_BYTES`] bytes. What is larger is refused before anything
//! is computed from it: no real lens comes near, and a file from elsewhere must not keep its reader busy.

pub(super) mod agf;
#[cfg(test)]
mod asked;
mod flaresim;
mod foreign;
mod named_glass;
mod optical_bench;
mod surfaces;
mod table;
mod text;
mod zemax;

use super::{
    error::LensFileError,
    glass::GlassLibrary,
    interfaces::Prescription,
    limits::{MAX_FILE_BYTES, MAX_NAME_BYTES},
};
use crate::message::cut;

/// Reads a lens file's text, whatever its format; a glass's name is looked up among the built-in ones.
///
/// # Errors
/// As [`read_with`].
pub fn read(name: &str, bytes: &[u8]) -> Result<Prescription, LensFileError> {
    read_with(name, bytes, &GlassLibrary::default())
}

/// Reads a lens file's text, whatever its format; a glass's name is looked up in `library`.
///
/// `name` is the file as the caller knows it and begins every error message. UTF-8 with or
/// without a byte-order mark, UTF-16 with one; comments may be in any encoding.
///
/// # Errors
/// The first place at which the text is not a lens, with what was expected there; a text with more than
/// [`MAX_FILE_BYTES`] bytes, more interfaces or glasses than a lens may have, or a name of more than [`MAX_NAME_BYTES`]
/// bytes.
pub fn read_with(name: &str, bytes: &[u8], library: &GlassLibrary) -> Result<Prescription, LensFileError> {
    let short_name = short_name(name);
    if short_name.len() > MAX_NAME_BYTES {
        let message =
            format!("the lens's name has {} bytes; a name has at most {MAX_NAME_BYTES}", short_name.len());
        return Err(LensFileError { file: cut(&short_name), line: 1, column: 1, message });
    }
    if let Some(within) = bytes.get(..MAX_FILE_BYTES as usize).filter(|within| within.len() < bytes.len()) {
        let line_start = within.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        return Err(LensFileError {
            file: name.to_owned(),
            line: within.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: within.len() - line_start + 1,
            message: format!("the file goes on here; a lens file has at most {MAX_FILE_BYTES} bytes (1 MiB)"),
        });
    }
    let bytes = text::decoded(bytes);
    let not_a_lens = |message: String| LensFileError { file: name.to_owned(), line: 1, column: 1, message };
    let prescription = match Format::of(&bytes) {
        Format::Table => table::read(name, &bytes, library),
        Format::OpticalBench => optical_bench::read(name, &bytes, library),
        Format::Zemax => zemax::read(name, &bytes, library),
        Format::FlareSim => flaresim::read(name, &bytes),
        Format::GlassCatalogue => {
            let message = "a catalogue of glasses (AGF), not a lens; give it as \"glasscatalog\"";
            Err(not_a_lens(message.to_owned()))
        }
        Format::Foreign(message) => Err(not_a_lens(message)),
    }?;
    let mut prescription = Prescription { name: short_name, ..prescription };
    prescription.remarks.extend_from_slice(library.told());
    Ok(prescription)
}

/// What a lens file may be written in.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Format {
    Table,
    OpticalBench,
    Zemax,
    FlareSim,
    /// No lens at all.
    GlassCatalogue,
    /// A file of another program, and what to say of it.
    Foreign(String),
}

impl Format {
    /// The format of a text: by a line that only it has.
    fn of(bytes: &[u8]) -> Self {
        let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
        let begins = |line: &[u8], word: &str, then: fn(&u8) -> bool| {
            line.strip_prefix(word.as_bytes()).is_some_and(|rest| rest.first().is_some_and(then))
        };
        let known = |line: &[u8]| {
            if line.trim_ascii().to_ascii_lowercase().starts_with(b"[lens data]") {
                Some(Self::OpticalBench)
            } else if begins(line, "SURF ", u8::is_ascii_digit) {
                Some(Self::Zemax)
            } else if begins(line, "NM ", |_| true) {
                Some(Self::GlassCatalogue)
            } else if line.trim_ascii() == b"surfaces:" {
                Some(Self::FlareSim)
            } else {
                None
            }
        };
        let unknown = || foreign::recognised(bytes).map_or(Self::Table, Self::Foreign);
        lines.into_iter().find_map(known).unwrap_or_else(unknown)
    }
}

fn short_name(name: &str) -> String {
    std::path::Path::new(name)
        .file_name()
        .map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}
