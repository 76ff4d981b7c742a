//! The statements about the whole lens, outside its surfaces.
//!
//! - The primary wavelength, for which the file describes the lens. `PWAV i` states its number among the lines
//!   `WAVM i µm weight` or, in old files, among the values of `WAVN` or `WAVL`.
//! - Multi-configuration records behind the surfaces: `MNUM n`, then operands `KEY surface configuration value`. The
//!   reader supports `THIC`, `APER`, and `SDIA` of the stop; other operands that change the lens are reported by name.
//! - The environment, `ENVD`.

use std::collections::{HashMap, HashSet};

use super::{blocks::Blocks, statements::no_effect_of_operand};
use crate::prescription::{
    Fate, LensFileError, MAX_POSITIONS,
    reader::{
        ledger::Ledger,
        record::Record,
        sequential::nanometres,
        text::{Location, Text},
    },
};
use realistic_base::message::{as_given, cut};

/// Returns the primary wavelength, nm, and its location; `None` if the file states none.
pub(super) fn primary_wavelength(
    text: &Text<'_>,
    blocks: &Blocks<'_>,
) -> Result<Option<(f64, Location)>, LensFileError> {
    let of_key =
        |key: &str| blocks.general.iter().filter(|record| record.key.text == key).collect::<Vec<_>>();
    let number = blocks.find("PWAV").map_or(Ok(1.0), |record| record.number(text, 0))?;
    let lines: Vec<&Record<'_>> = of_key("WAVM");
    let by_line =
        lines.iter().find(|record| record.number_if_any(0) == Some(number)).map(|record| (*record, 1));
    let by_value = || {
        let record = blocks.find("WAVN").or_else(|| blocks.find("WAVL"))?;
        let index = (number >= 1.0).then_some(number as usize - 1)?;
        (index < record.values().len() && number.fract() == 0.0).then_some((record, index))
    };
    let Some((record, index)) = by_line.or_else(by_value) else {
        let has_any = !lines.is_empty() || blocks.find("WAVN").or_else(|| blocks.find("WAVL")).is_some();
        return match blocks.find("PWAV") {
            Some(primary) if has_any => {
                let message =
                    format!("wavelength {number} is the primary one, and the file has none of that number");
                Err(text.error(primary.key.location, message))
            }
            _ => Ok(None),
        };
    };
    let Some(cell) = record.word(index) else {
        return Err(text.error(record.key.location, "a wavelength without a value, µm"));
    };
    let micrometres = text.number(&cell, "a wavelength, µm")?;
    let wavelength = nanometres(micrometres).map_err(|why| text.error(cell.location, why))?;
    Ok(Some((wavelength, cell.location)))
}

/// The configurations of a file.
#[derive(Debug)]
pub(super) struct Configurations {
    pub count: usize,
    /// Values of the supported operands. The keys are the operand, the surface as the file numbers it, and the
    /// configuration, counted from 0.
    values: HashMap<(Operand, usize, usize), f64>,
}

/// An operand that the reader supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    /// `THIC`: the thickness behind a surface.
    Thickness,
    /// `SDIA`: the semi-diameter of the stop.
    StopSize,
    /// `APER`: the value of the file's aperture, whatever its kind.
    Aperture,
}

