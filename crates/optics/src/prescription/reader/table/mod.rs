//! The project's own table. [`lines`] splits the text into lines of words. [`glasses`], [`statements`], [`apertures`],
//! [`general`], [`coatings`] and [`columns`] read the lines that begin with a keyword, and [`rows`] reads the other lines.
//! `docs/lens-format.md` has the grammar.
//!
//! There are two kinds of table. **Four columns**, as in the assignment and in pbrt: every row has radius, thickness,
//! refractive index and clear diameter. **Five columns**, as in Smith's *Modern Lens Design*: a row of glass has
//! radius, thickness, n_d, V-number and clear diameter; a row of air has radius, thickness and diameter; the row of
//! the stop has thickness and diameter, perhaps after the word `stop`; and `-` stands for a missing value. A file is
//! of the second kind if any row has five values. pbrt reads numbers without regard to lines, four for each row, so a
//! table of four columns may be a list on one line or with one number on each line. In all kinds the last column has
//! radii instead of diameters if a comment labels it as radii.

mod apertures;
mod coatings;
mod columns;
mod general;
mod glasses;
mod lines;
mod rows;
mod statements;

use super::{
    ledger::Ledger,
    surface_rows::{self, SurfaceRow},
    text::Cell,
};
use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES,
    glass::GlassLibrary,
    interfaces::{Medium, Prescription},
};
use columns::TableColumns;
use general::GeneralLines;
use glasses::Glasses;
use lines::{Line, Lines};
use realistic_base::message::nearest;

/// Reads a table from decoded bytes; `file` is the name of the file in messages.
///
/// # Errors
/// The text is not a lens; the error gives the first location at which it is malformed.
pub(super) fn read(
    file: &str,
    bytes: &[u8],
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let mut lines = Lines::split(file, bytes)?;
    let glasses = Glasses::take(&mut lines, library)?;
    let aspheres = statements::aspheres(&mut lines)?;
    let stop = statements::stop(&mut lines)?;
    let blades = statements::blades(&mut lines)?;
    let apertures = apertures::take(&mut lines)?;
    let coatings = coatings::take(&mut lines)?;
    let general = GeneralLines::take(&mut lines)?;
    let in_front = statements::medium(&mut lines, &glasses, ledger)?;
    let wavelength = statements::wavelength(&mut lines)?;
    let columns = TableColumns::take(&mut lines)?;
    flat_list(&mut lines);
    misspelt_keyword(&lines)?;
    heading(&lines)?;
    let (mut stated_focal_length, table) = leading_focal_length(&lines)?;
    let Some(last) = table.last() else {
        return Err(lines.error_at_end("the file has no rows; expected at least one interface"));
    };
    lines.at_most(table, MAX_INTERFACES, &format!("a lens has at most {MAX_INTERFACES} interfaces"))?;
    let mut rows = if table.iter().any(|line| line.len() == 5) {
        table.iter().map(|line| rows::of_five(&lines, &glasses, line, std::ptr::eq(line, last))).collect()
    } else {
        table.iter().map(|line| rows::of_four(&lines, &glasses, line)).collect::<Result<Vec<_>, _>>()
    }?;
    thicknesses_in_front(&lines, table, &rows)?;
    if let Some((location, message)) = lines.radius_column_remark() {
        ledger.warn(Fate::Replaced, location, "heading", None, message);
        rows.iter_mut().for_each(|row| row.diameter *= 2.0);
    }
    statements::give_aspheres(&lines, &aspheres, &mut rows)?;
    apertures::give(&lines, apertures, &mut rows)?;
    let film_break = general.give(&lines, &mut rows)?;
    statements::make_stop(&lines, stop.as_ref(), &mut rows)?;
    let (mut positions, stated) = columns.read(&lines, &rows, &mut stated_focal_length)?;
    let at = |row: usize, message: &str| lines.error(&table[row][0], message);
    let mut interfaces = surface_rows::interfaces(&rows, in_front.medium, &at, ledger)?;
    surface_rows::positions_in_order(in_front.medium, &interfaces, positions.as_mut(), &at)?;
    let coatings = coatings::of_surfaces(&lines, &coatings, in_front.medium, &interfaces)?;
    let back = std::mem::take(&mut interfaces.last_mut().expect("at least one row").thickness).abs();
    let mut lens = Prescription {
        title: lines.title.clone(),
        object_medium: in_front.medium,
        object_glass: in_front.glass,
        nominal_film_distance: (back > 0.0).then_some(back),
        film_break,
        stated_focal_length,
        stated,
        glasses: glasses.used(&lines)?,
        positions,
        coatings,
        wavelength: wavelength.as_ref().map(|(_, wavelength)| *wavelength),
        ..Prescription::new(interfaces)
    };
    if let Some((keyword, blades)) = blades {
        if lens.stop_in_air().is_none() {
            return Err(lines.error(&keyword, "blades stand in a stop in air, and the table has none"));
        }
        lens.set_blades(Some(blades));
    }
    if let Some((word, wavelength)) = &wavelength {
        lens.check_wavelength(*wavelength).map_err(|why| lines.error(word, &why))?;
    }
    // Every line of a table that was read has been used. Commas also separate words.
    ledger.use_open(|_, word| {
        let word = word.split(',').next().unwrap_or(word);
        Some(if word.starts_with(|c: char| c.is_ascii_alphabetic()) { word } else { "row" })
    });
    Ok(lens)
}

