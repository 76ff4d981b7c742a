//! One surface as its row states it, whatever the format; and a column of them made into interfaces, with the checks
//! that need a row's neighbours.

use crate::{
    message::as_given,
    prescription::{
        LensFileError,
        asphere::Asphere,
        interfaces::{Interface, Medium, Shape},
        limits::MAX_INTERFACES,
    },
};

/// What a row is when it is no refracting surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// Nothing said: a plane between air and air is the stop.
    Any,
    /// The row says that it is the stop.
    Stop,
    /// The row says that it is a flare stop: a plane in air that is not the aperture stop.
    FlareStop,
}

/// A row's values before it is known what lies on the interface's scene side.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceRow {
    /// Signed radius in mm; infinite for a plane.
    pub radius: f64,
    pub role: Role,
    pub thickness: f64,
    pub medium: Medium,
    pub diameter: f64,
    /// The figure, where the row has more of it than a radius; its radius is that of the row.
    pub asphere: Option<Asphere>,
}

/// Where a row stands: makes an error of the row's number, counted from 0, and what is wrong.
pub(super) type AtRow<'a> = &'a dyn Fn(usize, &str) -> LensFileError;

/// The interfaces of a lens from its rows, scene side first, and what of them is not as the file has it.
///
/// # Errors
/// The first row that cannot be an interface of a lens in air.
pub(super) fn interfaces(
    rows: &[SurfaceRow],
    at: AtRow<'_>,
) -> Result<(Vec<Interface>, Vec<LensFileError>), LensFileError> {
    let mut in_front = Medium::Air;
    let mut stop: Option<usize> = None;
    let mut remarks = Vec::new();
    let mut interfaces = Vec::with_capacity(rows.len());
    if rows.len() > MAX_INTERFACES {
        let message = format!(
            "row {} of {}; a lens has at most {MAX_INTERFACES} interfaces",
            MAX_INTERFACES + 1,
            rows.len()
        );
        return Err(at(MAX_INTERFACES, &message));
    }
    for (number, row) in rows.iter().enumerate() {
        let in_air = in_front == Medium::Air && row.medium == Medium::Air;
        if row.thickness < 0.0 {
            let thickness = as_given(row.thickness);
            let message = format!("thickness {thickness} mm: vertices stand in order, so it is 0 or more");
            return Err(at(number, &message));
        }
        let mut semi_diameter = row.diameter / 2.0;
        // The half of the smallest number is 0.
        if semi_diameter <= 0.0 {
            let diameter = as_given(row.diameter);
            return Err(at(number, &format!("clear diameter {diameter} mm: expected a positive number")));
        }
        let figure = row.asphere.filter(|asphere| !is_conic_alone(asphere) || asphere.conic != 0.0);
        let is_plane = row.radius.is_infinite() && figure.is_none_or(|figure| is_conic_alone(&figure));
        let shape = if !is_plane {
            let shape = match figure {
                Some(_) if row.role != Role::Any => {
                    return Err(at(
                        number,
                        "a stop is a plane in air; an asphere has a radius or inf in its row",
                    ));
                }
                Some(_) if in_air && row.radius.is_infinite() => {
                    return Err(at(number, "an asphere between air and air bends no ray; give it a glass"));
                }
                Some(asphere) => Shape::Asphere(Asphere { radius: row.radius, ..asphere }),
                None => Shape::Sphere { radius: row.radius },
            };
            let widest = shape.widest();
            if semi_diameter > widest {
                remarks.push(at(number, &too_wide(row, figure.map_or(0.0, |figure| figure.conic), widest)));
                semi_diameter = widest;
            }
            shape
        } else if in_air && row.role == Role::FlareStop {
            Shape::Plane
        } else if in_air {
            if let Some(first) = stop {
                let first = at(first, "").line;
                let message = format!(
                    "a second stop (the first is on line {first}); a plane between air and air is the stop, and a \
                     lens has at most one"
                );
                return Err(at(number, &message));
            }
            stop = Some(number);
            Shape::Stop
        } else if row.role != Role::Any {
            return Err(at(
                number,
                "the stop has air on both sides; a plane of glass is written with radius inf",
            ));
        } else {
            Shape::Plane
        };
        interfaces.push(Interface { shape, thickness: row.thickness, medium: row.medium, semi_diameter });
        in_front = row.medium;
    }
    if in_front != Medium::Air {
        let message =
            "the last interface has glass behind it; the film is in air, so its index must be 0 or 1";
        return Err(at(rows.len() - 1, message));
    }
    Ok((interfaces, remarks))
}

/// Whether a figure has no terms, so that it is a conic.
fn is_conic_alone(asphere: &Asphere) -> bool {
    asphere.terms.iter().all(|term| *term == 0.0)
}

/// That a mount's diameter, which prescriptions list, too, is wider than the whole surface.
fn too_wide(row: &SurfaceRow, conic: f64, widest: f64) -> String {
    let [diameter, radius, used] = [row.diameter, row.radius, 2.0 * widest].map(as_given);
    if conic == 0.0 {
        format!(
            "clear diameter {diameter} mm on a sphere of radius {radius} mm; {used} mm is used, the whole sphere"
        )
    } else {
        format!(
            "clear diameter {diameter} mm on a conic of radius {radius} mm and constant {}; {used} mm is used, the \
             whole conic",
            as_given(conic)
        )
    }
}
