//! Every scene that is rendered: shapes, materials and light by formula, and what stands where; `chequers` alone is
//! one formula, for the report, which times cameras.

mod card;
pub mod chequers;
pub mod effects;
mod objects;
mod pose;
mod print;
pub mod props;
pub mod shapes;
pub mod sky;
pub mod slides;
mod world;

pub use objects::{Finish, Material};
pub use pose::LEVEL;
pub use world::Scene;
