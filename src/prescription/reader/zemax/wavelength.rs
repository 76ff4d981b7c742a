//! The wavelength that the file is for: `PWAV i`, the number of the primary one among `WAVM i µm weight` lines or, in old files,
//! the values of `WAVN` or `WAVL`.

use super::blocks::{Blocks, Record};
use crate::{
    message::as_given,
    prescription::{
        LensFileError,
        glass::VALID_WAVELENGTHS,
        reader::text::{Place, Text, no_number},
    },
};

/// The primary wavelength, nm, and where it stands; `None` where the file has none.
pub(super) fn primary(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<Option<(f64, Place)>, LensFileError> {
    let of_key =
        |key: &str| blocks.general.iter().filter(|record| record.key.text == key).collect::<Vec<_>>();
    let number = blocks.find("PWAV").map_or(Ok(1.0), |record| record.number(text, 0))?;
    let lines: Vec<&Record<'_>> = of_key("WAVM");
    let by_line =
        lines.iter().find(|record| record.number_if_any(0) == Some(number)).map(|record| (*record, 1));
    let by_value = || {
        let record = blocks.find("WAVN").or_else(|| blocks.find("WAVL"))?;
        let place = (number >= 1.0).then_some(number as usize - 1)?;
        (place < record.values.len() && number.fract() == 0.0).then_some((record, place))
    };
    let Some((record, place)) = by_line.or_else(by_value) else {
        let has_any = !lines.is_empty() || blocks.find("WAVN").or_else(|| blocks.find("WAVL")).is_some();
        return match blocks.find("PWAV") {
            Some(primary) if has_any => {
                let message =
                    format!("wavelength {number} is the primary one, and the file has none of that number");
                Err(text.error(primary.key.place, message))
            }
            _ => Ok(None),
        };
    };
    let Some(cell) = record.values.get(place) else {
        return Err(text.error(record.key.place, "a wavelength without a value, µm"));
    };
    let micrometres =
        cell.number().ok_or_else(|| text.error(cell.place, no_number(cell.text, "a wavelength, µm")))?;
    // The decimal that is meant: 0.58756 times 1000 is not 587.56.
    let wavelength = format!("{:.12e}", micrometres * 1e3).parse().expect("a number");
    if !VALID_WAVELENGTHS.contains(&wavelength) {
        let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
        let message = format!(
            "the primary wavelength is {} nm; lenses are traced from {first} to {last} nm",
            as_given(wavelength)
        );
        return Err(text.error(cell.place, message));
    }
    Ok(Some((wavelength, cell.place)))
}
