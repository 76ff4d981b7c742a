//! One surface as its row states it, whatever the format; and a column of them made into interfaces, with the checks
//! that need a row's neighbours.

use super::lines::{Line, Lines};
use crate::{
    message::as_given,
    prescription::{
        LensFileError,
        interfaces::{Interface, Medium, Shape},
    },
};

/// A row's values before it is known what lies on the interface's scene side.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceRow {
    /// Signed radius in mm; infinite for a plane.
    pub radius: f64,
    /// The row says in words that it is the stop.
    pub says_stop: bool,
    pub thickness: f64,
    pub medium: Medium,
    pub diameter: f64,
}

/// The interfaces of a lens from its rows, scene side first, and what of them is not as the file has it; `lines` says where each row stands, in the same order.
///
/// # Errors
/// The first row that cannot be an interface of a lens in air.
pub(super) fn interfaces(
    file: &Lines,
    lines: &[Line],
    rows: Vec<SurfaceRow>,
) -> Result<(Vec<Interface>, Vec<LensFileError>), LensFileError> {
    let mut in_front = Medium::Air;
    let mut stop_line = None;
    let mut remarks = Vec::new();
    let mut interfaces = Vec::with_capacity(rows.len());
    for (line, row) in lines.iter().zip(rows) {
        let place = &line.words[0];
        let in_air = in_front == Medium::Air && row.medium == Medium::Air;
        if row.thickness < 0.0 {
            return Err(file.error(
                place,
                &format!(
                    "thickness {} mm: vertices stand in order, so it is 0 or more",
                    as_given(row.thickness)
                ),
            ));
        }
        let mut semi_diameter = row.diameter / 2.0;
        // The half of the smallest number is 0.
        if semi_diameter <= 0.0 {
            return Err(file.error(
                place,
                &format!("clear diameter {} mm: expected a positive number", as_given(row.diameter)),
            ));
        }
        let shape = if row.radius.is_finite() {
            let widest = row.radius.abs();
            if semi_diameter > widest {
                // Prescriptions list the mount's diameter, too, which may be wider than the whole sphere.
                remarks.push(file.error(
                    place,
                    &format!(
                        "clear diameter {} mm on a sphere of radius {} mm; {} mm is used, the whole sphere",
                        as_given(row.diameter),
                        as_given(row.radius),
                        as_given(2.0 * widest)
                    ),
                ));
                semi_diameter = widest;
            }
            Shape::Sphere { radius: row.radius }
        } else if in_air {
            if let Some(first) = stop_line {
                return Err(file.error(
                    place,
                    &format!(
                        "a second stop (the first is on line {first}); a plane between air and air is \
                         the stop, and a lens has at most one"
                    ),
                ));
            }
            stop_line = Some(place.line);
            Shape::Stop
        } else if row.says_stop {
            return Err(file.error(
                place,
                "the stop has air on both sides; a plane of glass is written with radius inf",
            ));
        } else {
            Shape::Plane
        };
        interfaces.push(Interface { shape, thickness: row.thickness, medium: row.medium, semi_diameter });
        in_front = row.medium;
    }
    if in_front != Medium::Air {
        let last = lines.last().expect("at least one row");
        return Err(file.error(
            &last.words[0],
            "the last interface has glass behind it; the film is in air, so its index must be 0 or 1",
        ));
    }
    Ok((interfaces, remarks))
}
