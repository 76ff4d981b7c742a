//! The parameters of a camera, after which pbrt's `ParamSet`, the C options, the command line and the builder are made.
//!
//! In come values by name ([`Parameters::set`], which reads text) or by field; out go typed values, checked against
//! the one table that also says each one's unit, range, default, models and help. What takes two or more parameters
//! to decide is the set-up's.

mod error;
mod named;
mod range;
mod table;
mod units;
mod value;
mod zoom;

pub use error::{CameraError, ParameterError, UnknownName};
pub use named::{FocusBy, LensPlane, Pupil, Transmission, Weighting};
pub use range::{Interval, Range};
pub(crate) use table::{AskedPrecision, for_each_parameter};
pub use table::{PARAMETERS, Parameter, Parameters};
pub use units::Units;
pub(crate) use value::Written;
pub use value::{Kind, Value};
pub use zoom::Zoom;
