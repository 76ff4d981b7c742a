//! Lines `asphere ROW conic=… A2=… … A20=…`: what a row's surface is beside its radius. Each constant bears its name.

use super::lines::{Lines, Word};
use crate::prescription::{
    LensFileError,
    interfaces::{Asphere, FIRST_POWER, LAST_POWER},
    reader::surfaces::SurfaceRow,
};

const FORM: &str = "an asphere is: asphere ROW conic=… A4=… A6=… (any of A2 to A20, in mm^(1 - i))";

/// Takes the lines of aspheres out of the others.
pub(super) fn take(lines: &mut Lines) -> Result<Vec<(Word, Asphere)>, LensFileError> {
    let taken = lines.take(&["asphere"]);
    lines.at_most(&taken, "a lens has at most as many aspheres as interfaces")?;
    let powers = (FIRST_POWER..=LAST_POWER).map(|power| format!("A{power}"));
    let names: Vec<String> = std::iter::once("conic".to_owned()).chain(powers).collect();
    let mut aspheres: Vec<(Word, Asphere)> = Vec::new();
    for line in &taken {
        let [keyword, row, words @ ..] = line.words.as_slice() else {
            return Err(lines.error(&line.words[0], FORM));
        };
        if words.is_empty() {
            return Err(lines.error(keyword, &format!("no constants; {FORM}")));
        }
        if aspheres.iter().any(|(known, _)| known.text == row.text) {
            return Err(lines.error(row, &format!("the figure of row {row} is given twice; {FORM}")));
        }
        let mut constants = vec![None; names.len()];
        for word in words {
            let (place, number) = lines.constant(word, &names, &format!("A4=1e-5; {FORM}"))?;
            if constants[place].replace(number).is_some() {
                return Err(lines.error(word, &format!("\"{word}\": given twice; {FORM}")));
            }
        }
        let constant = |place: usize| constants[place].unwrap_or(0.0);
        let terms = std::array::from_fn(|i| constant(i + 1));
        aspheres.push((row.clone(), Asphere { radius: f64::INFINITY, conic: constant(0), terms }));
    }
    Ok(aspheres)
}

/// Gives the rows their figures.
pub(super) fn apply(
    lines: &Lines,
    aspheres: &[(Word, Asphere)],
    rows: &mut [SurfaceRow],
) -> Result<(), LensFileError> {
    for (word, asphere) in aspheres {
        let row = row(lines, word, rows.len(), FORM)?;
        rows[row].asphere = Some(*asphere);
    }
    Ok(())
}

/// The row, counted from 0, that a word names.
pub(super) fn row(lines: &Lines, word: &Word, rows: usize, form: &str) -> Result<usize, LensFileError> {
    let row = word.text.parse().ok().filter(|row| (1..=rows).contains(row));
    row.map(|row: usize| row - 1).ok_or_else(|| {
        lines
            .error(word, &format!("\"{word}\" is not a row of the table, which has rows 1 to {rows}; {form}"))
    })
}
