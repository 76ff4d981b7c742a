//! What holds for the whole lens and stands outside its surfaces.
//!
//! - The wavelength that the file is for: `PWAV i`, the number of the primary one among `WAVM i µm weight` lines or, in old
//!   files, the values of `WAVN` or `WAVL`.
//! - Multi-configuration records behind the surfaces: `MNUM n`, then operands `THIC surface configuration value` for gaps that
//!   change and `APER 0 configuration value` for the aperture. The thicknesses of each configuration out.

use super::blocks::{Blocks, Record};
use crate::{
    message::as_given,
    prescription::{
        LensFileError, MAX_POSITIONS,
        glass::VALID_WAVELENGTHS,
        reader::text::{Place, Text, no_number},
    },
};

/// The primary wavelength, nm, and where it stands; `None` where the file has none.
pub(super) fn primary_wavelength(
    text: &Text<'_>,
    blocks: &Blocks<'_>,
) -> Result<Option<(f64, Place)>, LensFileError> {
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

/// The configurations of a file.
#[derive(Debug)]
pub(super) struct Configurations {
    pub count: usize,
    /// `(surface, configuration counted from 0, thickness)`.
    thicknesses: Vec<(usize, usize, f64)>,
    /// `(configuration, value of the aperture)`.
    pub apertures: Vec<(usize, f64)>,
    /// Operands that change the lens in another way and are not followed.
    pub remarks: Vec<String>,
}

impl Configurations {
    pub(super) fn of(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<Self, LensFileError> {
        let mut all = Self { count: 1, thicknesses: Vec::new(), apertures: Vec::new(), remarks: Vec::new() };
        let Some(start) = blocks.general.iter().position(|record| record.key.text == "MNUM") else {
            return Ok(all);
        };
        let first = &blocks.general[start];
        let count = first.number(text, 0)?;
        if count > MAX_POSITIONS as f64 {
            let message = format!("{count} configurations; a lens has at most {MAX_POSITIONS} positions");
            return Err(text.error(first.key.place, message));
        }
        all.count = (count as usize).max(1);
        if all.count == 1 {
            return Ok(all);
        }
        for record in &blocks.general[start + 1..] {
            match record.key.text {
                "THIC" => {
                    let (surface, configuration) = all.place(text, record, blocks.surfaces.len())?;
                    all.thicknesses.push((surface, configuration, record.number(text, 2)?));
                }
                "APER" => {
                    let (_, configuration) = all.place(text, record, usize::MAX)?;
                    all.apertures.push((configuration, record.number(text, 2)?));
                }
                // What changes a surface: its curvature, conic constant, glass, parameters, size.
                "CRVT" | "CONN" | "GLSS" | "PRAM" | "SDIA" | "STPS" | "EDVA" | "MIND" | "MABB" | "IGNR" => {
                    let key = record.key;
                    let message =
                        format!("operand {} changes the lens in a way that is not followed", key.text);
                    let remark = text.error(key.place, message).to_string();
                    if all.remarks.len() < 8 {
                        all.remarks.push(remark);
                    }
                }
                // Fields, wavelengths, vignetting, empty lines.
                _ => {}
            }
        }
        Ok(all)
    }

    /// The surface and the configuration, counted from 0, of an operand.
    fn place(
        &self,
        text: &Text<'_>,
        record: &Record<'_>,
        surfaces: usize,
    ) -> Result<(usize, usize), LensFileError> {
        let [surface, configuration] = [record.number(text, 0)?, record.number(text, 1)?];
        let whole = |number: f64, least: usize, end: usize| {
            let is_one = number.fract() == 0.0 && number >= least as f64 && number < end as f64;
            is_one.then_some(number as usize)
        };
        match (whole(surface, 0, surfaces), whole(configuration, 1, self.count + 1)) {
            (Some(surface), Some(configuration)) => Ok((surface, configuration - 1)),
            _ => {
                let message = format!(
                    "{} of surface {surface} in configuration {configuration}; there are {} configurations, and no such \
                     surface or configuration",
                    record.key.text, self.count
                );
                Err(text.error(record.key.place, message))
            }
        }
    }

    /// The thickness behind a surface in a configuration, `own` where no operand says it.
    pub(super) fn thickness(&self, surface: usize, configuration: usize, own: f64) -> f64 {
        let found = self.thicknesses.iter().find(|(s, c, _)| (*s, *c) == (surface, configuration));
        found.map_or(own, |&(.., thickness)| thickness)
    }
}
