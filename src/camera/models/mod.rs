//! The camera models: the real lens, the thick and thin one, and cameras like those that pbrt has in stock.
//!
//! To add a model: its file here; its variant and name in `camera/model.rs`; its parameters in
//! `camera/parameters/table.rs`, where every row says which models use it; and its camera in `camera/any_camera.rs`,
//! whose matches on the model the compiler then finds. What every model hands out is one
//! `pipeline::ray_maker::RayMaker`, which makes one ray, four or many.

pub(crate) mod environment;
pub(crate) mod ideal;
pub(crate) mod lens;
mod lens_parts;
pub(crate) mod projective;
pub mod spaces;
pub(crate) mod stock_cameras;