/// Divides a list of numbers into rows of four, if the lines are no rows: all numbers are on one line, or each has a
/// line. The indices and the diameters must be possible, so that a list of other columns is not taken for one of four.
fn flat_list(lines: &mut Lines<'_>) {
    let words = lines.lines.concat();
    let is_list = lines.lines.len() == 1 || lines.lines.len() == words.len();
    let rows = words.chunks(4);
    let is_row = |row: &[Cell<'_>]| match row.iter().filter_map(Cell::number).collect::<Vec<_>>()[..] {
        [_, _, index, diameter] => (index == 0.0 || (1.0..=4.0).contains(&index)) && diameter > 0.0,
        _ => false,
    };
    if is_list && words.len() > 4 && !lines.has_decimal_comma() && rows.clone().all(is_row) {
        lines.lines = rows.map(<[Cell<'_>]>::to_vec).collect();
    }
}

/// Checks that the thicknesses are those behind the surfaces. Some tables state those in front. In such a table the
/// glass of the first row, and no other, has thickness 0, and the last row has the thickness of the last glass.
fn thicknesses_in_front(
    lines: &Lines<'_>,
    table: &[Line<'_>],
    rows: &[SurfaceRow],
) -> Result<(), LensFileError> {
    let is_glass = |row: &SurfaceRow| row.behind.medium != Medium::Air;
    let [first, inner @ .., before, last] = rows else { return Ok(()) };
    let others = || inner.iter().chain([before, last]);
    let is_sign = is_glass(first)
        && first.thickness == 0.0
        && is_glass(before)
        && last.thickness > 0.0
        && others().count() > 2
        && others().all(|row| !is_glass(row) || row.thickness > 0.0);
    if !is_sign {
        return Ok(());
    }
    Err(lines.error(
        &table[0][1],
        "the first glass has thickness 0 and no other has, as where thicknesses are those in front of the surfaces; a \
         thickness is that behind: write each in the row before its own (or 1e-9 for a glass that thin)",
    ))
}

/// Splits off the first line if it has only a focal length. Returns that length and the remaining lines of the table.
fn leading_focal_length<'a, 't>(
    lines: &'a Lines<'t>,
) -> Result<(Option<f64>, &'a [Line<'t>]), LensFileError> {
    match lines.lines.split_first() {
        Some((first, rest)) if first.len() == 1 => {
            let word = &first[0];
            let length = lines.number(word, "a focal length in mm on a line of its own")?;
            if length <= 0.0 {
                return Err(lines.error(word, "a focal length on a line of its own must be positive"));
            }
            Ok((Some(length), rest))
        }
        _ => Ok((None, &lines.lines)),
    }
}

/// Checks that the first line is not a heading that lacks the comment mark.
fn heading(lines: &Lines<'_>) -> Result<(), LensFileError> {
    let is_word = |word: &Cell<'_>| {
        word.text.starts_with(|c: char| c.is_ascii_alphabetic())
            && word.text.chars().all(|c| c.is_ascii_alphabetic() || matches!(c, '_' | '-' | '/'))
    };
    match lines.lines.first().map(Vec::as_slice) {
        Some(words @ [first, _, _, ..]) if words.iter().all(is_word) => {
            Err(lines.error(first, "a line of words and no numbers; a heading begins with #"))
        }
        _ => Ok(()),
    }
}

/// Checks that no line begins with a misspelt keyword.
fn misspelt_keyword(lines: &Lines<'_>) -> Result<(), LensFileError> {
    let keywords = || {
        [
            "glass",
            "absorption",
            "aperture",
            "asphere",
            "biconic",
            "blades",
            "break",
            "coating",
            "medium",
            "mirror",
            "obstruction",
            "toroid",
            "wavelength",
        ]
        .into_iter()
        .chain(columns::KEYWORDS)
    };
    for line in &lines.lines {
        let word = &line[0];
        let is_own = ["stop", "flare", "inf", "infinity", "nan"].iter().any(|own| word.is(own));
        if !is_own
            && word.text.starts_with(|first: char| first.is_ascii_alphabetic())
            && let Some(keyword) = nearest(word.text, keywords())
        {
            return Err(lines.error(word, &format!("no line begins with \"{word}\"; \"{keyword}\"?")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
