//! Lines that begin with a keyword and concern the whole lens or one row: `asphere`, `stop`, `blades`, `medium`,
//! `wavelength`.
//! They are first taken out of the other lines, and are applied to the rows after the rows have been read.

use super::{glasses::Glasses, lines::Lines, rows};
use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES,
    blades::Blades,
    glass::VALID_WAVELENGTHS,
    interfaces::{Asphere, FIRST_POWER, LAST_POWER, Medium},
    reader::{
        ledger::Ledger,
        surface_rows::{self, MediumBehind, Role, SurfaceRow},
        text::Cell,
    },
};

/// The form of a line `asphere`, for messages.
const ASPHERE: &str = "an asphere is: asphere ROW conic=… A4=… A6=… (any of A1 to A30, in mm^(1 - i))";
/// The form of a line `stop`, for messages.
const STOP: &str = "a stop on a surface is: stop ROW";
/// The form of a line `medium`, for messages.
const MEDIUM: &str =
    "the medium in front of the lens is: medium NAME, or: medium INDEX V (V may be left out)";
/// The form of a line `blades`, for messages.
const BLADES: &str = "blades are: blades COUNT rotation=DEGREES curvature=C (3 to 32; 0 where left out; C from 0, straight, to 1, \
     the circle's)";
/// The names of the constants in a line `blades`.
const NAMES: [&str; 2] = ["rotation", "curvature"];

/// Takes the lines `asphere ROW conic=… A1=… … A30=…` out of `lines`. They state the figures of rows, apart from the
/// radii.
pub(super) fn aspheres<'t>(lines: &mut Lines<'t>) -> Result<Vec<(Cell<'t>, Asphere)>, LensFileError> {
    let taken = lines.take(&["asphere"]);
    lines.at_most(&taken, MAX_INTERFACES, "a lens has at most as many aspheres as interfaces")?;
    let powers = (FIRST_POWER..=LAST_POWER).map(|power| format!("A{power}"));
    let names: Vec<String> = std::iter::once("conic".to_owned()).chain(powers).collect();
    let mut aspheres: Vec<(Cell<'t>, Asphere)> = Vec::new();
    for line in &taken {
        let [keyword, row, words @ ..] = line.as_slice() else {
            return Err(lines.error(&line[0], ASPHERE));
        };
        if words.is_empty() {
            return Err(lines.error(keyword, &format!("no constants; {ASPHERE}")));
        }
        if aspheres.iter().any(|(known, _)| known.text == row.text) {
            return Err(lines.error(row, &format!("the figure of row {row} is given twice; {ASPHERE}")));
        }
        let constants = lines.constants(words, &names, "A4=1e-5", ASPHERE)?;
        let constant = |index: usize| constants[index].unwrap_or(0.0);
        let terms = std::array::from_fn(|i| constant(i + 1));
        aspheres.push((*row, Asphere { radius: f64::INFINITY, conic: constant(0), terms }));
    }
    Ok(aspheres)
}

/// Assigns the aspheric figures to their rows.
pub(super) fn give_aspheres(
    lines: &Lines<'_>,
    aspheres: &[(Cell<'_>, Asphere)],
    rows: &mut [SurfaceRow],
) -> Result<(), LensFileError> {
    for (word, asphere) in aspheres {
        let row = lines.row_number(word, rows.len(), ASPHERE)?;
        rows[row].asphere = Some(*asphere);
    }
    Ok(())
}

/// Takes the line `stop ROW` out of `lines`. The surface of the row that it names, possibly a surface of glass, is the
/// stop. A row of the table that is itself a stop has more values: a thickness and a diameter.
pub(super) fn stop<'t>(lines: &mut Lines<'t>) -> Result<Option<Cell<'t>>, LensFileError> {
    let taken = lines.take_where(|line| line.len() == 2 && line[0].is("stop"));
    let line = lines.at_most_one(&taken, "\"stop ROW\"; a lens has one stop")?;
    Ok(line.map(|line| line[1]))
}

/// Makes the row whose number the word states the stop.
pub(super) fn make_stop(
    lines: &Lines<'_>,
    word: Option<&Cell<'_>>,
    rows: &mut [SurfaceRow],
) -> Result<(), LensFileError> {
    if let Some(word) = word {
        let row = lines.row_number(word, rows.len(), STOP)?;
        rows[row].role = Role::Stop;
    }
    Ok(())
}

/// Takes the line `blades COUNT rotation=… curvature=…` out of `lines`. It describes the opening of the iris in the
/// stop.
pub(super) fn blades<'t>(lines: &mut Lines<'t>) -> Result<Option<(Cell<'t>, Blades)>, LensFileError> {
    let taken = lines.take(&["blades"]);
    let Some(line) = lines.at_most_one(&taken, "\"blades\"; a lens has one")? else { return Ok(None) };
    let [keyword, count, words @ ..] = line.as_slice() else {
        return Err(lines.error(&line[0], BLADES));
    };
    let number = count.text.parse().ok().filter(|number| Blades::COUNTS.contains(number));
    let number = number
        .ok_or_else(|| lines.error(count, &format!("\"{count}\" is not a number of blades; {BLADES}")))?;
    let constants = lines.constants(words, &NAMES.map(str::to_owned), "rotation=15", BLADES)?;
    let [rotation, curvature] = [0, 1].map(|index| constants[index].unwrap_or(0.0));
    if !(0.0..=1.0).contains(&curvature) {
        return Err(lines.error(keyword, &format!("the blades' curvature is {curvature}; {BLADES}")));
    }
    Ok(Some((*keyword, Blades { count: number, rotation, curvature })))
}

/// Takes the line `medium NAME` or `medium INDEX V` out of `lines`. It names the medium in front of the lens, which is air
/// without this line.
pub(super) fn medium(
    lines: &mut Lines<'_>,
    glasses: &Glasses<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<MediumBehind, LensFileError> {
    let taken = lines.take(&["medium"]);
    let problem = "\"medium\"; the scene lies in one medium, and the film in that of the last row";
    let Some(line) = lines.at_most_one(&taken, problem)? else { return Ok(Medium::Air.into()) };
    let (keyword, name, abbe) = match line.as_slice() {
        [keyword, name] => (keyword, name, Cell { text: "-", location: name.location }),
        [keyword, name, abbe] => (keyword, name, *abbe),
        [keyword, ..] => return Err(lines.error(keyword, MEDIUM)),
        [] => return Ok(Medium::Air.into()),
    };
    let behind = rows::behind(lines, glasses, name, &abbe)?;
    Ok(surface_rows::checked(behind, |reason| {
        ledger.warn(Fate::Replaced, keyword.location, "medium", None, reason);
    }))
}

/// Takes the line `wavelength NM` out of `lines`. The lens is traced at this wavelength unless the user sets another.
pub(super) fn wavelength<'t>(lines: &mut Lines<'t>) -> Result<Option<(Cell<'t>, f64)>, LensFileError> {
    let taken = lines.take(&["wavelength"]);
    let Some(line) = lines.at_most_one(&taken, "\"wavelength\"; a lens has one")? else { return Ok(None) };
    let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
    let form = format!("a wavelength is: wavelength NM, from {first} to {last}");
    let [_, word] = line.as_slice() else {
        return Err(lines.error(&line[0], &form));
    };
    let number = lines.number(word, "a wavelength in nm")?;
    if VALID_WAVELENGTHS.contains(&number) {
        Ok(Some((*word, number)))
    } else {
        Err(lines.error(word, &format!("the wavelength is {word} nm; {form}")))
    }
}
