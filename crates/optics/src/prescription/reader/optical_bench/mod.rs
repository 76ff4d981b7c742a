//! Optical Bench text, the usual format for photographic lenses from patents. The text has tab-separated cells in
//! sections (`[lens data]`, `[variable distances]`, `[aspherical data]`, …), lengths in mm, and clear *diameters*.
//!
//! `sections` splits the text and reads the variables, which have one column for each position of the lens. This module
//! reads the surfaces and their figures. `[aspherical data]` has id, radius, conic constant, A4, A6, …; `[constants]`
//! can add A2 or odd terms. An index of -1 makes a row a mirror.
//!
//! The format is that of the program *Optical Bench* by W. J. Claff (photonstophotos.net).

mod sections;

use super::{
    ledger::Ledger,
    named_glass::NamedGlasses,
    reflections::{self, MIRROR_INDEX},
    surface_rows::{self, General, MediumBehind, Role, SurfaceRow},
    text::{Cell, Text},
};
use crate::prescription::{
    Fate, LensFileError,
    glass::GlassLibrary,
    interfaces::{Asphere, FIRST_POWER, LAST_POWER, Medium, NO_TERMS, Prescription},
};
use realistic_base::message::short;
use sections::{BenchRow, Sections};

/// Reads a lens from a text.
///
/// # Errors
/// The text is not a lens; the error gives the first location at which it is malformed.
pub(super) fn read(
    text: &Text<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let sections = Sections::of(text, ledger)?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let mut rows = Vec::with_capacity(sections.lens.len());
    let mut gaps = Vec::new();
    for row in &sections.lens {
        let (gap, surface) = surface(text, row, &mut glasses)?;
        rows.push(surface);
        gaps.push(gap);
    }
    apply_figures(text, &sections, &mut rows, ledger)?;
    if rows.is_empty() {
        return Err(
            text.error(sections.end, "the section [lens data] has no rows; expected at least one surface")
        );
    }
    let stop = sections.lens.iter().position(|row| role(&row.cell(1)) == Role::Stop);
    let (mut positions, stated_focal_length, stated) =
        sections.resolve(text, &mut rows, &gaps, stop, ledger)?;
    let air = MediumBehind::from(Medium::Air);
    let moving = positions.as_ref().map_or(Vec::new(), |positions| positions.gaps.clone());
    let origins = reflections::join(&mut rows, air, |row| moving.contains(&row));
    if let Some(positions) = &mut positions {
        let number = |row: usize| origins.iter().position(|own| own.gap == row);
        positions.gaps = moving.into_iter().filter_map(number).collect();
    }
    let location = |row: usize| sections.lens[origins[row].row].location;
    for (row, reason) in reflections::obstructions(&mut rows, air) {
        ledger.warn(Fate::Replaced, location(row), "row", None, reason);
    }
    let at = |row: usize, message: &str| text.error(location(row), message);
    let mut interfaces = surface_rows::interfaces(&rows, Medium::Air, &at, ledger)?;
    surface_rows::film_in_air(&interfaces, &at)?;
    surface_rows::positions_in_order(Medium::Air, &interfaces, positions.as_mut(), &at)?;
    let last = interfaces.len() - 1;
    let back = std::mem::take(&mut interfaces[last].thickness).abs();
    let (glasses, remarks) = glasses.glasses_and_warnings(text.file);
    for (rows, name) in
        [(&sections.lens, "row"), (&sections.aspheres, "figure"), (&sections.constants, "constant")]
    {
        ledger.use_open(|line, _| rows.iter().any(|row| row.location.line == line).then_some(name));
    }
    Ok(Prescription {
        title: sections.title.clone(),
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length,
        stated,
        glasses,
        positions,
        remarks,
        ..Prescription::new(interfaces)
    })
}

