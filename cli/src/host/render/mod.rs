//! Renders a picture from a scene and a source of camera rays.

mod bulbs;
mod dusk;
mod gathered;
pub mod lamplight;
mod light;
#[cfg(test)]
mod linked;
mod renderer;
mod shade;
pub mod spectrum;
mod spread;

use clap::ValueEnum;

pub use bulbs::Bulbs;
pub use dusk::Dusk;
pub use light::trace;
pub use renderer::{Settings, noise, render};
pub use spread::{REACH, Spread};

/// Start of light paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// From the camera, by its rays
    Path,
    /// From the lamps: for small bright lamps far out of focus
    Light,
}
