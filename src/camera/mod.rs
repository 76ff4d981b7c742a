//! Cameras: film, weights, transforms, and what a host gets a ray from.
//!
//! A [`Camera`] is built once, by [`Camera::builder`] or from [`Parameters`] that a host gives by name and a [`Host`],
//! is immutable from then on, and turns a [`Sample`] into a ray in world space with its weight. It is one of the
//! models of [`Model`].

pub mod autofocus;
pub(crate) mod builder;
pub(crate) mod film;
pub(crate) mod host;
pub(crate) mod model;
pub mod models;
pub(crate) mod parameters;
pub(crate) mod pipeline;
pub(crate) mod placement;
pub(crate) mod planning;
pub(crate) mod sample;
pub(crate) mod setup;

pub use builder::CameraBuilder;
pub use film::{Film, Raster};
pub use host::{Host, Level};
pub use model::Camera;
pub use models::{
    environment::EnvironmentCamera, ideal::IdealCamera, lens::RealisticCamera, projective::ProjectiveCamera,
};
pub use parameters::{
    CameraError, Interval, Kind, LensPlane, Model, PARAMETERS, Parameter, ParameterError, Parameters,
    Precision, Pupil, Range, UnknownName, Value, Weighting,
};
pub use pipeline::{
    block::{BLOCK, RayArrays, RayBlock, SampleArrays, SampleBlock},
    few::Three,
};
pub use placement::{
    motion::{CameraMotion, Moving},
    shutter::Shutter,
    transform::{CameraToWorld, TransformError},
};
pub use sample::{Outcome, Sample, WorldRay};
pub use setup::{film_distance, open_lens};
