//! The scenes: shapes, materials and light computed by formula, and the placement of objects. `chequers` is a single
//! formula for the report, which times cameras.

mod card;
pub mod chequers;
pub mod chess;
pub mod effects;
pub mod night;
mod noise;
mod objects;
mod pose;
mod print;
pub mod props;
pub mod shapes;
pub mod sky;
pub mod slides;
pub mod solids;
mod world;

pub use objects::{Ball, Board, FLOOR, Finish, Lamps, Material, Paint, Pane};
pub use pose::{LEVEL, tilted};
pub use shapes::Sphere;
pub use sky::Sun;
pub use world::{Light, Scene};
