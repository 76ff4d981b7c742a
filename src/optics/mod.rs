//! The lens as optics: surfaces with indices at one wavelength, refraction, first-order
//! (thick lens) data, pupils and focus.
//!
//! Focus, field of view and image scale are those of exact rays: they ask [`trace`](crate::trace), which is made from a
//! [`Lens`] and knows nothing of them.
//!
//! Lens space throughout: origin at the front vertex, +z toward the scene, millimetres.

pub mod depth_of_field;
pub mod field;
pub mod first_order;
pub mod focus;
pub mod image_scale;
mod lens;
pub mod pupil;
pub mod refraction;
pub mod single_precision;

pub use lens::{Lens, LensError, Surface};
