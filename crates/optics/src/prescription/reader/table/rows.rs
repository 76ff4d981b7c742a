//! Rows of a table: each line becomes a row, or an error with its line and column. Four columns are those of the
//! assignment and of pbrt: radius, thickness, refractive index and clear diameter (mm). Five columns are those of W. J.
//! Smith, *Modern Lens Design* (McGraw-Hill, 1992): radius, thickness, n_d, V-number and clear diameter.

use super::{glasses::Glasses, lines::Lines};
use crate::prescription::{
    LensFileError,
    interfaces::Medium,
    reader::{
        surface_rows::{self, MediumBehind, Role, SurfaceRow},
        text::Cell,
    },
};

const FOUR_COLUMNS: &str = "a row has four values: radius, thickness, refractive index, clear diameter";
const FIVE_COLUMNS: &str = "a five-column table has rows of five values (glass: radius, thickness, n_d, V-number, \
     clear diameter), three (air: radius, thickness, diameter) or two (the stop: thickness, diameter)";

/// Reads a row of four columns. The checks of the row against its neighbours follow later.
///
/// # Errors
/// A word is invalid in its column. The error is about the first such word.
pub(super) fn of_four(
    lines: &Lines<'_>,
    glasses: &Glasses<'_>,
    line: &[Cell<'_>],
) -> Result<SurfaceRow, LensFileError> {
    let [first, thickness, medium, diameter] = line else {
        return Err(lines.error(
            &line[0],
            &format!("{} value(s); {FOUR_COLUMNS}, or five in a table with V-numbers", line.len()),
        ));
    };
    let role = role(first);
    Ok(SurfaceRow {
        radius: if role == Role::Any { radius(lines, first)? } else { f64::INFINITY },
        role,
        thickness: lines.number(thickness, "a thickness in mm")?,
        behind: match glasses.find(lines, medium)? {
            Some(glass) => glass,
            None => index(lines, medium)?.map_or(Medium::Air, |n_d| Medium::Glass { n_d, abbe: None }).into(),
        },
        diameter: lines.number(diameter, "a clear diameter in mm")?,
        asphere: None,
        apertures: Vec::new(),
        general: Default::default(),
    })
}

/// Reads a row of five columns; rows of air and of the stop lack some of the values.
///
/// # Errors
/// A word is invalid in its column. The error is about the first such word.
pub(super) fn of_five(
    lines: &Lines<'_>,
    glasses: &Glasses<'_>,
    line: &[Cell<'_>],
    is_last: bool,
) -> Result<SurfaceRow, LensFileError> {
    let (stated_role, words) = match line.split_first() {
        Some((first, rest)) if role(first) != Role::Any => (role(first), rest),
        _ if line.len() == 2 => (Role::Stop, line),
        _ => (Role::Any, line),
    };
    let has_role = stated_role != Role::Any;
    let (curvature, thickness, glass, diameter) = match words {
        [radius, thickness, n_d, abbe, diameter] => (Some(radius), thickness, Some((n_d, abbe)), diameter),
        [thickness, n_d, abbe, diameter] if has_role => (None, thickness, Some((n_d, abbe)), diameter),
        [radius, thickness, diameter] if !has_role => (Some(radius), thickness, None, diameter),
        [thickness, diameter] => (None, thickness, None, diameter),
        [_, _, _, _] => {
            return Err(lines.error(
                &line[0],
                &format!("four values can be read in two ways; {FIVE_COLUMNS}: write - for a value left out"),
            ));
        }
        _ => {
            return Err(lines.error(&line[0], &format!("{} value(s); {FIVE_COLUMNS}", line.len())));
        }
    };
    let behind = match glass {
        Some((n_d, abbe)) => behind(lines, glasses, n_d, abbe)?,
        None => Medium::Air.into(),
    };
    let (radius, role) = match curvature {
        Some(word) if !left_out(word) => (radius(lines, word)?, stated_role),
        _ if stated_role == Role::Any => (f64::INFINITY, Role::Stop),
        _ => (f64::INFINITY, stated_role),
    };
    let thickness = match thickness {
        word if left_out(word) && is_last => 0.0,
        word => lines.number(word, "a thickness in mm")?,
    };
    let diameter = lines.number(diameter, "a clear diameter in mm")?;
    Ok(SurfaceRow {
        radius,
        role,
        thickness,
        behind,
        diameter,
        asphere: None,
        apertures: Vec::new(),
        general: Default::default(),
    })
}

/// Reads a medium from the words for its index or name and for its V-number.
///
/// # Errors
/// A word is invalid.
pub(super) fn behind(
    lines: &Lines<'_>,
    glasses: &Glasses<'_>,
    n_d: &Cell<'_>,
    abbe: &Cell<'_>,
) -> Result<MediumBehind, LensFileError> {
    if !left_out(n_d)
        && let Some(glass) = glasses.find(lines, n_d)?
    {
        return if left_out(abbe) {
            Ok(glass)
        } else {
            Err(lines.error(abbe, "the glass's formula says what a V-number would; write - for the V-number"))
        };
    }
    let index = if left_out(n_d) { None } else { index(lines, n_d)? };
    match (index, left_out(abbe)) {
        (None, true) => Ok(Medium::Air.into()),
        (None, false) => Err(lines.error(abbe, "a V-number without a refractive index; write - for air")),
        (Some(n_d), true) => Ok(Medium::Glass { n_d, abbe: None }.into()),
        (Some(n_d), false) => {
            let number = lines.number(abbe, "a V-number")?;
            if number > 0.0 {
                Ok(Medium::Glass { n_d, abbe: Some(number) }.into())
            } else {
                Err(lines.error(abbe, "a V-number is positive; write - if it is not known"))
            }
        }
    }
}

fn left_out(word: &Cell<'_>) -> bool {
    word.text == "-"
}

/// Reads the radius column, which is the same in both kinds of table: a number, where 0 and `inf` mean a plane.
fn radius(lines: &Lines<'_>, word: &Cell<'_>) -> Result<f64, LensFileError> {
    if word.is_infinite() {
        return Ok(f64::INFINITY);
    }
    let radius = lines.number(word, "a radius of curvature in mm (0 or inf for a plane)")?;
    Ok(if radius == 0.0 { f64::INFINITY } else { radius })
}

/// Reads the index column, where 0 and 1 mean air.
fn index(lines: &Lines<'_>, word: &Cell<'_>) -> Result<Option<f64>, LensFileError> {
    let index = lines.number(word, "a refractive index (0 or 1 for air)")?;
    surface_rows::index(index).map_err(|why| lines.error(word, &format!("{why}; write 0 or 1 for air")))
}

/// Returns the role that a word in the radius column states, if the word is not a radius.
fn role(word: &Cell<'_>) -> Role {
    if word.is("stop") {
        Role::Stop
    } else if word.is("flare") {
        Role::FlareStop
    } else {
        Role::Any
    }
}
