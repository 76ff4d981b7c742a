//! Lens files in JSON. The keys at the beginning tell the program that wrote the file.
//!
//! `document` parses the text. `fates` records the fate of every key. Each format has its own module: `lhlt` (LensHH),
//! `ray_optics`, `optiland`, `deep_lens`, `ghostlight`, `iset` and `geopter`.

mod deep_lens;
mod document;
mod fates;
mod geopter;
mod ghostlight;
mod iset;
mod lhlt;
mod optiland;
mod ray_optics;

use super::{
    ledger::Ledger,
    named_glass::NamedGlasses,
    sequential::{CURVED_IMAGE, SurfacePlaces},
    surface_rows::{self, MediumBehind},
    text::{Text, title},
};
use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES, PROFILE_TERMS,
    glass::GlassLibrary,
    interfaces::{Medium, Prescription},
};
use document::{Node, Part};
use realistic_base::message::cut;

/// Returns whether a text looks like JSON.
pub(super) fn is_json(text: &[u8]) -> bool {
    let begins = |byte: &u8| matches!(byte, b'{' | b'[' | b'"' | b'-' | b'0'..=b'9');
    match text.trim_ascii_start() {
        [b'{', ..] => true,
        [b'[', rest @ ..] => rest.trim_ascii_start().first().is_some_and(begins),
        _ => false,
    }
}

/// Reads a lens from a text.
///
/// # Errors
/// The text is not JSON, no supported program wrote it, or the lens cannot be traced; the error gives the place.
pub(super) fn read(
    text: &Text<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let root = Node::of(text)?;
    let part = Part { text, node: &root };
    let has = |key: &str| root.has(key);
    let (lens, no_effect) = if has("FormatVersion") && has("Surfaces") {
        (lhlt::read(part, library, ledger)?, lhlt::NO_EFFECT)
    } else if has("optical_model") {
        (ray_optics::read(part, library, ledger)?, ray_optics::NO_EFFECT)
    } else if has("surface_group") {
        (optiland::read(part, library, ledger)?, optiland::NO_EFFECT)
    } else if part.get("format").and_then(|format| format.node.string()) == Some("ghostlight-optical") {
        (ghostlight::read(part, ledger)?, ghostlight::NO_EFFECT)
    } else if deep_lens::is_lens(&root) {
        (deep_lens::read(part, library, ledger)?, deep_lens::NO_EFFECT)
    } else if iset::is_lens(&root) {
        (iset::read(part, library, ledger)?, iset::NO_EFFECT)
    } else if has("Assembly") {
        (geopter::read(part, library, ledger)?, geopter::NO_EFFECT)
    } else {
        return Err(part.error(format!("JSON without the keys of a known lens format; {}", super::READ)));
    };
    fates::record(&root, no_effect, ledger);
    Ok(lens)
}

/// Checks that a list of surfaces, with the object and the image, is not longer than a lens.
fn check_count(list: &[Part<'_>]) -> Result<(), LensFileError> {
    match list.get(MAX_INTERFACES + 2) {
        Some(part) => Err(part.error(format!(
            "surface {} of {}; a lens has at most {MAX_INTERFACES} interfaces",
            MAX_INTERFACES + 3,
            list.len()
        ))),
        None => Ok(()),
    }
}

/// Splits a list of surfaces into the object, the surfaces of the lens and the image.
///
/// # Errors
/// The list is too short or too long.
fn object_own_image<'l, 'j>(
    list: &'l [Part<'j>],
    whole: Part<'_>,
) -> Result<(Part<'j>, &'l [Part<'j>], Part<'j>), LensFileError> {
    check_count(list)?;
    match list {
        [object, own @ .., image] if !own.is_empty() => Ok((*object, own, *image)),
        _ => Err(whole.error(format!(
            "{} surface(s); expected the object, at least one surface and the image",
            list.len()
        ))),
    }
}

/// Returns the curvature of a radius, of which 0 and infinity mean a plane.
fn curvature(radius: f64) -> f64 {
    if radius == 0.0 { 0.0 } else { radius.recip() }
}

/// Returns the medium of an index and a V-number.
///
/// # Errors
/// No medium of a lens has this index; the text states the allowed indices.
fn by_numbers(
    name: &str,
    n_d: f64,
    abbe: Option<f64>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, &'static str> {
    let abbe = abbe.filter(|abbe| *abbe > 0.0 && abbe.is_finite());
    let medium = |n_d| glasses.by_numbers(name, n_d, abbe);
    Ok(surface_rows::index(n_d)?.map_or(Medium::Air.into(), medium))
}

/// Returns the glass of that name.
///
/// # Errors
/// The glass is not known.
fn by_name(
    part: Part<'_>,
    name: &str,
    glasses: &mut NamedGlasses<'_>,
) -> Result<MediumBehind, LensFileError> {
    glasses.by_name(name, None, None).map_err(|why| part.error(why))
}

/// Warns that the image is curved, if it is.
fn check_image(curvature: f64, image: Part<'_>, key: &str, ledger: &mut Ledger<'_>) {
    if curvature != 0.0 {
        let location = image.get(key).unwrap_or(image).node.location;
        ledger.warn(Fate::Replaced, location, key, None, CURVED_IMAGE);
    }
}

/// Returns the place of a surface with these keys for its size and its thickness.
fn place(part: Part<'_>, number: String, size: Option<&str>, thickness: Option<&str>) -> SurfacePlaces {
    let of = |key: Option<&str>| Some(part.get(key?)?.node.location);
    SurfacePlaces { surface: part.node.location, size: of(size), thickness: of(thickness), number }
}

/// Returns the error that a surface of the lens is something that is not traced. `what` follows "surface 3 ".
fn refused(part: Part<'_>, number: &str, what: impl AsRef<str>) -> LensFileError {
    part.error(format!("surface {} {}", cut(number), what.as_ref()))
}

/// Returns the terms of a toroid's profile. The file lists the coefficients of y², y⁴, ….
///
/// # Errors
/// There are more terms than are traced.
fn profile_terms(
    part: Part<'_>,
    number: &str,
    stated: Vec<f64>,
) -> Result<[f64; PROFILE_TERMS], LensFileError> {
    let mut terms = [0.0; PROFILE_TERMS];
    for (i, value) in stated.into_iter().enumerate().filter(|(_, value)| *value != 0.0) {
        let beyond =
            || refused(part, number, "is a toroid with terms beyond the 14th power; 7 terms are traced");
        *terms.get_mut(i).ok_or_else(beyond)? = value;
    }
    Ok(terms)
}

/// The advice for surfaces that are not symmetric about the lens's axis.
const REVOLUTION: &str = "only surfaces of revolution about one axis are traced";

/// Returns the index of a surface in the list of glasses and the warnings about glasses, added to the lens.
fn finished(lens: Prescription, glasses: NamedGlasses<'_>, file: &str) -> Prescription {
    let (glasses, remarks) = glasses.glasses_and_warnings(file);
    Prescription { glasses, remarks, ..lens }
}

#[cfg(test)]
mod tests;
