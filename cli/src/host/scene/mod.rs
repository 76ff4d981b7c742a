//! The scenes that the program renders: shapes, materials and light by formula, and what stands where.

mod card;
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
