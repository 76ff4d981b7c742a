//! The parameters of a camera, the checks of their values, and the errors that name them.

pub(crate) mod check;
pub(crate) mod choices;
pub(crate) mod error;
pub(crate) mod table;

pub use error::CameraError;
pub use table::{Kind, PARAMETERS, Parameter, ParameterError, Parameters, Value};
