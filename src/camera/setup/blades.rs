//! The blades of the stop: as the parameters have them, or else the lens file.

use crate::{
    camera::parameters::{CameraError, ParameterError, Parameters},
    prescription::{Blades, Prescription},
};

/// The blades in the stop of a lens; `None` for a round one.
///
/// # Errors
/// A number of blades that there is not, an angle or a curvature without blades, or a lens without a stop.
pub fn blades(given: &Parameters, prescription: &Prescription) -> Result<Option<Blades>, CameraError> {
    let (rotation, curvature) = (given.bladerotation()?, given.bladecurvature()?);
    let count = match given.blades()? {
        None => prescription.blades.map_or(0, |blades| blades.count),
        Some(0.0) => 0,
        Some(number) => {
            let count = Blades::COUNTS.clone().find(|count| f64::from(*count) == number);
            let (from, to) = (Blades::COUNTS.start(), Blades::COUNTS.end());
            let range = format!("0 (a round stop) or a whole number from {from} to {to}");
            count.ok_or_else(|| ParameterError::out_of_range("blades", number, &range))?
        }
    };
    if count == 0 {
        let given = [("bladerotation", rotation), ("bladecurvature", curvature)];
        return match given.into_iter().find(|(_, value)| value.is_some()) {
            Some((name, _)) => Err(CameraError::NoBlades { name }),
            None => Ok(None),
        };
    }
    if prescription.stop_in_air().is_none() {
        return Err(CameraError::NoStopForBlades { lens: prescription.name.clone() });
    }
    let own = prescription.blades.unwrap_or(Blades { count, rotation: 0.0, curvature: 0.0 });
    Ok(Some(Blades {
        count,
        rotation: rotation.unwrap_or(own.rotation),
        curvature: curvature.unwrap_or(own.curvature),
    }))
}
