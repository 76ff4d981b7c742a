//! The commands that take pictures: one picture or a tile of one, a stack of pictures, and joining
//! tiles.

pub mod focus_stack;
pub mod merge;
mod origin;
pub mod render;
