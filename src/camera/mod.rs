//! Cameras: film, weights, transforms, and what a host gets a ray from.
//!
//! A [`Camera`] is built once from [`Parameters`], a [`Raster`] and a camera-to-world transform, is
//! immutable from then on, and turns a [`Sample`] into a ray in world space with its weight. It is one of
//! the models of [`Model`].

mod any_camera;
pub mod autofocus;
pub(crate) mod film;
pub(crate) mod focusing;
pub(crate) mod host;
pub(crate) mod lens_setup;
pub(crate) mod model;
pub mod models;
pub(crate) mod parameters;
pub(crate) mod pipeline;
pub(crate) mod placement;
pub(crate) mod ray;
pub(crate) mod setup;

pub use any_camera::Camera;
pub use film::{Film, Raster};
pub use host::{Host, Level};
pub use lens_setup::{LensSetup, open_lens};
pub use model::Model;
pub use models::{
    environment::EnvironmentCamera,
    ideal::IdealCamera,
    lens::RealisticCamera,
    projective::{LensPlane, ProjectiveCamera},
};
pub use parameters::{CameraError, Kind, PARAMETERS, Parameter, ParameterError, Parameters, Value};
pub(crate) use pipeline::arrays::BLOCK;
pub use pipeline::arrays::{RayArrays, RayBlock, SampleArrays, SampleBlock};
pub use placement::{
    motion::{CameraMotion, Moving},
    shutter::{DEFAULT_INTERVAL, Shutter},
    transform::CameraToWorld,
};
pub use ray::{Outcome, Sample, WorldRay};
