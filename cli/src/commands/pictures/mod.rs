//! The commands that take pictures: a picture or a tile of it, a stack of pictures, and the whole picture joined from
//! tiles.

pub mod focus_stack;
pub mod merge;
mod origin;
pub mod render;
