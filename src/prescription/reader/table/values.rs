//! The values that the columns of a table hold, read the same way whether it has four or five: a word in, a radius, an index
//! or a complaint that names its line and column out.

use super::lines::{Lines, Word};
use crate::prescription::{
    LensFileError,
    reader::surfaces::{self, Role},
};

/// The radius column, the same in both formats: a number, 0 and `inf` being planes.
pub(super) fn radius(lines: &Lines, word: &Word) -> Result<f64, LensFileError> {
    let unsigned = word.text.trim_start_matches(['+', '-']);
    if unsigned.eq_ignore_ascii_case("inf") || unsigned.eq_ignore_ascii_case("infinity") {
        return Ok(f64::INFINITY);
    }
    let radius = lines.number(word, "a radius of curvature in mm (0 or inf for a plane)")?;
    Ok(if radius == 0.0 { f64::INFINITY } else { radius })
}

/// The index column: 0 and 1 are air.
pub(super) fn index(lines: &Lines, word: &Word) -> Result<Option<f64>, LensFileError> {
    let index = lines.number(word, "a refractive index (0 or 1 for air)")?;
    surfaces::index(index).map_err(|why| lines.error(word, &format!("{why}; write 0 or 1 for air")))
}

/// What the word in the radius column says the row to be, where it is no radius.
pub(super) fn role(word: &Word) -> Role {
    if word.is("stop") {
        Role::Stop
    } else if word.is("flare") {
        Role::FlareStop
    } else {
        Role::Any
    }
}
