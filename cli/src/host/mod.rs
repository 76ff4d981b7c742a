//! The Rust host: what a renderer needs around a camera that comes from a shared library.

pub mod autofocus;
pub mod camera;
pub mod card;
pub mod effects;
pub mod focus;
pub mod image;
pub mod lettering;
pub mod options;
pub mod plugin;
pub mod props;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod shade;
pub mod shapes;
pub mod sheet;
pub mod sky;
pub mod slides;
pub mod spectrum;
pub mod studio;
