//! Cameras, which turn samples on film into weighted rays in the world, through a lens or as one of pbrt's
//! stock cameras.
//!
//! A camera is built once, from parameters by name and the data of a host, and never changes. To make a ray,
//! it maps a sample to the film and the pupil, traces through the lens, and applies the weight, the pose and
//! the shutter.
//!
//! | type | is |
//! |---|---|
//! | [`Parameters`], [`Host`] | settings by name; pixels, transform and search path |
//! | [`CameraBuilder`] | builder of parameters and host data, with a method for each setting |
//! | [`Model`] | the kind of camera |
//! | [`Plan`](plan::Plan) | the parts that a camera keeps and leaves out |
//! | [`Camera`] | the camera; immutable and thread-safe |
//! | [`Sample`], [`Samples`] | a point of the picture with a lens sample and a time; many |
//! | [`WarpedPupil`](sampling::WarpedPupil) | the map of lens samples onto the true pupil |
//! | [`WorldRay`], [`Rays`] | a ray in world space; many, with weights |
//! | [`AdjointCamera`], [`Importance`] | rays from the scene, and what they contribute |
//!
//! The crate depends on `base`, `simd`, `optics`, `trace` and `light`; the crate `realistic`, with the C ABI,
//! depends on it.
//!
//! ```
//! use realistic_camera::{Camera, CameraError, Sample};
//!
//! let camera = Camera::builder().lens_file("wide.22mm").focus_distance(2000.0).resolution(640, 480).build()?;
//! let sample = Sample { image_x: 320.5, image_y: 240.5, lens_u: 0.5, lens_v: 0.5, time: 0.0 };
//! let (ray, weight) = camera.ray(&sample).expect("it passes the lens");
//! assert!(ray.direction[2] > 0.99 && weight > 0.0);
//! # Ok::<(), CameraError>(())
//! ```
//!
//! Only the public interface of the crate `realistic` is stable; the interface of this crate may change in
//! any version.

#![deny(unsafe_code)]

mod any_camera;
pub mod autofocus;
mod builder;
#[allow(unsafe_code)]
pub mod columns;
mod host;
mod importance;
mod model;
mod models;
pub mod parameters;
mod pipeline;
mod placement;
pub mod plan;
#[allow(unsafe_code)]
pub mod rays;
#[allow(unsafe_code)]
mod samples;
pub mod sampling;
mod setup;
mod vectors;

pub use crate::plan::Precision;
pub use crate::sampling::{FilmSurface, film};
pub use any_camera::Camera;
pub use builder::CameraBuilder;
pub use film::{Film, Raster};
pub use host::{Host, Level, Log};
pub use importance::block as importance_block;
pub use importance::{AdjointCamera, Aimed, Importance, ImportanceError, ScenePoint};
pub use model::Model;
pub use parameters::{
    CameraError, Exposure, FocusBy, Interval, Kind, LensPlane, PARAMETERS, Parameter, ParameterError,
    Parameters, Pupil, Range, Transmission, UnknownName, Value, Weighting, Zoom,
};
pub use placement::{
    motion::{CameraMotion, Moving},
    shutter::Shutter,
    transform::{CameraToWorld, TransformError},
};
pub use rays::{Outcome, RayDifferential, Rays, WorldRay};
pub use samples::{Sample, Samples};
pub use setup::{
    Crop, Facts, blades, coatings, film_distance, film_surface, group_reach, open_lens, stop_picture,
};
