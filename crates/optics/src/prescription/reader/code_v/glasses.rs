//! The glasses of a file: those of its own catalogue, `PRV` to `END`, and those that `S` names. `NBK7_SCHOTT` is N-BK7
//! of SCHOTT, `517642` a six-digit code, and `517.642` or `1.517:64.2` a fictitious glass.
//!
//! `PWL` states the wavelengths of the catalogue. A glass has its index at each of them, or `LAU` and the constants of
//! Schott's formula, n² = A0 + A1 λ² + A2 λ^-2 + A3 λ^-4 + ….

use super::blocks::Blocks;
use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES,
    glass::{Formula, GlassLibrary, LOWEST_POWER, by_fractions, by_pair, tabulated, usable_range},
    interfaces::{Glass, Medium},
    reader::{
        commands::{Block, Command},
        ledger::Ledger,
        named_glass::NamedGlasses,
        surface_rows::{MediumBehind, index},
        text::{Cell, Text},
    },
};
use realistic_base::message::short;

/// The largest difference between an index and its formula that is not reported. Indices of tables have five decimals.
const CLOSE: f64 = 1e-5;

/// The glasses of a file.
pub(super) struct Glasses<'a> {
    named: NamedGlasses<'a>,
    /// The glasses of the file's catalogue by their names in capitals, or the faults of those that cannot be used.
    own: Vec<(String, Result<Glass, LensFileError>)>,
}

impl<'a> Glasses<'a> {
    /// Reads the catalogue of the file.
    ///
    /// # Errors
    /// A statement of the catalogue is malformed.
    pub(super) fn of(
        text: &Text<'_>,
        blocks: &Blocks<'_>,
        library: &'a GlassLibrary,
        ledger: &mut Ledger<'_>,
    ) -> Result<Self, LensFileError> {
        let mut all = Self { named: NamedGlasses::new(library, Vec::new()), own: Vec::new() };
        let mut wavelengths = Vec::new();
        for statement in &blocks.catalogue {
            match statement.key.as_str() {
                "PRV" | "END" => _ = statement.record.values(),
                "PWL" => wavelengths = statement.record.numbers(text, 0)?,
                _ if all.own.len() == MAX_INTERFACES => {
                    let message = format!("more glasses; a lens file defines at most {MAX_INTERFACES}");
                    return Err(text.error(statement.location(), message));
                }
                _ => {
                    let glass = definition(text, statement, &wavelengths, ledger);
                    all.own.push((statement.record.key.text.to_ascii_uppercase(), glass));
                }
            }
        }
        Ok(all)
    }

    /// Returns the medium behind a surface.
    ///
    /// # Errors
    /// The glass is not known.
    pub(super) fn behind(
        &mut self,
        text: &Text<'_>,
        block: &Block<'_>,
        ledger: &mut Ledger<'_>,
    ) -> Result<MediumBehind, LensFileError> {
        let values = block.entry.record.values();
        if let Some(more) = values.get(3).filter(|word| !word.is("REFR")) {
            let message = format!(
                "\"{more}\" behind the glass; expected nothing more, with a glass such as NBK7_SCHOTT, 517642 or 1.517:64.2"
            );
            return Err(text.error(more.location, message));
        }
        match values.get(2) {
            None => Ok(Medium::Air.into()),
            Some(word) if word.is("REFR") => Ok(Medium::Air.into()),
            Some(word) => self.glass(word, &block.number, ledger).map_err(|why| match why {
                Fault::Here(message) => text.error(word.location, message),
                Fault::InCatalogue(error) => error,
            }),
        }
    }

