//! A lens in the formats of other programs: distortion models, maps, illumination and spots.
//!
//! [`field`] samples the exact chief rays along one radius of the film, which suffices because the lens is symmetric
//! about its axis. A [`law`] is the shape of a radial model with its coefficients, and [`fit`] finds them by least
//! squares; a [`model`] is a law under the name that other programs use. [`report`] compares a model with the exact
//! rays, [`text`] writes it in a program's own format, and [`map`] writes values per pixel. [`plane`] has the chief rays of
//! a lens that is not round, of which there are maps alone. Distances on the film are
//! in pixels from its centre, lengths in mm, angles in radians.

mod field;
mod fit;
mod illumination;
mod law;
mod map;
mod model;
mod plane;
mod report;
mod spot;
mod table;
mod text;

pub use field::{ChiefField, FieldError, Film};
pub use illumination::Illumination;
pub use law::Quantity;
pub use map::{Map, rays, st_maps};
pub use model::{Fitted, Model};
pub use plane::PlaneField;
pub use report::{Errors, Focus, Report};
pub use spot::{Spot, spots};
pub use text::{LensData, LensExposure, ftheta_usda, opencv_yaml, opentrackio_json, usda};
