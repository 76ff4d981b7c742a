//! A lens compiled for a wavelength per lane: the kernel's steps with the media of each ray's own wavelength.
//!
//! `media` is what a step asks of them; `glass` evaluates the formula of one in lanes; `table` has the lens's steps with
//! the medium behind each, and takes rays through.

mod glass;
mod media;
mod table;

pub use media::{Media, MediaOnWay, Own};
pub use table::SpectralKernel;