impl Configurations {
    /// Reads the operands of a file whose surface numbers are below `end`. `stop` is the number of the stop's surface,
    /// and `is_by_stop` is true if the file's aperture is the size of the stop. The fates of the operands go to
    /// `ledger`.
    pub(super) fn of(
        text: &Text<'_>,
        blocks: &Blocks<'_>,
        end: usize,
        (stop, is_by_stop): (Option<usize>, bool),
        ledger: &mut Ledger<'_>,
    ) -> Result<Self, LensFileError> {
        let mut all = Self { count: 1, values: HashMap::new() };
        let Some(start) = blocks.general.iter().position(|record| record.key.text == "MNUM") else {
            return Ok(all);
        };
        let first = &blocks.general[start];
        let count = first.number(text, 0)?;
        if count > MAX_POSITIONS as f64 {
            let message = format!("{count} configurations; a lens has at most {MAX_POSITIONS} positions");
            return Err(text.error(first.key.location, message));
        }
        all.count = (count as usize).max(1);
        let mut others: Vec<&Record<'_>> = Vec::new();
        for record in &blocks.general[start + 1..] {
            let key = match record.key.text {
                "THIC" => Operand::Thickness,
                "SDIA" if is_by_stop && stop.map(|stop| stop as f64) == record.number_if_any(0) => {
                    Operand::StopSize
                }
                "APER" if !is_by_stop => Operand::Aperture,
                key => {
                    match no_effect_of_operand(key) {
                        Some(reason) => {
                            ledger.note(Fate::Informative, record.key.location, key, None, reason)
                        }
                        None => others.push(record),
                    }
                    continue;
                }
            };
            let end = if key == Operand::Aperture { usize::MAX } else { end };
            let (surface, configuration) = all.target(text, record, end)?;
            // An aperture belongs to the whole lens.
            let surface = if key == Operand::Aperture { 0 } else { surface };
            all.values.entry((key, surface, configuration)).or_insert(record.number(text, 2)?);
        }
        all.report_unsupported(&others, ledger);
        Ok(all)
    }

    /// Records the fates of operands that the reader does not support. An operand with the same value in every
    /// configuration changes nothing.
    fn report_unsupported<'t>(&self, records: &[&Record<'t>], ledger: &mut Ledger<'_>) {
        fn words<'t, const N: usize>(record: &Record<'t>, values: [usize; N]) -> [Option<&'t str>; N] {
            values.map(|value| record.word(value).map(|cell| cell.text))
        }
        // The subject of an operand consists of the keyword, the surface and, for PRAM, the number of the parameter.
        let subject = |record: &Record<'t>| (record.key.text, words(record, [0, 4]));
        let mut stated: HashMap<_, (HashSet<_>, HashSet<_>)> = HashMap::new();
        for record in records {
            let (configurations, values) = stated.entry(subject(record)).or_default();
            configurations.insert(words(record, [1]));
            values.insert(words(record, [2]));
        }
        for record in records {
            let (location, key) = (record.key.location, record.key.text);
            let (configurations, values) = &stated[&subject(record)];
            if configurations.len() == self.count && values.len() == 1 {
                ledger.note(Fate::Used, location, key, None, "");
            } else {
                let reason = format!(
                    "operand {} changes the lens in a way that is not followed: at every position the lens is as its other \
                     lines say",
                    cut(key)
                );
                ledger.warn(Fate::LeftOut, location, key, None, reason);
            }
        }
    }

    /// Returns the surface of an operand, and its configuration, counted from 0.
    fn target(
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
                Err(text.error(record.key.location, message))
            }
        }
    }

    /// Returns the value of an operand in a configuration; `None` if the file does not state it.
    pub(super) fn value(&self, key: Operand, surface: usize, configuration: usize) -> Option<f64> {
        self.values.get(&(key, surface, configuration)).copied()
    }

    /// Returns the value of the aperture in a configuration.
    pub(super) fn aperture(&self, configuration: usize) -> Option<f64> {
        self.value(Operand::Aperture, 0, configuration)
    }
}

/// Warns of an environment for which the file's program adjusts the refractive indices. `ENVD` states the temperature
/// in °C, the pressure in atmospheres, and whether the indices are adjusted to the two.
pub(super) fn environment(blocks: &Blocks<'_>, ledger: &mut Ledger<'_>) {
    let Some(record) = blocks.find("ENVD") else { return };
    let [temperature, pressure, adjusts] = [0, 1, 2].map(|value| record.number_if_any(value));
    let (temperature, pressure) = (temperature.unwrap_or(20.0), pressure.unwrap_or(1.0));
    if adjusts == Some(1.0) && (temperature != 20.0 || pressure != 1.0) {
        let reason = format!(
            "the lens is for {} °C and {} atmospheres (ENVD), to which the file's program adjusts the indices; those of 20 °C \
             and 1 atmosphere, against air, are used",
            as_given(temperature),
            as_given(pressure)
        );
        ledger.warn(Fate::Replaced, record.key.location, "ENVD", None, reason);
    }
}
