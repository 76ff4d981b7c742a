//! A real camera for renderers.
#![deny(missing_docs)]
pub mod abi;
pub mod camera;
