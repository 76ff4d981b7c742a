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
//! Values are separated by spaces, tabs or one comma; `#` begins a comment; the first row may be
//! one number, the focal length.

mod five_column;
mod four_column;
mod glasses;
mod lines;
mod surface_row;
mod values;

use super::{error::LensFileError, interfaces::Prescription};
use glasses::Glasses;
use lines::{Line, Lines};

/// Reads a lens file's text.
///
/// `name` is the file as the caller knows it and begins every error message. UTF-8 with or
/// without a byte-order mark, UTF-16 with one; comments may be in any encoding.
///
/// # Errors
/// The first place at which the text is not a lens, with what was expected there.
pub fn read(name: &str, bytes: &[u8]) -> Result<Prescription, LensFileError> {
    let mut lines = Lines::split(name, bytes)?;
    let glasses = Glasses::take(&mut lines)?;
    let (stated_focal_length, table) = leading_focal_length(&lines)?;
    let Some(last) = table.last() else {
        return Err(lines.error_at_end("the file has no rows; expected at least one interface"));
    };
    let rows = if table.iter().any(|line| line.words.len() == 5) {
        table.iter().map(|line| five_column::row(&lines, &glasses, line, std::ptr::eq(line, last))).collect()
    } else {
        table.iter().map(|line| four_column::row(&lines, &glasses, line)).collect::<Result<Vec<_>, _>>()
    }?;
    let mut interfaces = surface_row::interfaces(&lines, table, rows)?;
    let back = std::mem::take(&mut interfaces.last_mut().expect("at least one row").thickness);
    Ok(Prescription {
        name: short_name(name),
        title: lines.title.clone(),
        interfaces,
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length,
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
