//! The reader of lens files: text to lines of words ([`lines`]), lines to rows by the table's format, one file each
//! ([`four_column`], [`five_column`]), and rows of any format to checked interfaces ([`surface_row`]).
//!
//! Two formats are read. **Four columns**, as the assignment and pbrt have it: radius,
//! thickness, refractive index, clear diameter in every row. **Five columns**, as Smith's
//! *Modern Lens Design* prints it: radius, thickness, n_d, V-number, clear diameter for glass;
//! radius, thickness, diameter for air; thickness and diameter, or the word `stop` and the two,
//! for the stop; `-` stands for a value left out. A file is of the second kind if any row has five
//! values.
//!
//! A glass whose dispersion formula is known is defined on a line of its own and named in the index column
//! (see [`glasses`]).
//!
//! To add a format: a file here that makes a `SurfaceRow` of a line, its branch in [`read`], tests in `tests`, a
//! file among those that `tests/abi/fuzz_bodies.rs` mutates, and the formats' description in the README. A format that is no table of
//! columns branches off before `Lines::split`, which takes any text for words and numbers, and makes a [`Prescription`]
//! by itself, within the same limits.
//!
//! Values are separated by spaces, tabs or one comma; `#` begins a comment; the first row may be
//! one number, the focal length.
//!
//! A file has at most [`MAX_FILE_BYTES`] bytes, [`MAX_INTERFACES`] interfaces and as many lines that define a glass;
//! its name and the names of its glasses have at most [`MAX_NAME_BYTES`] bytes. What is larger is refused before anything
//! is computed from it: no real lens comes near, and a file from elsewhere must not keep its reader busy.

mod five_column;
mod four_column;
mod glasses;
mod lines;
mod surface_row;
mod values;

use super::{
    error::LensFileError,
    interfaces::Prescription,
    limits::{MAX_FILE_BYTES, MAX_INTERFACES, MAX_NAME_BYTES},
};
use crate::message::cut;
use glasses::Glasses;
use lines::{Line, Lines};

/// Reads a lens file's text.
///
/// `name` is the file as the caller knows it and begins every error message. UTF-8 with or
/// without a byte-order mark, UTF-16 with one; comments may be in any encoding.
///
/// # Errors
/// The first place at which the text is not a lens, with what was expected there; a text with more than
/// [`MAX_FILE_BYTES`] bytes, [`MAX_INTERFACES`] interfaces or glasses, or a name of more than [`MAX_NAME_BYTES`] bytes.
pub fn read(name: &str, bytes: &[u8]) -> Result<Prescription, LensFileError> {
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
    let mut lines = Lines::split(name, bytes)?;
    let glasses = Glasses::take(&mut lines)?;
    let (stated_focal_length, table) = leading_focal_length(&lines)?;
    let Some(last) = table.last() else {
        return Err(lines.error_at_end("the file has no rows; expected at least one interface"));
    };
    lines.at_most(table, &format!("a lens has at most {MAX_INTERFACES} interfaces"))?;
    let rows = if table.iter().any(|line| line.words.len() == 5) {
        table.iter().map(|line| five_column::row(&lines, &glasses, line, std::ptr::eq(line, last))).collect()
    } else {
        table.iter().map(|line| four_column::row(&lines, &glasses, line)).collect::<Result<Vec<_>, _>>()
    }?;
    let (mut interfaces, remarks) = surface_row::interfaces(&lines, table, rows)?;
    let back = std::mem::take(&mut interfaces.last_mut().expect("at least one row").thickness);
    Ok(Prescription {
        name: short_name,
        title: lines.title.clone(),
        interfaces,
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length,
        positions: None,
        remarks: remarks.iter().map(LensFileError::to_string).collect(),
    })
}

/// The focal length on a first line of its own, and the lines of the table.
fn leading_focal_length(lines: &Lines) -> Result<(Option<f64>, &[Line]), LensFileError> {
    match lines.lines.split_first() {
        Some((first, rest)) if first.words.len() == 1 => {
            let word = &first.words[0];
            let length = lines.number(word, "a focal length in mm on a line of its own")?;
            if length <= 0.0 {
                return Err(lines.error(word, "a focal length on a line of its own must be positive"));
            }
            Ok((Some(length), rest))
        }
        _ => Ok((None, &lines.lines)),
    }
}

fn short_name(name: &str) -> String {
    std::path::Path::new(name)
        .file_name()
        .map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests;
