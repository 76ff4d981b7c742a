//! Cameras: film, weights, transforms, and what a host gets a ray from.
//!
//! A [`Camera`] is built once from [`Parameters`], a [`Raster`] and a camera-to-world transform, is
//! immutable from then on, and turns a [`Sample`] into a ray in world space with its weight. It is one of
//! the models of [`Model`].

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
pub(crate) mod planning;
pub(crate) mod setup;

pub use film::{Film, Raster};
pub use host::{Host, Level};
pub use lens_setup::{LensSetup, open_lens};
pub use model::{Camera, Model};
pub use models::{
    environment::EnvironmentCamera,
    ideal::IdealCamera,
    lens::{Outcome, RealisticCamera, Sample, WorldRay},
    projective::{LensPlane, ProjectiveCamera},
};
pub use parameters::{CameraError, Kind, PARAMETERS, Parameter, ParameterError, Parameters, Value};
pub use pipeline::{
    block::{BLOCK, RayArrays, RayBlock, SampleArrays, SampleBlock},
    few::Three,
};
pub use placement::{
    motion::{CameraMotion, Moving},
    shutter::{DEFAULT_INTERVAL, Shutter},
    transform::CameraToWorld,
};
