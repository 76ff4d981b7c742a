//! The lens at one wavelength and stop: surfaces with indices, refraction, and first-order (thick lens) data with
//! the pupils. The module is independent of tracing.
//!
//! All coordinates are in lens space: origin at the front vertex, +z toward the scene, millimetres.

mod figure;
pub mod first_order;
pub mod pupil;
mod ray;
pub mod refraction;
pub mod single_precision;
mod surfaces;
mod unsymmetric;

pub use figure::{Bounds, Figure};
pub use ray::{Ray, cos4, film_ray};
pub use surfaces::{Crossing, Lens, LensError, Surface};
pub use unsymmetric::{RegionBounds, UnsymmetricFigure};
