//! Many rays in one call, between arrays of any strides.
//!
//! A caller's request is checked and becomes numbers at strides (`request`, `strided`). These go straight to lanes where all
//! lie side by side, and in blocks of 128 rays where they do not (`answer`). The page of
//! `camera/pipeline` follows 1,000 rays from here through a lens and back.

mod answer;
mod request;
mod strided;

pub(super) use answer::PerRay;
pub use request::realistic_camera_generate_batch;
