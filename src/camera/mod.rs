//! Cameras.
pub mod parameters;
