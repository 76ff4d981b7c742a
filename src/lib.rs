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
//! Four types are the starting points of the crate.
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
//! The mean of weight times radiance over lens samples is the irradiance on the film. For a ray that the lens
//! blocks the result is `None`, and the sample counts as 0.
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
//! In lens space, the origin is the vertex of the first surface, +z points toward the scene, +x to the
//! image's right, +y to the image's top, and lengths are in millimetres. Camera space has the same origin and
//! axes, in units of `mm_per_unit` millimetres; world units are equally long unless the camera transform
//! scales.
//!
//! # Other languages
//!
//! The C ABI is in `include/realistic.h`, and `include/realistic.hpp` wraps it for C++. The crates on which
//! this one depends may change in any version; only the public interface of this crate is stable.

// The crates on which this one depends are divided by role, in the order in which data flows: `base`, `simd`,
// `optics`, `trace`, `light`, `camera`. This crate is their common interface and contains the only exports:
// the C ABI and the entry point of a pbrt-v1 host.
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
    Aperture, Asphere, Blades, Coating, Glass, GlassLibrary, Interface, Layer, LensFileError, Medium,
    Outline, Position, Positions, Prescription, SearchPath, Shape, SourceError, Stated, SurfaceCoating,
    catalogue::{find as find_lens, names as lens_names},
    glass::{Formula, InternalTransmittance},
    read, read_with,
};
pub use realistic_optics::trace::{Blocked, Direction, Path, Walk};

/// The C ABI for tests and fuzzers, which call it from Rust. Hosts use `include/realistic.h`; this module may
/// change in any version.
#[doc(hidden)]
pub mod ffi {
    pub use crate::abi::*;
}
