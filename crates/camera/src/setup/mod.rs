//! Builds the checked set-up of a model from the parameters and the host's data; each parameter is read here,
//! once.
//!
//! `common` contains the settings of every model, and `prescribed` the set-up of the models with a lens file.
//! `focusing` places the film and `groups` the lens's groups. `facts` is the part that users may query.
//! Settings that only the projections have are read in `models::stock_cameras`. `darkness` tests a camera
//! after it has been built.

mod common;
mod darkness;
mod facts;
mod focusing;
mod groups;
mod prescribed;
mod shared;
mod stop_picture;

pub use common::Crop;
pub(crate) use common::{disk_mapping, placement, raster, shutter, warn_of_unused};
pub(crate) use darkness::warn_of_darkness;
pub use facts::Facts;
pub(crate) use focusing::Focusing;
pub(crate) use prescribed::Setup;
pub use prescribed::{blades, coatings, film_distance, film_surface, group_reach, open_lens};
pub(crate) use shared::SharedLens;
pub use stop_picture::stop_picture;