/// Reads a row of `[lens data]`: id, radius, thickness, n_d, clear diameter, V, glass. The thickness may be the name of
/// a variable. Its cell is therefore returned separately, and the surface has a thickness of 0.
fn surface<'t>(
    text: &Text<'_>,
    row: &BenchRow<'t>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<(Cell<'t>, SurfaceRow), LensFileError> {
    let [radius, thickness, n_d, diameter, abbe, glass] = [1, 2, 3, 4, 5, 6].map(|cell| row.cell(cell));
    if row.is_one_cell() {
        return Err(text.error(row.location, "no tabs in this line; its cells are separated by tabs"));
    }
    let role = role(&radius);
    let is_mirror = n_d.number() == Some(MIRROR_INDEX);
    let surface = SurfaceRow {
        radius: match radius.text {
            _ if role != Role::Any => f64::INFINITY,
            "CG" | "cg" => f64::INFINITY,
            _ if radius.is_infinite() => f64::INFINITY,
            _ => match text
                .number(&radius, "a radius in mm, Infinity, AS (stop), FS (flare stop) or CG (cover glass)")?
            {
                0.0 => f64::INFINITY,
                radius => radius,
            },
        },
        role,
        thickness: 0.0,
        behind: if n_d.text.is_empty() || is_mirror {
            Medium::Air.into()
        } else {
            let index = text.number(&n_d, "a refractive index, or nothing for air")?;
            let abbe_number =
                if abbe.text.is_empty() { None } else { Some(text.number(&abbe, "a V-number")?) };
            let index = surface_rows::index(index)
                .map_err(|why| text.error(n_d.location, format!("{why}; leave it out for air")))?;
            if abbe_number.is_some_and(|abbe| abbe <= 0.0) {
                return Err(
                    text.error(abbe.location, "a V-number is positive; leave it out where it is not known")
                );
            }
            match index {
                Some(index) => glasses.checked(name(glass.text), index, abbe_number),
                None => Medium::Air.into(),
            }
        },
        diameter: text.number(&diameter, "a clear diameter in mm")?,
        asphere: None,
        apertures: Vec::new(),
        general: General { is_mirror, ..General::default() },
    };
    Ok((thickness, surface))
}

fn role(radius: &Cell<'_>) -> Role {
    match radius.text.to_ascii_uppercase().as_str() {
        "AS" => Role::Stop,
        "FS" => Role::FlareStop,
        _ => Role::Any,
    }
}

/// Returns the name of a glass without additions by collectors, such as a remark, or a question mark that expresses
/// doubt.
fn name(cell: &str) -> &str {
    cell.split_whitespace().next().unwrap_or("").trim_end_matches('?')
}

#[cfg(test)]
mod tests;

/// Assigns the aspheric figures to the surfaces.
///
/// # Errors
/// A figure belongs to an unknown surface, or is the second figure of a surface; a cell is not a number; a term is
/// beyond the last power; or a constant cannot be honoured. Unknown constants only cause a warning.
fn apply_figures(
    text: &Text<'_>,
    sections: &Sections<'_>,
    rows: &mut [SurfaceRow],
    ledger: &mut Ledger<'_>,
) -> Result<(), LensFileError> {
    let powers = powers(text, sections, ledger)?;
    for row in &sections.aspheres {
        let id = row.cell(0);
        let Some(surface) = sections.lens.iter().position(|surface| surface.cell(0).text == id.text) else {
            let message = format!("no surface of [lens data] has the id \"{id}\"");
            return Err(text.error(id.location, message));
        };
        if rows[surface].asphere.is_some() {
            return Err(text.error(id.location, format!("the figure of surface {id} is given twice")));
        }
        let mut numbers = Vec::new();
        for cell in row.values().iter().skip(1) {
            // An empty cell means 0.
            let is_empty = cell.text.is_empty();
            numbers.push(if is_empty { 0.0 } else { text.number(cell, "a constant of an asphere")? });
        }
        let (conic, coefficients) = numbers.split_first().map_or((0.0, &[][..]), |(k, rest)| (*k, rest));
        let mut terms = NO_TERMS;
        for (i, coefficient) in coefficients.iter().enumerate() {
            match powers.get(i) {
                Some(power) => terms[power - FIRST_POWER] = *coefficient,
                None if *coefficient == 0.0 => {}
                None => {
                    let message = format!("a term beyond A{LAST_POWER}, which is the last that is read");
                    return Err(text.error(row.cell(i + 3).location, message));
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
            ledger.warn(Fate::Replaced, row.cell(1).location, "figure", None, message);
        }
        rows[surface].asphere = Some(Asphere { radius: own, conic, terms });
    }
    Ok(())
}

/// Returns the powers of r that the coefficients belong to, in order. These are the even powers from 4 on, or from 2 on
/// with `AsphericalA2`. `AsphericalOddCount n` adds the first n odd powers from 3 on.
fn powers(
    text: &Text<'_>,
    sections: &Sections<'_>,
    ledger: &mut Ledger<'_>,
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
            let message = || format!("\"{count}\" is not a number of odd terms, 0 to 9");
            let number = count.text.parse().ok().filter(|count| *count <= 9);
            odd = number.ok_or_else(|| text.error(count.location, message()))?;
        } else if is("ObjectGlass") {
            return Err(
                text.error(key.location, "a lens with its object in glass; its front must stand in air")
            );
        } else if !is("Scaled") {
            // The numbers in a file for a scaled lens are already scaled.
            let message = format!("the constant \"{key}\" is not known and not used");
            ledger.warn(Fate::LeftOut, key.location, "constant", None, message);
        }
    }
    let is_read = |power: &usize| {
        power.is_multiple_of(2) && *power >= first || (power - 1) / 2 <= odd && power % 2 == 1
    };
    Ok((2..=LAST_POWER).filter(is_read).filter(|power| *power != 1).collect())
}
