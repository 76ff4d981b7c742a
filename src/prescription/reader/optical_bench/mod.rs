//! Optical Bench text, as most photographic lenses from patents are passed on: tab-separated cells in sections
//! (`[lens data]`, `[variable distances]`, `[aspherical data]`, …), lengths in mm, clear *diameters*. Text in, a
//! prescription out.
//!
//! W. J. Claff, *Optical Bench* (photonstophotos.net), is the program that this text comes from.

mod aspheres;
mod sections;
mod variables;

use super::{
    named_glass::NamedGlasses,
    surfaces::{self, Role, SurfaceRow},
    text::{Cell, Text, no_number},
};
use crate::prescription::{
    error::LensFileError,
    glass::GlassLibrary,
    interfaces::{Medium, Prescription},
};
use sections::{Row, Sections};
use variables::Variables;

/// Reads a lens from decoded bytes; `file` is its name in messages.
///
/// # Errors
/// The first place at which the text is not a lens.
pub(super) fn read(file: &str, bytes: &[u8], library: &GlassLibrary) -> Result<Prescription, LensFileError> {
    let text = Text::new(file, bytes);
    let sections = Sections::of(&text)?;
    let variables = Variables::of(&text, &sections.variables)?;
    let mut glasses = NamedGlasses::new(library, Vec::new());
    let mut remarks = Vec::new();
    let mut rows = Vec::with_capacity(sections.lens.len());
    let mut gaps = Vec::new();
    for row in &sections.lens {
        let (gap, surface) = surface(&text, row, &mut glasses)?;
        rows.push(surface);
        gaps.push(gap);
    }
    aspheres::apply(&text, &sections, &mut rows, &mut remarks)?;
    let Some(last) = rows.len().checked_sub(1) else {
        return Err(
            text.error(sections.end, "the section [lens data] has no rows; expected at least one surface")
        );
    };
    let stop = sections.lens.iter().position(|row| role(&row.cell(1)) == Role::Stop);
    let moving = variables.resolve(&text, &mut rows, &gaps, stop)?;
    remarks.extend(moving.remarks);
    let at = |row: usize, message: &str| text.error(sections.lens[row].place, message);
    let (mut interfaces, wide) = surfaces::interfaces(&rows, &at)?;
    surfaces::positions_in_order(&interfaces, moving.positions.as_ref(), &at)?;
    remarks.extend(wide.iter().map(LensFileError::to_string));
    let back = std::mem::take(&mut interfaces[last].thickness);
    let (glasses, told) = glasses.told(file);
    remarks.extend(told);
    Ok(Prescription {
        title: sections.title.clone(),
        nominal_film_distance: (back > 0.0).then_some(back),
        stated_focal_length: moving.focal_length,
        stated: moving.stated,
        glasses,
        positions: moving.positions,
        remarks,
        ..Prescription::new(interfaces)
    })
}

/// A row of `[lens data]`: id, radius, thickness, n_d, clear diameter, V, glass. The thickness by itself, which may be the name
/// of a variable; the surface has 0.
fn surface<'t>(
    text: &Text<'_>,
    row: &Row<'t>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<(Cell<'t>, SurfaceRow), LensFileError> {
    let [radius, thickness, n_d, diameter, abbe, glass] = [1, 2, 3, 4, 5, 6].map(|cell| row.cell(cell));
    let number = |cell: &Cell<'_>, expected: &str| {
        cell.number().ok_or_else(|| text.error(cell.place, no_number(cell.text, expected)))
    };
    if row.is_one_cell() {
        return Err(text.error(row.place, "no tabs in this line; its cells are separated by tabs"));
    }
    let role = role(&radius);
    let surface = SurfaceRow {
        radius: match radius.text {
            _ if role != Role::Any => f64::INFINITY,
            "CG" | "cg" => f64::INFINITY,
            _ if radius.is_infinite() => f64::INFINITY,
            _ => match number(
                &radius,
                "a radius in mm, Infinity, AS (stop), FS (flare stop) or CG (cover glass)",
            )? {
                0.0 => f64::INFINITY,
                radius => radius,
            },
        },
        role,
        thickness: 0.0,
        medium: if n_d.text.is_empty() {
            Medium::Air
        } else {
            let index = number(&n_d, "a refractive index, or nothing for air")?;
            let abbe_number = if abbe.text.is_empty() { None } else { Some(number(&abbe, "a V-number")?) };
            let index = surfaces::index(index)
                .map_err(|why| text.error(n_d.place, format!("{why}; leave it out for air")))?;
            if abbe_number.is_some_and(|abbe| abbe <= 0.0) {
                return Err(
                    text.error(abbe.place, "a V-number is positive; leave it out where it is not known")
                );
            }
            index.map_or(Medium::Air, |index| glasses.checked(name(glass.text), index, abbe_number))
        },
        diameter: number(&diameter, "a clear diameter in mm")?,
        asphere: None,
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

/// A glass's name without what collectors add: a remark, a question mark for a doubt.
fn name(cell: &str) -> &str {
    cell.split_whitespace().next().unwrap_or("").trim_end_matches('?')
}

#[cfg(test)]
mod tests;
