//! The positions of a lens whose groups move, one per line, with the values that the table states and the values
//! computed at that position.

use realistic_base::message::{as_given, fixed};
use realistic_optics::imaging::{
    moving::MovingGroups,
    open::{OpenLens, StopSize, set_up},
};
use realistic_optics::prescription::{Position, Prescription};
use realistic_trace::field::Field;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A position, and the computed values of the lens at that position.
pub struct PositionLine<'a> {
    stated: &'a Position,
    focal_length: Option<f64>,
    f_number: Option<f64>,
    film_distance: Option<f64>,
    /// Full field of the film's diagonal, from the chief ray of the corner, radians.
    field: Option<f64>,
}

/// Returns every position in the order of the table, at a wavelength in nm and a stop, with the field of a film of
/// this `diagonal` in mm. Empty for a lens without positions.
pub fn all(
    prescription: &Prescription,
    wavelength: f64,
    stop: StopSize,
    diagonal: f64,
) -> Vec<PositionLine<'_>> {
    let (Some(groups), Some(positions)) = (MovingGroups::of(prescription), &prescription.positions) else {
        return Vec::new();
    };
    let zooms = positions.layout().zooms;
    positions
        .columns
        .iter()
        .enumerate()
        .filter_map(|(column, stated)| {
            let placed = groups.position(column % zooms).at(stated.vergence());
            // Warnings about the stop were already printed.
            let OpenLens { lens, first_order, beam } =
                set_up(&placed, wavelength, stop, &mut |_, _| ()).ok()?;
            let optics = first_order.ok();
            let film_distance =
                lens.nominal_film_distance.or(optics.map(|optics| optics.image_distance(stated.vergence())));
            let film_distance = film_distance.filter(|distance| distance.is_finite() && *distance > 0.0);
            Some(PositionLine {
                stated,
                focal_length: optics.map(|optics| optics.focal_length),
                f_number: optics.map(|optics| beam.fnumber(optics.focal_length)),
                film_distance,
                field: film_distance
                    .and_then(|distance| Field::new(&lens, lens.rear().vertex - distance).real(diagonal)),
            })
        })
        .collect()
}

/// Formats the positions as JSON.
pub fn json(lines: &[PositionLine<'_>]) -> Value {
    lines
        .iter()
        .map(|line| {
            json!({
                "name": line.stated.name,
                "focal_length_mm": line.focal_length,
                "stated_focal_length_mm": line.stated.focal_length,
                "fnumber": line.f_number,
                "stated_fnumber": line.stated.fnumber,
                "object_distance_from_first_vertex_mm": line.stated.object_distance,
                "film_distance": line.film_distance,
                "field_of_view_deg": line.field.map(f64::to_degrees),
                "gaps_mm": line.stated.gaps,
            })
        })
        .collect()
}

/// Formats the positions as text; empty for a lens without positions.
pub fn text(lines: &[PositionLine<'_>]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let number =
        |value: Option<f64>, digits| value.map_or_else(|| "-".to_owned(), |value| fixed(value, digits));
    let stated = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), as_given);
    let mut text = format!(
        "\n{:<16} {:>12} {:>8} {:>9} {:>8} {:>12} {:>10} {:>8}\n",
        "position", "focal length", "stated", "f-number", "stated", "object", "film", "field"
    );
    for line in lines {
        let _ = writeln!(
            text,
            "{:<16} {:>12} {:>8} {:>9} {:>8} {:>12} {:>10} {:>8}",
            line.stated.name.as_deref().unwrap_or("-"),
            number(line.focal_length, 4),
            stated(line.stated.focal_length),
            number(line.f_number, 3),
            stated(line.stated.fnumber),
            line.stated.object_distance.map_or_else(|| "infinity".to_owned(), |distance| fixed(distance, 2)),
            number(line.film_distance, 4),
            number(line.field.map(f64::to_degrees), 3),
        );
    }
    text + "lengths in mm, the object's from the first vertex; field in degrees, across the film's diagonal\n"
}
