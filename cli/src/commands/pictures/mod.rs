//! The commands that take pictures: one, and a stack of them.

pub mod focus_stack;
pub mod render;
