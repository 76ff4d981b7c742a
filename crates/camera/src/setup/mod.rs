//! Builds the checked set-up of a model from parameters and host: each parameter is read here, once.
//!
//! `common` holds the settings of every model, `prescribed` the set-up of the models with a lens file, with the film
//! placed by `focusing` and the lens's groups by `groups`; `facts` is the part that users may query. Settings of the
//! projections alone are read in `models::stock_cameras`. `darkness` tests the camera once it is built.

mod common;
mod darkness;
mod facts;
mod focusing;
mod groups;
mod prescribed;
mod shared;

pub use common::Crop;
pub(crate) use common::{disk_mapping, placement, raster, shutter, warn_of_unused};
pub(crate) use darkness::warn_of_darkness;
pub use facts::Facts;
pub(crate) use focusing::Focusing;
pub(crate) use prescribed::Setup;
pub use prescribed::{blades, coatings, film_distance, group_reach, open_lens};
pub(crate) use shared::SharedLens;
