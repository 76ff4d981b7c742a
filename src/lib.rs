//! A real camera for renderers.
#![deny(missing_docs)]
pub mod abi;
pub mod camera;
mod numeric;
pub mod optics;
pub mod prescription;
pub mod trace;
