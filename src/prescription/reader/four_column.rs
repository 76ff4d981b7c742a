//! A line of the assignment's and pbrt's table: radius, thickness, refractive index, clear diameter (mm). A line in, a
//! row out; what its neighbours have to say is checked later.

use super::{
    glasses::Glasses,
    lines::{Line, Lines},
    surface_row::SurfaceRow,
    values::{index, is_stop_word, radius},
};
use crate::prescription::{LensFileError, interfaces::Medium};

const COLUMNS: &str = "a row has four values: radius, thickness, refractive index, clear diameter";

/// Reads one row.
///
/// # Errors
/// The first word that cannot stand where it does.
pub(super) fn row(lines: &Lines, glasses: &Glasses, line: &Line) -> Result<SurfaceRow, LensFileError> {
    let [first, thickness, medium, diameter] = line.words.as_slice() else {
        return Err(lines.error(
            &line.words[0],
            &format!("{} value(s); {COLUMNS}, or five in a table with V-numbers", line.words.len()),
        ));
    };
    let says_stop = is_stop_word(first);
    Ok(SurfaceRow {
        radius: if says_stop { f64::INFINITY } else { radius(lines, first)? },
        says_stop,
        thickness: lines.number(thickness, "a thickness in mm")?,
        medium: match glasses.find(lines, medium)? {
            Some(glass) => glass,
            None => index(lines, medium)?.map_or(Medium::Air, |n_d| Medium::Glass { n_d, abbe: None }),
        },
        diameter: lines.number(diameter, "a clear diameter in mm")?,
    })
}
