//! Why a camera or its focus is refused: errors of the rooms below in, out a failure with the ABI's status.

use super::{Failure, realistic_status};
use crate::camera::{CameraError, ParameterError, autofocus::AutofocusError};
use crate::imaging::focus::FocusError;
use crate::lens::moving::MovingError;

impl From<CameraError> for Failure {
    fn from(error: CameraError) -> Self {
        let status = match &error {
            CameraError::Source(_) => realistic_status::LensFile,
            CameraError::Focus(FocusError::TooNear { .. })
            | CameraError::TooNear { .. }
            | CameraError::Moving(MovingError::Unreachable { .. }) => realistic_status::UnreachableFocus,
            CameraError::Parameter(_)
            | CameraError::Lens(_)
            | CameraError::Focus(_)
            | CameraError::Moving(_)
            | CameraError::FilmStays
            | CameraError::NoFilmDistance(_)
            | CameraError::FilmInLens { .. }
            | CameraError::PupilAtInfinity
            | CameraError::TooFar { .. }
            | CameraError::DarkAxis { .. }
            | CameraError::Weight { .. }
            | CameraError::NoBlades { .. }
            | CameraError::NoStopForBlades { .. }
            | CameraError::Transform(_)
            | CameraError::Raster { .. } => realistic_status::InvalidParameter,
        };
        Self::new(status, error.to_string())
    }
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        CameraError::from(error).into()
    }
}

impl From<AutofocusError> for Failure {
    fn from(error: AutofocusError) -> Self {
        let status = match error {
            AutofocusError::Camera(error) => return error.into(),
            AutofocusError::Nothing { .. } => realistic_status::UnreachableFocus,
            AutofocusError::NoZones { .. } | AutofocusError::Zone { .. } | AutofocusError::ByGroup => {
                realistic_status::InvalidParameter
            }
        };
        Self::new(status, error.to_string())
    }
}
