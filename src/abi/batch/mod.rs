//! Many rays in one call, between arrays of any strides: a caller's request is checked and becomes `Strided` numbers
//! (`request`), which go straight to lanes where they lie side by side, and block by block where they do not (`answer`).

mod answer;
mod per_ray;
mod request;
mod strided;

pub(super) use per_ray::PerRay;
pub use request::realistic_camera_generate_batch;
