//! The coatings of a lens's surfaces: one for all by the parameter, or those of the lens file; and whether what they reflect is
//! followed.

use crate::{
    camera::parameters::{CameraError, Parameters, Transmission},
    prescription::{Prescription, SurfaceCoating},
};

/// The coatings of a lens's surfaces, from the scene on; `None` where nothing is lost at them.
///
/// # Errors
/// Those of the lens file are asked for, and it names none.
pub fn coatings(
    transmission: Transmission,
    prescription: &Prescription,
) -> Result<Option<Vec<SurfaceCoating>>, CameraError> {
    if transmission == Transmission::File {
        let own = prescription.coatings.clone();
        let error = || CameraError::NoCoatings { lens: prescription.name.clone() };
        return own.ok_or_else(error).map(Some);
    }
    let all = |coating| vec![SurfaceCoating::from(coating); prescription.interfaces.len()];
    Ok(transmission.of_all().map(all))
}

/// The share of the samples that go along paths with two reflections.
///
/// # Errors
/// A number out of range, or surfaces that reflect nothing.
pub(super) fn ghosts(given: &Parameters) -> Result<f64, CameraError> {
    let share = given.ghosts()?;
    if share > 0.0 && given.transmission() == Transmission::None {
        return Err(CameraError::NothingReflects { share });
    }
    Ok(share)
}
