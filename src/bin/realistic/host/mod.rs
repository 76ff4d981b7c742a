//! The Rust host: what a renderer needs around a camera that comes from a shared library.

pub mod camera;
pub mod card;
pub mod focus;
pub mod image;
pub mod options;
pub mod plugin;
pub mod props;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod shade;
pub mod shapes;
pub mod sky;
