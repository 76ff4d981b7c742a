//! Lines `coating ROW NAME at=NM`: what surfaces between air and glass are coated with.

use super::{
    aspheres::row,
    lines::{Lines, Word},
};
use crate::{
    message::nearest_or_all,
    prescription::{
        LensFileError,
        coating::{Coating, SurfaceCoating},
        glass::VALID_WAVELENGTHS,
        interfaces::{Interface, has_coating},
    },
};

const FORM: &str = "a coating is: coating ROW NAME at=NM (ROW all for every row between air and glass without a line of its own; \
     550 nm where at=NM is left out)";

/// The word in place of a row that stands for all.
const ALL: &str = "all";

/// A line: the word that says which rows, and their coating.
pub(super) type CoatingLine = (Word, SurfaceCoating);

/// Takes the lines of coatings out of the others.
pub(super) fn take(lines: &mut Lines) -> Result<Vec<CoatingLine>, LensFileError> {
    let taken = lines.take(&["coating"]);
    lines.at_most(&taken, "a lens has at most as many coatings as interfaces")?;
    let mut found: Vec<CoatingLine> = Vec::new();
    for line in &taken {
        let (rows, name, at) = match line.words.as_slice() {
            [_, rows, name] => (rows, name, None),
            [_, rows, name, at] => (rows, name, Some(at)),
            words => return Err(lines.error(&words[0], FORM)),
        };
        if found.iter().any(|(known, _)| known.text.eq_ignore_ascii_case(&rows.text)) {
            return Err(lines.error(rows, &format!("the coating of {rows} is given twice; {FORM}")));
        }
        let known = Coating::NAMES.iter().find(|(known, _)| name.is(known));
        let Some((_, coating)) = known else {
            let names = nearest_or_all(&name.text, &Coating::NAMES.map(|(name, _)| name));
            return Err(lines.error(name, &format!("no coating is called \"{name}\"; {names}; {FORM}")));
        };
        let mut coating = SurfaceCoating::from(*coating);
        if let Some(word) = at {
            let (_, number) = lines.constant(word, &["at".to_owned()], &format!("at=480; {FORM}"))?;
            if !VALID_WAVELENGTHS.contains(&number) {
                let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
                let message = format!(
                    "a coating for {number} nm; coatings are made for wavelengths from {first} to {last} nm"
                );
                return Err(lines.error(word, &message));
            }
            coating.wavelength = number;
        }
        found.push((rows.clone(), coating));
    }
    Ok(found)
}

/// The coatings of the surfaces, where the file says anything of them. A surface of which it does not is bare.
pub(super) fn of_surfaces(
    lines: &Lines,
    found: &[CoatingLine],
    interfaces: &[Interface],
) -> Result<Option<Vec<SurfaceCoating>>, LensFileError> {
    if found.is_empty() {
        return Ok(None);
    }
    let can_have: Vec<bool> = has_coating(interfaces).collect();
    let all =
        found.iter().find(|(rows, _)| rows.is(ALL)).map_or(Coating::Bare.into(), |(_, coating)| *coating);
    let mut coatings: Vec<SurfaceCoating> =
        can_have.iter().map(|can| if *can { all } else { Coating::Bare.into() }).collect();
    for (word, coating) in found.iter().filter(|(rows, _)| !rows.is(ALL)) {
        let row = row(lines, word, interfaces.len(), FORM)?;
        if !can_have[row] {
            let message =
                format!("row {word} is not between air and glass, where coatings are; leave its coating out");
            return Err(lines.error(word, &message));
        }
        coatings[row] = *coating;
    }
    Ok(Some(coatings))
}
