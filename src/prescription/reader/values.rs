//! The values that the columns of a table hold, read the same way in every column format: a word in, a radius, an index
//! or a complaint that names its line and column out.

use super::lines::{Lines, Word};
use crate::prescription::LensFileError;

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
    if index == 0.0 || index == 1.0 {
        Ok(None)
    } else if index > 1.0 {
        Ok(Some(index))
    } else {
        Err(lines.error(word, "a refractive index is 1 or more; write 0 or 1 for air"))
    }
}

pub(super) fn is_stop_word(word: &Word) -> bool {
    word.text.eq_ignore_ascii_case("stop")
}
