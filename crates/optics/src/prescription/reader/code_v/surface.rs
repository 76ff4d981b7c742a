//! A surface of the file: its figure, thickness, aperture and role. Surfaces that are not traced are refused.

use super::{frames, glasses, glasses::Glasses, shapes, statements::UNTRACED};
use crate::prescription::{
    LensFileError,
    interfaces::{AsphereTerms, NO_TERMS},
    reader::{
        commands::Block,
        ledger::Ledger,
        sequential::{SequentialSurface, asphere, set_term},
        surface_rows::{General, MediumBehind},
        text::Text,
    },
};

/// The keywords of the terms of r⁴ to r²⁰. There is no I.
const TERMS: [&str; 9] = ["A", "B", "C", "D", "E", "F", "G", "H", "J"];

/// Thicknesses of this magnitude mean infinity.
const ENDLESS: f64 = 1e10;

/// Reads one surface of the lens; its curvature is 0. `in_front` is the medium in front of it.
///
/// # Errors
/// The surface is not traced, or a value is missing or wrong.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    in_front: MediumBehind,
    glasses: &mut Glasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<SequentialSurface, LensFileError> {
    block.check(text, UNTRACED)?;
    let is_mirror = glasses::is_mirror(block);
    let behind = if is_mirror { in_front } else { glasses.behind(text, block, ledger)? };
    let [coordinate_break, break_behind] = frames::read(text, block, is_mirror)?;
    let conic = block.find("K").map_or(Ok(0.0), |statement| statement.record.number(text, 0))?;
    for kind in ["SPH", "CON", "ASP"] {
        block.find(kind).map(|statement| statement.record.values());
    }
    let aperture = shapes::read(text, block, is_mirror, ledger)?;
    let is_stop = block.find("STO").inspect(|statement| _ = statement.record.values()).is_some();
    Ok(SequentialSurface {
        curvature: 0.0,
        asphere: asphere(conic, terms(text, block)?),
        behind,
        semi_diameter: aperture.clip,
        listed: None,
        clip: aperture.clip,
        is_fixed: aperture.clip.is_some() || !aperture.others.is_empty(),
        apertures: aperture.others,
        is_stop,
        general: General { is_mirror, coordinate_break, ..General::default() },
        break_behind,
    })
}

fn terms(text: &Text<'_>, block: &Block<'_>) -> Result<AsphereTerms, LensFileError> {
    let mut terms = NO_TERMS;
    for (i, key) in TERMS.into_iter().enumerate() {
        let Some(statement) = block.find(key) else { continue };
        let value = statement.record.number(text, 0)?;
        set_term(&mut terms, 4 + 2 * i, value).map_err(|why| block.refused(text, statement, &why))?;
    }
    Ok(terms)
}

/// Returns the thickness behind a surface of the lens: that of `THI` or, with a solve there, that of its entry.
pub(super) fn thickness(text: &Text<'_>, block: &Block<'_>) -> Result<f64, LensFileError> {
    let set = block.statements.iter().rev().find(|statement| {
        statement.key == "THI" && statement.record.words().first().is_some_and(|word| word.number().is_some())
    });
    let (statement, value) = match set {
        Some(statement) => (statement, statement.record.number(text, 0)?),
        None if is_endless(block) => (&block.entry, f64::INFINITY),
        None => (&block.entry, block.entry.record.number(text, 1)?),
    };
    if value.abs() >= ENDLESS {
        let what = "has a thickness without end; a lens's surfaces stand at finite distances";
        return Err(block.refused(text, statement, what));
    }
    Ok(value)
}

/// Returns the distance of the object, infinite from [`ENDLESS`] on.
pub(super) fn object_distance(text: &Text<'_>, object: &Block<'_>) -> Result<f64, LensFileError> {
    let distance = if is_endless(object) { f64::INFINITY } else { object.entry.record.number(text, 1)? };
    Ok(if distance.abs() >= ENDLESS { f64::INFINITY } else { distance })
}

fn is_endless(block: &Block<'_>) -> bool {
    block.entry.record.word(1).is_some_and(|word| word.is_infinite())
}
