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
//! let camera = Camera::builder().specfile("dgauss.50mm").focusdistance(2000.0).resolution(640, 480).build()?;
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
//! space has the same origin and axes, in units of `mmperunit` millimetres; world units are as long unless the camera transform scales.
//!
//! # Other languages
//!
//! The C ABI is in `include/realistic.h`, and `include/realistic.hpp` wraps it for C++. [`unstable`] is for this project's own
//! programs and tests; nothing of it is promised.

// The rooms, in the order in which data flows: warnings and errors for people; vectors, roots and quadrature; lens files to
// tables of interfaces and glasses, and the catalogue; a lens at one wavelength and stop; exact rays through it; what tracing
// tells about a lens; what surfaces do to light; where rays start; what a camera needs of all that; film, weights and transforms, a sample in and a ray
// out; and the C ABI with the entry of a pbrt-v1 host, the only exports.
mod abi;
mod camera;
mod imaging;
mod lens;
mod light;
mod message;
mod numeric;
mod plan;
mod prescription;
mod sampling;
mod trace;

pub use camera::{
    AdjointCamera, Aimed, Camera, CameraBuilder, CameraError, CameraMotion, CameraToWorld, Crop, Facts, Film,
    FocusBy, Host, Importance, ImportanceError, Interval, Kind, LensPlane, Level, Log, Model, Moving,
    Outcome, PARAMETERS, Parameter, ParameterError, Parameters, Precision, Pupil, Range, Raster,
    RayDifferential, Rays, Sample, Samples, ScenePoint, Shutter, TransformError, Transmission, UnknownName,
    Value, Weighting, WorldRay, Zoom,
};
pub use imaging::{
    axial_beam::AxialBeam,
    focus::{Conjugates, Focus, FocusError},
    moving::MovingError,
    open::OpenError,
};
pub use lens::{
    Bounds, Figure, Lens, LensError, Ray, Surface,
    first_order::FirstOrder,
    pupil::{EntrancePupil, ExitPupil},
    refraction::Refraction,
};
pub use numeric::Real;
pub use plan::Plan;
pub use prescription::{
    Asphere, Blades, Coating, Glass, GlassLibrary, Interface, Layer, LensFileError, Medium, Position,
    Positions, Prescription, SearchPath, Shape, SourceError, Stated, SurfaceCoating,
    catalogue::{find as find_lens, names as lens_names},
    glass::{Formula, InternalTransmittance},
    read, read_with,
};
pub use sampling::DiskMapping;
pub use trace::{Blocked, Direction, Path, Walk};

/// The rooms themselves, for this project's programs, laboratory, benches and tests: no promise is made of them, and any
/// version may change them.
#[doc(hidden)]
pub mod unstable {
    /// Makes a module of each room with all that the room shows the crate's neighbours.
    macro_rules! rooms {
        ($($room:ident)*) => {
            $(pub mod $room {
                pub use crate::$room::*;
            })*
        };
    }
    rooms! { abi camera imaging lens light message numeric plan prescription sampling trace }
}
