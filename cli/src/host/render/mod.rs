//! From a scene and a source of camera rays to a picture.

mod renderer;
mod shade;
pub mod spectrum;

pub use renderer::{Settings, render};
