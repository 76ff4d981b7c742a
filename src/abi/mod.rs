//! The C ABI: the only exported functions, and the only place that takes raw pointers.
//!
//! The structures are here by layout. [`boundary`] keeps panics inside, [`object`] makes
//! and recognises the cameras that a caller holds, [`ray`] asks one for a ray, [`plugin`]
//! knows the file this was loaded from. `shim` speaks to the C++ face and `pbrt` is the
//! entry of a pbrt-v1 host; both are there only where `pbrt-shim/` is built.

pub mod boundary;
pub mod handle;
pub mod object;
#[cfg(realistic_shim)]
pub mod pbrt;
pub mod plugin;
pub mod ray;
#[cfg(realistic_shim)]
pub mod shim;
mod types;
pub use types::*;
