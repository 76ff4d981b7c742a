//! The renderer shared by the program and the laboratory. It requests the [`Rays`] of a picture's samples from a
//! camera, evaluates an [`Integrand`] along them, and sums the results by pixel.

mod renderer;
pub mod sequence;

pub use renderer::*;
