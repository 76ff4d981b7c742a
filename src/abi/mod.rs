//! The C ABI. This module contains all exported functions and is the only one that takes raw pointers.
//!
//! # Safety
//! The header's conventions (`include/cbindgen.toml`) state once what every caller promises: each pointer is
//! NULL or valid, arrays have room for the requested elements and do not overlap, and no object is used after
//! it is freed.
//!
//! `types` defines the structures by layout. `boundary` keeps panics from reaching the host and shields the
//! work from the host's traps and rounding mode; it also maps errors to statuses and checks for memory before
//! anything is built. `exchange` copies data to and from a caller's memory, and `views` checks its arrays.
//! `object` makes, recognises and serves the cameras that a host holds. `library`, `options`, `camera`, `ray`,
//! `batch`, `importance`, `autofocus` and `lens` export the functions for C callers. `pbrt` is the entry point
//! of a pbrt-v1 host (only if `pbrt-shim/` is built).

#![allow(clippy::missing_safety_doc, reason = "the safety of all exports is stated above, once")]

mod autofocus;
mod batch;
mod boundary;
mod camera;
mod exchange;
mod importance;
mod lens;
mod library;
mod object;
mod options;
#[cfg(realistic_shim)]
mod pbrt;
mod ray;
mod types;
mod views;

pub use autofocus::*;
pub use batch::realistic_camera_generate_batch;
pub use boundary::realistic_status;
pub use camera::*;
pub use importance::*;
pub use lens::*;
pub use library::*;
pub use options::*;
#[cfg(realistic_shim)]
pub use pbrt::CreateCamera;
pub use ray::{GenerateRay, realistic_generate_ray, realistic_generate_ray_differential};
pub use types::*;
