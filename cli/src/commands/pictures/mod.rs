//! The commands that take pictures: one or a tile of one, a stack of them, and the joining of tiles.

pub mod focus_stack;
pub mod merge;
mod origin;
pub mod render;
