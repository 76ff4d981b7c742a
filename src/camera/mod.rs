//! Cameras: film, disk sampling, weights, transforms, and what a host gets a ray from.
//!
//! A [`Camera`] is built once from [`Parameters`], a [`Raster`] and a camera-to-world transform, is
//! immutable from then on, and turns a [`Sample`] into a ray in world space with its weight. It is one of
//! the models of [`Model`]; [`spaces`] has the coordinate spaces and [`measurement`] the equation that a pixel
//! is an estimate of.

pub mod autofocus;
mod batch;
mod block;
mod check;
mod choices;
mod disk;
pub mod disk_statistics;
mod drawing;
mod environment;
mod error;
mod few;
mod film;
mod focusing;
mod host;
mod ideal;
pub mod irradiance;
mod lens_setup;
pub mod measurement;
mod model;
mod motion;
pub mod outline;
mod parameters;
mod pipeline;
mod placement;
mod planning;
mod projective;
mod pupil_disk;
pub mod ray_set;
mod realistic;
mod setup;
mod shortened;
mod shutter;
pub mod spaces;
mod textbook;
mod tracer;
mod transform;
mod warped;

pub use block::{BLOCK, RayArrays, RayBlock, SampleArrays, SampleBlock};
pub use disk::DiskMapping;
pub use environment::EnvironmentCamera;
pub use error::CameraError;
pub use few::Three;
pub use film::{Film, Raster};
pub use host::{Host, Level};
pub use ideal::IdealCamera;
pub use lens_setup::{LensSetup, open_lens};
pub use model::{Camera, Model};
pub use motion::{CameraMotion, Moving};
pub use parameters::{Kind, PARAMETERS, Parameter, ParameterError, Parameters, Value};
pub use projective::{LensPlane, ProjectiveCamera};
pub use pupil_disk::{Drawn, PupilDisk};
pub use realistic::{Outcome, RealisticCamera, Sample, WorldRay};
pub use shutter::{DEFAULT_INTERVAL, Shutter};
pub use transform::CameraToWorld;
pub use warped::{BuildReport, WarpedPupil};
