//! The keywords of the language: those of statements about a surface, those without an effect on rays through the lens,
//! each with the reason, and those of lenses that are not traced.

use super::blocks::Blocks;
use crate::prescription::{
    LensFileError,
    reader::{
        commands::{NoEffect, Untraced},
        text::Text,
    },
};

/// Keywords of statements about a surface that are read.
const OF_SURFACE: [&str; 36] = [
    "STO", "SLB", "COM", "SPH", "CON", "ASP", "K", "A", "B", "C", "D", "E", "F", "G", "H", "J", "CUY", "RDY",
    "THI", "CIR", "REX", "REY", "ELX", "ELY", "ADX", "ADY", "ARO", "DAR", "BEN", "REV", "XDE", "YDE", "ZDE",
    "ADE", "BDE", "CDE",
];
/// Keywords of statements about a surface for the optimiser and the tolerances.
const COUPLINGS: &[&str] = &[
    "PIM", "CCY", "CCX", "THC", "GLC", "KC", "CUC", "AC", "BC", "CC", "DC", "EC", "FC", "GC", "HC", "JC",
    "XDC", "YDC", "ZDC", "ADC", "BDC", "CDC", "HCC", "CUM", "THM",
];

/// Features of surfaces that are not traced, with their keywords.
pub(super) const UNTRACED: Untraced = &[
    ("has an offset of the axis of its tilts", &["XOD", "YOD", "ZOD"]),
    ("has its place from another surface", &["RET", "GLB", "NAX"]),
    ("is a cylinder or toroid", &["CYL", "CUX", "RDX", "XTO", "YTO"]),
    (
        "is an asphere with two curvatures",
        &["AAS", "KX", "KY", "AR", "BR", "CR", "DR", "AP", "BP", "CP", "DP"],
    ),
    ("is a surface of a special type", &["SPS", "ODD"]),
    ("is a Fresnel surface", &["FRS", "CUF"]),
    ("is a grating or a hologram", &["DIF", "GRT", "GRO", "GRS", "HOE", "HV1", "HV2"]),
    ("has the phase of a grating or a hologram", &["HOR", "HWL", "HCT", "HCO"]),
    ("has the figure of an interferogram", &["INT"]),
    ("has a term that this reader does not know", &["I"]),
    ("has its glass in a statement of its own and not behind its thickness", &["GLA"]),
    ("refracts or reflects by a statement of its own", &["RMD"]),
    ("has an aperture whose values have no order that is known for certain", &["CIG", "REG", "ELG"]),
];

/// Returns whether a statement is about a surface.
pub(super) fn is_of_surface(key: &str) -> bool {
    let untraced = UNTRACED.iter().flat_map(|(_, keys)| keys.iter());
    OF_SURFACE.iter().chain(COUPLINGS).chain(untraced).any(|known| *known == key)
}

/// Keywords without an effect on rays.
pub(super) const NO_EFFECT: NoEffect = &[
    ("names and notes", &["LEN", "INI", "SLB", "COM", "UID"]),
    ("settings of the file's program", &["GO", "POL", "WID", "CLS", "CA"]),
    ("the temperature and pressure of the file's program, which its indices do not follow", &["TEM", "PRE"]),
    ("solves and pickups, whose values the file holds", &["PIK", "THI", "CUY"]),
    ("a place without tilts and decentrings", &["DAR", "BEN", "REV"]),
    ("for the optimiser, the tolerances and the solves, whose values the file holds", COUPLINGS),
    ("for the tolerances", &["DER", "CMP", "DSX", "DSY", "BTX", "BTY"]),
    (
        "fields, wavelengths and their weights, which the user chooses",
        &["WTW", "WTF", "VUX", "VLX", "VUY", "VLY"],
    ),
];

/// Keywords of lenses that are not traced, with the reason.
const REFUSED: [(&str, &str); 3] = [
    ("ZOO", "zoom positions, which are not read; keep one position in Code V and save the lens"),
    ("IN", "the lens goes on in another file, which is not read; give the lens in one file"),
    ("NSS", "surfaces in no sequence, which are not traced"),
];

/// Refuses lenses that are not traced.
///
/// # Errors
/// The file has a statement of such a lens.
pub(super) fn refuse(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<(), LensFileError> {
    for statement in &blocks.general {
        let first = statement.record.words().first();
        if statement.key == "ZOO" && first.is_some_and(|count| count.text == "1") {
            statement.record.values();
        } else if let Some((_, why)) = REFUSED.iter().find(|(key, _)| *key == statement.key) {
            return Err(text.error(statement.location(), format!("{}: {why}", statement.shown())));
        }
    }
    Ok(())
}
