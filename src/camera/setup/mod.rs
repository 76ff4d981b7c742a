//! From parameters and host to what a model is built from, checked: each parameter is read here, once.
//!
//! `common` is what every model has, `prescribed` the set-up of the models with a lens file, with the film put in its
//! place by `focusing`, and `projections` builds the textbook cameras.

mod common;
mod focusing;
mod prescribed;
mod projections;

pub(crate) use common::shutter;
pub(crate) use focusing::Focusing;
pub(crate) use prescribed::Setup;
pub use prescribed::{film_distance, open_lens};
pub(crate) use projections::{environment, orthographic, perspective};
