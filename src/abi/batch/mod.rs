//! Many rays in one call, between arrays of any strides.
//!
//! A caller's request is checked and converted to columns (`request`, `strided`), from which the camera generates rays.
//! The page of `camera/pipeline` follows them from there.

mod request;
mod strided;

pub(super) use request::PerRay;
pub use request::realistic_camera_generate_batch;
