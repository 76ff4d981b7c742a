//! A line of the assignment's and pbrt's table: radius, thickness, refractive index, clear diameter (mm). A line in, a
//! row out; what its neighbours have to say is checked later.

use super::{
    glasses::Glasses,
    lines::{Line, Lines},
    values::{index, radius, role},
};
use crate::prescription::{
    LensFileError,
    interfaces::Medium,
    reader::surfaces::{Role, SurfaceRow},
};

const COLUMNS: &str = "a row has four values: radius, thickness, refractive index, clear diameter";

/// Reads one row.
///
/// # Errors
/// The first word that cannot stand where it does.
pub(super) fn row(lines: &Lines, glasses: &Glasses<'_>, line: &Line) -> Result<SurfaceRow, LensFileError> {
    let [first, thickness, medium, diameter] = line.words.as_slice() else {
        return Err(lines.error(
            &line.words[0],
            &format!("{} value(s); {COLUMNS}, or five in a table with V-numbers", line.words.len()),
        ));
    };
    let role = role(first);
    Ok(SurfaceRow {
        radius: if role == Role::Any { radius(lines, first)? } else { f64::INFINITY },
        role,
        thickness: lines.number(thickness, "a thickness in mm")?,
        medium: match glasses.find(lines, medium)? {
            Some(glass) => glass,
            None => index(lines, medium)?.map_or(Medium::Air, |n_d| Medium::Glass { n_d, abbe: None }),
        },
        diameter: lines.number(diameter, "a clear diameter in mm")?,
        asphere: None,
    })
}
