//! The parameters of a camera, as in pbrt's `ParamSet`, the C options, the command line and the builder.
//!
//! Values come in by name ([`Parameters::set`], which also reads text) or by field. They are returned with
//! their types and checked against the table that also holds each parameter's unit, range, default, models
//! and help. Decisions that depend on two or more parameters are left to the set-up.

mod error;
mod exposure;
mod named;
mod range;
mod table;
mod units;
mod value;
mod zoom;

pub use error::{CameraError, ParameterError, UnknownName};
pub use exposure::Exposure;
pub use named::{FocusBy, LensPlane, Pupil, Transmission, Weighting};
pub use range::{Interval, Range};
pub(crate) use table::RequestedPrecision;
pub use table::{PARAMETERS, Parameter, Parameters};
pub(crate) use units::Units;
pub use value::Written;
pub use value::{Kind, Value};
pub use zoom::Zoom;
