//! Cameras: film, weights, transforms, and the rays of a host's samples.
//!
//! A [`Camera`] is built once, by [`Camera::builder`] or from [`Parameters`] that a host gives by name and a [`Host`],
//! and is immutable from then on. It turns a [`Sample`] into a ray in world space with its weight. Its model is one of
//! [`Model`].

mod any_camera;
pub mod autofocus;
pub(crate) mod builder;
pub(crate) mod columns;
pub(crate) mod host;
pub(crate) mod importance;
pub(crate) mod model;
pub(crate) mod models;
pub(crate) mod parameters;
pub(crate) mod pipeline;
pub(crate) mod placement;
pub(crate) mod rays;
pub(crate) mod setup;

pub use crate::plan::Precision;
pub(crate) use crate::sampling::film;
pub use any_camera::Camera;
pub use builder::CameraBuilder;
pub use film::{Film, Raster};
pub use host::{Host, Level, Log};
pub(crate) use importance::block as importance_block;
pub use importance::{AdjointCamera, Aimed, Importance, ImportanceError, ScenePoint};
pub use model::Model;
pub use parameters::{
    CameraError, FocusBy, Interval, Kind, LensPlane, PARAMETERS, Parameter, ParameterError, Parameters,
    Pupil, Range, Transmission, UnknownName, Value, Weighting, Zoom,
};
pub use placement::{
    motion::{CameraMotion, Moving},
    shutter::Shutter,
    transform::{CameraToWorld, TransformError},
};
pub use rays::{Outcome, RayDifferential, Rays, Sample, Samples, WorldRay};
pub use setup::{Crop, Facts, blades, coatings, film_distance, group_reach, open_lens};
