//! From parameters and host to what a model is built from, checked: each parameter is read here, once.
//!
//! `common` is what every model has, `prescribed` the set-up of the models with a lens file, with the film put in its
//! place by `focusing` and the lens's groups in theirs by `groups`, of which `facts` is what a user may ask. What only the projections have is read in `models::stock_cameras`.
//! `first_look` looks through the camera once it is built.

mod common;
mod facts;
mod first_look;
mod focusing;
mod groups;
mod prescribed;
mod shared;

pub use common::Crop;
pub(crate) use common::{disk_mapping, placement, raster, shutter, warn_of_unused};
pub use facts::Facts;
pub(crate) use first_look::warn_of_darkness;
pub(crate) use focusing::Focusing;
pub(crate) use prescribed::Setup;
pub use prescribed::{blades, coatings, film_distance, group_reach, open_lens};
pub(crate) use shared::SharedLens;
