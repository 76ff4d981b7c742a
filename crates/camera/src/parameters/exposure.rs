//! The exposure of a camera.

use super::{ParameterError, Parameters};

/// An exposure as OpenUSD's cameras define it (`UsdGeomCamera`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Sensitivity; 100 if it is not given.
    pub iso: f64,
    /// Exposure time, s; 1 if it is not given.
    pub time: f64,
    /// Compensation, stops; 0 if it is not given.
    pub stops: f64,
    /// Response to light; 1 if it is not given.
    pub responsivity: f64,
}

impl Exposure {
    /// The names of the parameters of an exposure.
    pub const PARAMETERS: [&'static str; 4] = ["iso", "exposure_time", "exposure", "responsivity"];

    /// Returns the name of the first parameter of an exposure that is given; `None` if none is.
    pub fn given(parameters: &Parameters) -> Option<&'static str> {
        parameters.given().map(|row| row.name).find(|name| Self::PARAMETERS.contains(name))
    }

    /// Reads the exposure; `None` if none of its parameters is given.
    ///
    /// # Errors
    /// A number is out of range.
    pub fn of(parameters: &Parameters) -> Result<Option<Self>, ParameterError> {
        if Self::given(parameters).is_none() {
            return Ok(None);
        }
        Ok(Some(Self {
            iso: parameters.iso()?.unwrap_or(100.0),
            time: parameters.exposure_time()?.unwrap_or(1.0),
            stops: parameters.exposure()?.unwrap_or(0.0),
            responsivity: parameters.responsivity()?.unwrap_or(1.0),
        }))
    }
}
