//! The line `blades COUNT rotation=… curvature=…`: the figure that an iris leaves open in the stop.

use super::lines::{Lines, Word};
use crate::prescription::{LensFileError, blades::Blades};

const FORM: &str = "blades are: blades COUNT rotation=DEGREES curvature=C (3 to 32; 0 where left out; C from 0, straight, to 1, \
     the circle's)";
const NAMES: [&str; 2] = ["rotation", "curvature"];

/// Takes the line of the blades out of the others.
pub(super) fn take(lines: &mut Lines) -> Result<Option<(Word, Blades)>, LensFileError> {
    let taken = lines.take(&["blades"]);
    let [line, more @ ..] = taken.as_slice() else { return Ok(None) };
    if let [second, ..] = more {
        return Err(lines.error(&second.words[0], "a second line \"blades\"; a lens has one"));
    }
    let [keyword, count, words @ ..] = line.words.as_slice() else {
        return Err(lines.error(&line.words[0], FORM));
    };
    let number = count.text.parse().ok().filter(|number| Blades::COUNTS.contains(number));
    let number = number
        .ok_or_else(|| lines.error(count, &format!("\"{count}\" is not a number of blades; {FORM}")))?;
    let mut constants = [None; NAMES.len()];
    for word in words {
        let names = NAMES.map(str::to_owned);
        let (place, constant) = lines.constant(word, &names, &format!("rotation=15; {FORM}"))?;
        if constants[place].replace(constant).is_some() {
            return Err(lines.error(word, &format!("\"{word}\": given twice; {FORM}")));
        }
    }
    let [rotation, curvature] = constants.map(|constant| constant.unwrap_or(0.0));
    if !(0.0..=1.0).contains(&curvature) {
        return Err(lines.error(keyword, &format!("the blades' curvature is {curvature}; {FORM}")));
    }
    Ok(Some((keyword.clone(), Blades { count: number, rotation, curvature })))
}
