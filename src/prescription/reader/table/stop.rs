//! The line `stop ROW`: that this row's surface, which may be of glass, is the stop.

use super::{
    aspheres::row,
    lines::{Lines, Word},
};
use crate::prescription::{
    LensFileError,
    reader::surfaces::{Role, SurfaceRow},
};

const FORM: &str = "a stop on a surface is: stop ROW";

/// Takes the line out of the others; a row that is a stop by itself has a thickness and a diameter, too.
pub(super) fn take(lines: &mut Lines) -> Result<Option<Word>, LensFileError> {
    let taken = lines.take_where(|line| line.words.len() == 2 && line.words[0].is("stop"));
    let [line, more @ ..] = taken.as_slice() else { return Ok(None) };
    if let [second, ..] = more {
        return Err(lines.error(&second.words[0], "a second line \"stop ROW\"; a lens has one stop"));
    }
    Ok(Some(line.words[1].clone()))
}

/// Makes the row that the word names the stop.
pub(super) fn apply(
    lines: &Lines,
    word: Option<&Word>,
    rows: &mut [SurfaceRow],
) -> Result<(), LensFileError> {
    if let Some(word) = word {
        let row = row(lines, word, rows.len(), FORM)?;
        rows[row].role = Role::Stop;
    }
    Ok(())
}