    fn glass(
        &mut self,
        word: &Cell<'_>,
        number: &str,
        ledger: &mut Ledger<'_>,
    ) -> Result<MediumBehind, Fault> {
        let name = word.text;
        let capitals = name.to_ascii_uppercase();
        // A later definition replaces an earlier one.
        if let Some((_, own)) = self.own.iter().rev().find(|(own, _)| *own == capitals) {
            let glass = own.clone().map_err(Fault::InCatalogue)?;
            return Ok(self.named.use_as(name, glass));
        }
        let fictitious = by_fractions(name).or_else(|| by_pair(name));
        if let Some(Medium::Glass { n_d, abbe }) = fictitious {
            let n_d = index(n_d).map_err(|why| Fault::Here(why.to_owned()))?;
            return Ok(n_d.map_or(Medium::Air.into(), |n_d| self.named.by_numbers(name, n_d, abbe)));
        }
        let (medium, remark) = self.named.of_maker(name).map_err(Fault::Here)?;
        if let Some(reason) = remark {
            ledger.warn(Fate::Replaced, word.location, "S", Some(number), reason);
        }
        Ok(medium)
    }

    pub(super) fn glasses_and_warnings(self, file: &str) -> (Vec<(String, Glass)>, Vec<String>) {
        self.named.glasses_and_warnings(file)
    }
}

/// The reason why a glass cannot be used.
enum Fault {
    /// A message about the word that names the glass.
    Here(String),
    /// The error of the glass's definition in the file's catalogue.
    InCatalogue(LensFileError),
}

/// Returns whether a word behind the thickness makes the surface a mirror.
pub(super) fn is_mirror(block: &Block<'_>) -> bool {
    let is_reflection =
        |word: &Cell<'_>| ["REFL", "REF", "REFLECT", "TIR"].iter().any(|known| word.is(known));
    block.entry.record.values().iter().skip(2).any(is_reflection)
}

/// Returns the glass of a definition in the file's catalogue.
fn definition(
    text: &Text<'_>,
    statement: &Command<'_>,
    wavelengths: &[f64],
    ledger: &mut Ledger<'_>,
) -> Result<Glass, LensFileError> {
    let fault =
        |why: String| text.error(statement.location(), format!("glass {}: {why}", statement.record.key));
    let values = statement.record.values();
    if let Some(kind) = values.first().filter(|value| value.number().is_none()) {
        if !kind.is("LAU") {
            return Err(fault(format!(
                "a definition by {kind}, which is not read; read are LAU and indices at PWL"
            )));
        }
        let constants = statement.record.numbers(text, 1)?;
        let medium = laurent(&constants).ok_or_else(|| fault("LAU has one to six constants".to_owned()))?;
        let range = usable_range(medium, None).map_err(fault)?;
        return Ok(Glass::new(medium, range));
    }
    let indices = statement.record.numbers(text, 0)?;
    if indices.len() != wavelengths.len() {
        return Err(fault(format!("{} indices at {} wavelengths (PWL)", indices.len(), wavelengths.len())));
    }
    let points: Vec<[f64; 2]> = wavelengths.iter().zip(&indices).map(|(w, n)| [*w, *n]).collect();
    let (glass, apart) = tabulated(&points).map_err(fault)?;
    if apart > CLOSE {
        let reason = format!(
            "a formula takes the place of the indices, from which it differs by up to {}",
            short(apart)
        );
        ledger.note(Fate::Replaced, statement.location(), "PRV", None, reason);
    }
    Ok(glass)
}

/// Returns the medium of n² = A0 + A1 λ² + A2 λ^-2 + A3 λ^-4 + A4 λ^-6 + A5 λ^-8.
fn laurent(constants: &[f64]) -> Option<Medium> {
    if !(1..=6).contains(&constants.len()) {
        return None;
    }
    let constant = (-LOWEST_POWER / 2) as usize;
    let places = [constant, constant + 1, constant - 1, constant - 2, constant - 3, constant - 4];
    let mut by_power = [0.0; 10];
    for (place, value) in places.into_iter().zip(constants) {
        by_power[place] = *value;
    }
    Some(Medium::Formula(Formula::Polynomial(by_power)))
}
