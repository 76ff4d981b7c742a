//! Cameras: film, weights, transforms, and the rays of a host's samples.
//!
//! A [`Camera`] is built once, by [`Camera::builder`] or from [`Parameters`] that a host gives by name and a [`Host`],
//! and is immutable from then on. It turns a [`Sample`] into a ray in world space with its weight. Its model is one of
//! [`Model`].
//!
//! | to | look in |
//! |---|---|
//! | read parameters, and build a camera of them | [`parameters`], `setup`, `models`; `builder` for Rust |
//! | sample film and pupil | [`sampling`] |
//! | choose how rays are traced (`tolerance`), and what is left out | [`plan`] |
//! | make rays of samples | `any_camera` (the entry), `pipeline` (the loop and its formulas), [`rays`] and [`columns`] (callers' data) |
//! | place the camera in the world, and shut it | `placement` |
//! | trace light from the scene | `importance` |
//! | focus by the scene | [`autofocus`] |

mod any_camera;
pub mod autofocus;
mod builder;
pub mod columns;
mod host;
mod importance;
mod model;
mod models;
pub mod parameters;
mod pipeline;
mod placement;
pub mod plan;
pub mod rays;
pub mod sampling;
mod setup;

pub use crate::plan::Precision;
pub use crate::sampling::film;
pub use any_camera::Camera;
pub use builder::CameraBuilder;
pub use film::{Film, Raster};
pub use host::{Host, Level, Log};
pub use importance::block as importance_block;
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
