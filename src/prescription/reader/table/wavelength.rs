//! The line `wavelength NM`: the wavelength that the lens is for, at which it is traced unless the user says otherwise.

use super::lines::{Lines, Word};
use crate::prescription::{LensFileError, glass::VALID_WAVELENGTHS};

/// Takes the line of the wavelength out of the others.
pub(super) fn take(lines: &mut Lines) -> Result<Option<(Word, f64)>, LensFileError> {
    let taken = lines.take(&["wavelength"]);
    let [line, more @ ..] = taken.as_slice() else { return Ok(None) };
    if let [second, ..] = more {
        return Err(lines.error(&second.words[0], "a second line \"wavelength\"; a lens has one"));
    }
    let (first, last) = (VALID_WAVELENGTHS.start(), VALID_WAVELENGTHS.end());
    let form = format!("a wavelength is: wavelength NM, from {first} to {last}");
    let [_, word] = line.words.as_slice() else {
        return Err(lines.error(&line.words[0], &form));
    };
    let number = lines.number(word, "a wavelength in nm")?;
    if VALID_WAVELENGTHS.contains(&number) {
        Ok(Some((word.clone(), number)))
    } else {
        Err(lines.error(word, &format!("the wavelength is {word} nm; {form}")))
    }
}
