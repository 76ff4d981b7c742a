//! Renders a picture from a scene and a source of camera rays.

mod adaptive;
mod dusk;
mod emitters;
mod irradiance_cache;
pub mod lamplight;
mod light;
#[cfg(test)]
mod linked;
mod renderer;
mod shade;
pub mod spectrum;

use clap::ValueEnum;

pub use adaptive::{AdaptiveSampling, REACH};
pub use dusk::Dusk;
pub use emitters::EmitterPicture;
pub use light::trace;
pub use renderer::{Settings, noise, render};

/// Start of light paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// From the camera, by its rays
    Path,
    /// From the lamps: for small bright lamps far out of focus
    Light,
}
