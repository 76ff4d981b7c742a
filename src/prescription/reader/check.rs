//! What must hold for the rows of either format, and what they are once their neighbours are known.

use super::{Interface, Medium, RawInterface, Row, Rows, Shape};
use crate::prescription::LensFileError;

/// `rows` and `raw` run in step, scene side first.
pub(super) fn check(
    all: &Rows,
    rows: &[Row],
    raw: Vec<RawInterface>,
) -> Result<Vec<Interface>, LensFileError> {
    let mut in_front = Medium::Air;
    let mut stop_line = None;
    let mut interfaces = Vec::with_capacity(raw.len());
    for (row, raw) in rows.iter().zip(raw) {
        let place = &row.words[0];
        let in_air = in_front == Medium::Air && raw.medium == Medium::Air;
        if raw.thickness < 0.0 {
            return Err(all.error(
                place,
                &format!("thickness {} mm: vertices stand in order, so it is 0 or more", raw.thickness),
            ));
        }
        let semi_diameter = raw.diameter / 2.0;
        // The half of the smallest number is 0.
        if semi_diameter <= 0.0 {
            return Err(
                all.error(place, &format!("clear diameter {} mm: expected a positive number", raw.diameter))
            );
        }
        let shape = if raw.radius.is_finite() {
            if semi_diameter > raw.radius.abs() {
                return Err(all.error(
                    place,
                    &format!(
                        "clear diameter {} mm on a sphere of radius {} mm: it can be at most {} mm",
                        raw.diameter,
                        raw.radius,
                        2.0 * raw.radius.abs()
                    ),
                ));
            }
            Shape::Sphere { radius: raw.radius }
        } else if in_air {
            if let Some(line) = stop_line {
                return Err(all.error(
                    place,
                    &format!(
                        "a second stop (the first is on line {line}); a plane between air and air is \
                         the stop, and a lens has at most one"
                    ),
                ));
            }
            stop_line = Some(place.line);
            Shape::Stop
        } else if raw.says_stop {
            return Err(all.error(
                place,
                "the stop has air on both sides; a plane of glass is written with radius inf",
            ));
        } else {
            Shape::Plane
        };
        interfaces.push(Interface { shape, thickness: raw.thickness, medium: raw.medium, semi_diameter });
        in_front = raw.medium;
    }
    if in_front != Medium::Air {
        let last = rows.last().expect("at least one row");
        return Err(all.error(
            &last.words[0],
            "the last interface has glass behind it; the film is in air, so its index must be 0 or 1",
        ));
    }
    Ok(interfaces)
}
