//! A row of the assignment's and pbrt's table: radius, thickness, index, clear diameter.

use super::{Glasses, Medium, RawInterface, Row, Rows, index, is_stop_word, radius};
use crate::prescription::LensFileError;

const COLUMNS: &str = "a row has four values: radius, thickness, refractive index, clear diameter";

pub(super) fn interface(rows: &Rows, glasses: &Glasses, row: &Row) -> Result<RawInterface, LensFileError> {
    let [first, thickness, medium, diameter] = row.words.as_slice() else {
        let hint = if row.words.len() > 5 { " (a decimal comma? write 1.5, not 1,5)" } else { "" };
        return Err(rows.error(
            &row.words[0],
            &format!("{} value(s); {COLUMNS}, or five in a table with V-numbers{hint}", row.words.len()),
        ));
    };
    let says_stop = is_stop_word(first);
    Ok(RawInterface {
        radius: if says_stop { f64::INFINITY } else { radius(rows, first)? },
        says_stop,
        thickness: rows.number(thickness, "a thickness in mm")?,
        medium: match glasses.find(rows, medium)? {
            Some(glass) => glass,
            None => index(rows, medium)?.map_or(Medium::Air, |n_d| Medium::Glass { n_d, abbe: None }),
        },
        diameter: rows.number(diameter, "a clear diameter in mm")?,
    })
}
