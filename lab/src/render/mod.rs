//! The renderer that the program and the laboratory share: samples of a picture in, their [`Rays`] asked of a camera,
//! what an [`Integrand`] makes of them summed up by pixel out.

mod renderer;
pub mod sequence;

pub use renderer::*;
