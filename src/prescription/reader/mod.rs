//! The reader of lens files: text to rows of words ([`rows`]), rows to interfaces by the
//! table's format ([`four_column`], [`smith`]), and the checks that hold for either ([`check`]).
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
//!
//! A file has at most [`MAX_FILE_BYTES`] bytes, [`MAX_INTERFACES`] interfaces and as many lines that define a glass;
//! its name and the names of its glasses have at most [`MAX_NAME_BYTES`] bytes. What is larger is refused before anything
//! is computed from it: no real lens comes near, and a file from elsewhere must not keep its reader busy.

mod check;
mod four_column;
mod glasses;
mod rows;
mod smith;

use super::{
    Interface, LensFileError, MAX_FILE_BYTES, MAX_INTERFACES, MAX_NAME_BYTES, Medium, Prescription, Shape,
};
use glasses::Glasses;
use rows::{Row, Rows, Word};

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
        return Err(LensFileError { file: beginning(&short_name), line: 1, column: 1, message });
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
    let mut rows = Rows::split(name, bytes)?;
    let glasses = Glasses::take(&mut rows)?;
    let (stated_focal_length, table) = leading_focal_length(&rows)?;
    let Some(last) = table.last() else {
        return Err(rows.error_at_end("the file has no rows; expected at least one interface"));
    };
    at_most(&rows, table, &format!("a lens has at most {MAX_INTERFACES} interfaces"))?;
    let raw = if table.iter().any(|row| row.words.len() == 5) {
        table.iter().map(|row| smith::interface(&rows, &glasses, row, std::ptr::eq(row, last))).collect()
    } else {
        table.iter().map(|row| four_column::interface(&rows, &glasses, row)).collect::<Result<Vec<_>, _>>()
    }?;
    let mut interfaces = check::check(&rows, table, raw)?;
    let back = std::mem::take(&mut interfaces.last_mut().expect("at least one row").thickness);
    Ok(Prescription {
        name: short_name,
        title: rows.title.clone(),
        interfaces,
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length,
    })
}

/// A row's values before it is known what lies on the interface's scene side.
#[derive(Clone, Copy, Debug)]
struct RawInterface {
    /// Signed radius in mm; infinite for a plane.
    radius: f64,
    /// The row says in words that it is the stop.
    says_stop: bool,
    thickness: f64,
    medium: Medium,
    diameter: f64,
}

fn leading_focal_length(rows: &Rows) -> Result<(Option<f64>, &[Row]), LensFileError> {
    match rows.rows.split_first() {
        Some((first, rest)) if first.words.len() == 1 => {
            let word = &first.words[0];
            let length = rows.number(word, "a focal length in mm on a line of its own")?;
            if length <= 0.0 {
                return Err(rows.error(word, "a focal length on a line of its own must be positive"));
            }
            Ok((Some(length), rest))
        }
        _ => Ok((None, &rows.rows)),
    }
}

/// The radius column, the same in both formats: a number, 0 and `inf` being planes.
fn radius(rows: &Rows, word: &Word) -> Result<f64, LensFileError> {
    let unsigned = word.text.trim_start_matches(['+', '-']);
    if unsigned.eq_ignore_ascii_case("inf") || unsigned.eq_ignore_ascii_case("infinity") {
        return Ok(f64::INFINITY);
    }
    let radius = rows.number(word, "a radius of curvature in mm (0 or inf for a plane)")?;
    Ok(if radius == 0.0 { f64::INFINITY } else { radius })
}

/// The index column: 0 and 1 are air.
fn index(rows: &Rows, word: &Word) -> Result<Option<f64>, LensFileError> {
    let index = rows.number(word, "a refractive index (0 or 1 for air)")?;
    if index == 0.0 || index == 1.0 {
        Ok(None)
    } else if index > 1.0 {
        Ok(Some(index))
    } else {
        Err(rows.error(word, "a refractive index is 1 or more; write 0 or 1 for air"))
    }
}

fn is_stop_word(word: &Word) -> bool {
    word.text.eq_ignore_ascii_case("stop")
}

/// That there are at most [`MAX_INTERFACES`] rows of one kind.
fn at_most(rows: &Rows, some: &[Row], limit: &str) -> Result<(), LensFileError> {
    match some.get(MAX_INTERFACES) {
        None => Ok(()),
        Some(beyond) => {
            let message = format!("row {} of {}; {limit}", MAX_INTERFACES + 1, some.len());
            Err(rows.error(&beyond.words[0], &message))
        }
    }
}

/// The beginning of a name that is too long to be shown whole.
pub(super) fn beginning(name: &str) -> String {
    name.chars().take(32).chain("...".chars()).collect()
}

fn short_name(name: &str) -> String {
    std::path::Path::new(name)
        .file_name()
        .map_or_else(|| name.to_owned(), |file| file.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests;
