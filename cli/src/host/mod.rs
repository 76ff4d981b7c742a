//! The host in Rust: the parts of a renderer around a camera from a shared library.

pub mod plugin;
pub mod render;
pub mod scene;
pub mod studio;
