//! The Rust host: what a renderer needs around a camera that comes from a shared library.

pub mod plugin;
pub mod render;
pub mod scene;
pub mod studio;
