//! Where the film stands: at the distance that is given, or where it focuses a plane.

use super::{
    CameraError, ParameterError, Parameters,
    parameters::check::{out_of_range, positive},
};
use crate::{
    imaging::focus::{Focus, FocusError},
    lens::{Lens, LensError, first_order::FirstOrder},
};

/// Which optics puts the film where the lens is to be focused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Focusing {
    /// Exact rays.
    Exact,
    /// First-order optics.
    Paraxial,
}

/// Film distance and distance in focus, both mm.
pub(crate) fn place_film(
    given: &Parameters,
    lens: &Lens,
    mm_per_unit: f64,
    focusing: Focusing,
) -> Result<(f64, Option<f64>), CameraError> {
    let focus = Focus::new(lens);
    let able = |focus: Result<Focus, FocusError>| {
        focus.map_err(|error| match (focusing, &error) {
            // The thick lens and the thin one have a focal length or are nothing.
            (Focusing::Paraxial, FocusError::Lens(LensError::Afocal { .. })) => error.into(),
            _ => CameraError::NoFilmDistance(error),
        })
    };
    let film_for = |focus: Focus, distance: f64| match focusing {
        Focusing::Exact => focus.film_distance(distance),
        Focusing::Paraxial => paraxial_film_distance(lens, &focus, distance),
    };
    let fixed = match (given.filmdistance, given.focusdistance) {
        (Some(_), Some(_)) => {
            return Err(ParameterError::Both { first: "filmdistance", second: "focusdistance" }.into());
        }
        (None, Some(distance)) => {
            if !(distance > 0.0) {
                return Err(out_of_range("focusdistance", distance, "positive, in world units"));
            }
            let distance = distance * mm_per_unit;
            return Ok((film_for(able(focus)?, distance)?, Some(distance)));
        }
        (Some(distance), None) => {
            positive("filmdistance", distance, "mm")?;
            Some(distance)
        }
        (None, None) => lens.nominal_film_distance,
    };
    match (fixed, focusing) {
        // A lens that cannot focus still takes pictures with its film where the caller puts it.
        (Some(distance), Focusing::Exact) => {
            Ok((distance, focus.ok().and_then(|focus| focus.object_distance(distance))))
        }
        (Some(distance), Focusing::Paraxial) => {
            Ok((distance, FirstOrder::of(lens)?.object_distance(distance)))
        }
        (None, _) => Ok((film_for(able(focus)?, f64::INFINITY)?, Some(f64::INFINITY))),
    }
}

fn paraxial_film_distance(lens: &Lens, focus: &Focus, distance: f64) -> Result<f64, FocusError> {
    if let Some(film_distance) = focus.paraxial_film_distance(distance) {
        return Ok(film_distance);
    }
    // Object and image are nearest to each other at magnification 1.
    let first_order = FirstOrder::of(lens)?;
    let film_distance = first_order.back_focal_distance() + first_order.focal_length;
    let object = first_order.front_focal_point + first_order.focal_length;
    let nearest = object - first_order.rear_vertex + film_distance;
    Err(FocusError::TooNear { lens: lens.name.clone(), distance, nearest, film_distance })
}
