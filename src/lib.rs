//! A real camera for renderers: rays traced from the film through every surface of a real lens.
//!
#![cfg_attr(
    doc,
    doc = concat!(
        "<div class=\"lens\"><style>.lens svg { max-width: 720px; width: 100%; height: auto }</style>\n",
        include_str!("../docs/images/draw-dgauss.svg"),
        "</div>"
    )
)]
//!
//! *The lens `dgauss.50mm`, drawn by `realistic draw`.* The method is that of C. Kolb, D. Mitchell and P. Hanrahan, [A
//! Realistic Camera Model for Computer Graphics](https://doi.org/10.1145/218380.218463), SIGGRAPH 1995.
//!
//! Four types lead into the crate.
//!
//! | type | is | comes from |
//! |---|---|---|
//! | [`Camera`] | a lens with a film and a pose; immutable and thread-safe | [`Camera::builder`] |
//! | [`Sample`] | a point of the picture, a lens sample (u, v) and a time | the caller |
//! | [`Prescription`] | the table of a lens: radii, distances, glasses, diameters | [`read`], [`find_lens`] |
//! | [`Lens`] | a prescription at one wavelength and stop, with [`FirstOrder`] optics | [`Lens::at_own_wavelength`] |
//!
//! # A ray
//!
//! ```
//! use realistic::{Camera, Sample};
//!
//! let camera = Camera::builder().lens_file("dgauss.50mm").focus_distance(2000.0).resolution(640, 480).build()?;
//! let sample = Sample { image_x: 320.5, image_y: 240.5, lens_u: 0.5, lens_v: 0.5, time: 0.0 };
//! if let Some((ray, weight)) = camera.ray(&sample) {
//!     assert!(ray.direction[2] > 0.99 && weight > 0.0);
//! }
//! # Ok::<(), realistic::CameraError>(())
//! ```
//!
//! The mean of weight times radiance over lens samples is the irradiance on the film. A ray that the lens blocks is `None` and
//! counts as 0.
//!
//! | to get | call |
//! |---|---|
//! | many rays | [`Camera::trace`] of [`Samples`] to [`Rays`] |
//! | rays at wavelengths, one or several per sample | the same of [`Samples::at`] wavelengths |
//! | rays with those of the neighbouring pixels | the same to [`Rays::with_neighbours`]; one by [`Camera::ray_differential`] |
//! | the reason where a ray is blocked | [`Camera::generate`] |
//!
//! # A lens
//!
//! ```
//! use realistic::{FirstOrder, Lens, find_lens};
//!
//! let lens = Lens::at_own_wavelength(&find_lens("tessar.50mm").expect("in the catalogue"));
//! assert!((FirstOrder::of(&lens)?.focal_length - 50.0).abs() < 0.01);
//! # Ok::<(), realistic::LensError>(())
//! ```
//!
//! [`lens_names`] lists the catalogue.
//!
//! # Space
//!
//! Lens space: origin at the vertex of the first surface, +z toward the scene, +x image right, +y image up, millimetres. Camera
//! space has the same origin and axes, in units of `mm_per_unit` millimetres; world units are as long unless the camera transform scales.
//!
//! # Other languages
//!
//! The C ABI is in `include/realistic.h`, and `include/realistic.hpp` wraps it for C++. The crates
//! below this one may change in any version; only this crate's face is promised.

// The crates below are cut by role, in the order in which data flows: `base`, `simd`, `optics`, `trace`, `light`, `camera`.
// This one is their common face, the C ABI and the entry of a pbrt-v1 host, the only exports.
mod abi;

pub use ::realistic_camera::plan::Plan;
pub use ::realistic_camera::sampling::DiskMapping;
pub use ::realistic_camera::{
    AdjointCamera, Aimed, Camera, CameraBuilder, CameraError, CameraMotion, CameraToWorld, Crop, Facts, Film,
    FocusBy, Host, Importance, ImportanceError, Interval, Kind, LensPlane, Level, Log, Model, Moving,
    Outcome, PARAMETERS, Parameter, ParameterError, Parameters, Precision, Pupil, Range, Raster,
    RayDifferential, Rays, Sample, Samples, ScenePoint, Shutter, TransformError, Transmission, UnknownName,
    Value, Weighting, WorldRay, Zoom,
};
pub use realistic_base::numeric::Real;
pub use realistic_optics::imaging::{
    axial_beam::AxialBeam,
    focus::{Conjugates, Focus, FocusError},
    moving::MovingError,
    open::OpenError,
};
pub use realistic_optics::lens::{
    Bounds, Figure, Lens, LensError, Ray, Surface,
    first_order::FirstOrder,
    pupil::{EntrancePupil, ExitPupil},
    refraction::Refraction,
};
pub use realistic_optics::prescription::{
    Asphere, Blades, Coating, Glass, GlassLibrary, Interface, Layer, LensFileError, Medium, Position,
    Positions, Prescription, SearchPath, Shape, SourceError, Stated, SurfaceCoating,
    catalogue::{find as find_lens, names as lens_names},
    glass::{Formula, InternalTransmittance},
    read, read_with,
};
pub use realistic_optics::trace::{Blocked, Direction, Path, Walk};

/// The C ABI for tests and fuzzers, which call it from Rust. Hosts use `include/realistic.h`; no promise is made of this
/// module.
#[doc(hidden)]
pub mod ffi {
    pub use crate::abi::*;
}
