//! Cameras: film, disk sampling, weights, transforms, and what a host gets a ray from.
//!
//! A camera is built once from [`Parameters`], a [`Raster`] and a camera-to-world matrix, is
//! immutable from then on, and turns a [`Sample`] into a ray in world space with its weight.

mod disk;
mod error;
mod film;
pub mod irradiance;
pub mod outline;
mod parameters;
mod pupil_disk;
pub mod ray_set;
mod realistic;
mod setup;
mod transform;

pub use disk::DiskMapping;
pub use error::CameraError;
pub use film::{Film, Raster};
pub use parameters::{Kind, PARAMETERS, Parameter, ParameterError, Parameters, Value};
pub use pupil_disk::PupilDisk;
pub use realistic::{Outcome, RealisticCamera, Sample, WorldRay};
pub use setup::{Host, LensSetup, Level, open_lens};
pub use transform::CameraToWorld;
