//! Lines `coating ROW NAME at=NM` and `coating ROW stack INDEX NM …`: the coatings of surfaces between air and glass.

use super::lines::Lines;
use crate::prescription::{
    LensFileError, MAX_INTERFACES,
    coating::{Coating, DENSEST, Layer, MOST_LAYERS, STACK, SurfaceCoating, THICKEST},
    glass::VALID_WAVELENGTHS,
    interfaces::{Interface, Medium, has_coating},
    reader::text::Cell,
};
use realistic_base::message::{as_given, nearest_or_all};

const FORM: &str = "a coating is: coating ROW NAME at=NM, or coating ROW stack INDEX NM … with the layers from the air on (ROW all \
     for every row between air and glass without a line of its own; 550 nm where at=NM is left out)";

/// The word that stands for all rows, in place of a row's number.
const ALL: &str = "all";

/// A coating line: the word that states its rows, and the coating of these rows.
pub(super) type CoatingLine<'t> = (Cell<'t>, SurfaceCoating);

/// Takes the coating lines out of `lines`.
pub(super) fn take<'t>(lines: &mut Lines<'t>) -> Result<Vec<CoatingLine<'t>>, LensFileError> {
    let taken = lines.take(&["coating"]);
    lines.at_most(&taken, MAX_INTERFACES, "a lens has at most as many coatings as interfaces")?;
    let mut found: Vec<CoatingLine<'t>> = Vec::new();
    for line in &taken {
        let [_, rows, name, values @ ..] = line.as_slice() else {
            return Err(lines.error(&line[0], FORM));
        };
        if found.iter().any(|(known, _)| known.is(rows.text)) {
            return Err(lines.error(rows, &format!("the coating of {rows} is given twice; {FORM}")));
        }
        let coating = if name.is(STACK) { stack(lines, name, values) } else { named(lines, name, values) }?;
        found.push((*rows, coating));
    }
    Ok(found)
}

/// Reads a coating with a name.
fn named(lines: &Lines<'_>, name: &Cell<'_>, values: &[Cell<'_>]) -> Result<SurfaceCoating, LensFileError> {
    let known = Coating::NAMES.iter().find(|(known, _)| name.is(known));
    let Some((_, coating)) = known else {
        let names: Vec<&str> = Coating::NAMES.iter().map(|(name, _)| *name).chain([STACK]).collect();
        let names = nearest_or_all(name.text, &names);
        return Err(lines.error(name, &format!("no coating is called \"{name}\"; {names}; {FORM}")));
    };
    let [word, more @ ..] = values else { return Ok((*coating).into()) };
    if let [word, ..] = more {
        return Err(lines.error(word, &format!("\"{word}\" is one value too many; {FORM}")));
    }
    let (_, wavelength) = lines.constant(word, &["at".to_owned()], &format!("at=480; {FORM}"))?;
    if !VALID_WAVELENGTHS.contains(&wavelength) {
        let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
        let message = format!(
            "a coating for {} nm; coatings are made for wavelengths from {first} to {last} nm",
            as_given(wavelength)
        );
        return Err(lines.error(word, &message));
    }
    Ok(SurfaceCoating::Named { coating: *coating, wavelength })
}

/// Reads a coating given by its layers.
fn stack(lines: &Lines<'_>, name: &Cell<'_>, values: &[Cell<'_>]) -> Result<SurfaceCoating, LensFileError> {
    let (pairs, []) = values.as_chunks::<2>() else {
        let last = &values[values.len() - 1];
        return Err(lines.error(last, &format!("the layer of index {last} has no thickness; {FORM}")));
    };
    if pairs.is_empty() {
        return Err(lines.error(name, &format!("a stack without layers; {FORM}")));
    }
    if let Some([beyond, _]) = pairs.get(MOST_LAYERS) {
        return Err(lines.error(beyond, &format!("a stack has at most {MOST_LAYERS} layers")));
    }
    let mut layers = Vec::with_capacity(pairs.len());
    let mut whole = 0.0;
    for [index_word, thickness_word] in pairs {
        let index = lines.number(index_word, "the refractive index of a layer")?;
        if !(1.0..=DENSEST).contains(&index) {
            let message = format!(
                "a layer of index {index_word}; layers have indices from 1 to {DENSEST}, and then nm: {FORM}"
            );
            return Err(lines.error(index_word, &message));
        }
        let thickness = lines.number(thickness_word, "the thickness of a layer in nm")?;
        whole += thickness;
        if !(thickness > 0.0 && whole <= THICKEST) {
            let message = format!(
                "a layer {thickness_word} nm thick; layers are thicker than 0 nm, and at most {THICKEST} nm together"
            );
            return Err(lines.error(thickness_word, &message));
        }
        layers.push(Layer { index, thickness });
    }
    Ok(SurfaceCoating::Stack(layers))
}

/// Returns the coatings of the surfaces, if the file has any. Surfaces for which the file gives no coating are bare.
pub(super) fn of_surfaces(
    lines: &Lines<'_>,
    found: &[CoatingLine<'_>],
    object: Medium,
    interfaces: &[Interface],
) -> Result<Option<Vec<SurfaceCoating>>, LensFileError> {
    if found.is_empty() {
        return Ok(None);
    }
    let can_have: Vec<bool> = has_coating(object, interfaces).collect();
    let bare = SurfaceCoating::from(Coating::Bare);
    let all = found.iter().find(|(rows, _)| rows.is(ALL)).map_or(&bare, |(_, coating)| coating);
    let mut coatings: Vec<SurfaceCoating> =
        can_have.iter().map(|can| if *can { all } else { &bare }.clone()).collect();
    for (word, coating) in found.iter().filter(|(rows, _)| !rows.is(ALL)) {
        let row = lines.row_number(word, interfaces.len(), FORM)?;
        if !can_have[row] {
            let message =
                format!("row {word} is not between air and glass, where coatings are; leave its coating out");
            return Err(lines.error(word, &message));
        }
        coatings[row] = coating.clone();
    }
    Ok(Some(coatings))
}
