//! `[aspherical data]`: id, radius, conic constant, A4, A6, …; `[constants]` can say that A2 or odd terms stand among
//! them.

use super::sections::Sections;
use crate::{
    message::{cut, short},
    prescription::{
        asphere::{Asphere, FIRST_POWER, LAST_POWER},
        error::LensFileError,
        reader::{
            surfaces::SurfaceRow,
            text::{Text, no_number},
        },
    },
};

/// Gives the surfaces their figures.
///
/// # Errors
/// A line of another lens, twice, or that has no numbers; a constant that this reader does not know how to take.
pub(super) fn apply(
    text: &Text<'_>,
    sections: &Sections<'_>,
    rows: &mut [SurfaceRow],
    remarks: &mut Vec<String>,
) -> Result<(), LensFileError> {
    let powers = powers(text, sections, remarks)?;
    for row in &sections.aspheres {
        let id = row.cell(0);
        let Some(surface) = sections.lens.iter().position(|surface| surface.cell(0).text == id.text) else {
            let message = format!("no surface of [lens data] has the id \"{}\"", cut(id.text));
            return Err(text.error(id.place, message));
        };
        if rows[surface].asphere.is_some() {
            return Err(
                text.error(id.place, format!("the figure of surface {} is given twice", cut(id.text)))
            );
        }
        let mut numbers = Vec::new();
        for cell in row.values().iter().skip(1) {
            // What is left out is 0.
            let number = if cell.text.is_empty() { Some(0.0) } else { cell.number() };
            numbers.push(
                number.ok_or_else(|| {
                    text.error(cell.place, no_number(cell.text, "a constant of an asphere"))
                })?,
            );
        }
        let (conic, coefficients) = numbers.split_first().map_or((0.0, &[][..]), |(k, rest)| (*k, rest));
        let mut terms = [0.0; LAST_POWER - FIRST_POWER + 1];
        for (i, coefficient) in coefficients.iter().enumerate() {
            match powers.get(i) {
                Some(power) => terms[power - FIRST_POWER] = *coefficient,
                None if *coefficient == 0.0 => {}
                None => {
                    let message = format!("a term beyond A{LAST_POWER}, which is the last that is read");
                    return Err(text.error(row.cell(i + 3).place, message));
                }
            }
        }
        let stated = row.cell(1).number().filter(|radius| *radius != 0.0);
        let own = rows[surface].radius;
        if let Some(stated) =
            stated.filter(|stated| own.is_finite() && (stated - own).abs() > 1e-3 * own.abs())
        {
            let message =
                format!("radius {} mm, and {} mm in [lens data], which is used", short(stated), short(own));
            remarks.push(text.error(row.cell(1).place, message).to_string());
        }
        rows[surface].asphere = Some(Asphere { radius: own, conic, terms });
    }
    Ok(())
}

/// The powers of r that the coefficients belong to, in their order: even ones from 4; with `AsphericalA2` from 2; with
/// `AsphericalOddCount n` the first n odd ones from 3 among them.
fn powers(
    text: &Text<'_>,
    sections: &Sections<'_>,
    remarks: &mut Vec<String>,
) -> Result<Vec<usize>, LensFileError> {
    let (mut first, mut odd) = (4, 0);
    for row in &sections.constants {
        let key = row.cell(0);
        let is = |name: &str| {
            key.text.split_whitespace().next().is_some_and(|word| word.eq_ignore_ascii_case(name))
        };
        if is("AsphericalA2") {
            first = 2;
        } else if is("AsphericalOddCount") {
            let count = row.cell(1);
            let message = || format!("\"{}\" is not a number of odd terms, 0 to 9", cut(count.text));
            let number = count.text.parse().ok().filter(|count| *count <= 9);
            odd = number.ok_or_else(|| text.error(count.place, message()))?;
        } else if is("ObjectGlass") {
            return Err(text.error(key.place, "a lens with its object in glass; its front must stand in air"));
        } else if !is("Scaled") {
            // The numbers of a scaled lens are scaled already.
            let message = format!("the constant \"{}\" is not known and not used", cut(key.text));
            remarks.push(text.error(key.place, message).to_string());
        }
    }
    let is_read = |power: &usize| {
        power.is_multiple_of(2) && *power >= first || (power - 1) / 2 <= odd && power % 2 == 1
    };
    Ok((2..=LAST_POWER).filter(is_read).filter(|power| *power != 1).collect())
}
