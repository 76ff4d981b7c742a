//! A real camera for renderers: rays traced from the film through every interface of a real lens
//! prescription (C. Kolb, D. Mitchell and P. Hanrahan, "A Realistic Camera Model for Computer
//! Graphics", SIGGRAPH 1995).
//!
//! A [`Camera`] is described by [`Camera::builder`] and turns each [`Sample`], a point of the film and two numbers for the
//! lens, into a ray in world space and its weight:
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
//! For many samples at once there is [`Camera::rays`]; with the rays of neighbouring pixels [`Camera::ray_differential`], at
//! wavelengths [`Camera::ray_at`] and [`Camera::hero_rays`], and [`Camera::generate`] says why there is no ray.
//!
//! A [`Prescription`] is the table of a lens, by [`read`] from a file's text or by [`lens_names`] and [`find_lens`] from the
//! catalogue; a [`Lens`] is that at one wavelength, with its surfaces and its [`FirstOrder`] optics:
//!
//! ```
//! use realistic::{FirstOrder, Lens, find_lens};
//!
//! let lens = Lens::at_own_wavelength(&find_lens("tessar.50mm").expect("in the catalogue"));
//! assert!((FirstOrder::of(&lens)?.focal_length - 50.0).abs() < 0.01);
//! # Ok::<(), realistic::LensError>(())
//! ```
//!
//! Lens space: origin at the vertex of the first interface, +z toward the scene, +x image right, +y image up, millimetres.
//! Camera space has the same origin and axes, in world units.
//!
//! Hosts in other languages take the C ABI of `include/realistic.h`. [`unstable`] is how the project's own programs and tests
//! reach what is not promised.

// The rooms, in the order in which data flows: warnings and errors for people; vectors, roots and quadrature; lens files to
// tables of interfaces and glasses, and the catalogue; a lens at one wavelength and stop; exact rays through it; what tracing
// tells about a lens; where rays start; what a camera needs of all that; film, weights and transforms, a sample in and a ray
// out; and the C ABI with the entry of a pbrt-v1 host, the only exports and the only raw pointers.
mod abi;
mod camera;
mod imaging;
mod lens;
mod message;
mod numeric;
mod plan;
mod prescription;
mod sampling;
mod trace;

pub use camera::{
    Aimed, Backward, Camera, CameraBuilder, CameraError, CameraMotion, CameraToWorld, Crop, Facts, Film,
    FocusBy, Host, Importance, ImportanceError, Interval, Kind, LensPlane, Level, Log, Model, Moving,
    NeighbourArrays, Outcome, PARAMETERS, Parameter, ParameterError, Parameters, Precision, Pupil, Range,
    Raster, RayArrays, RayDifferential, Sample, SampleArrays, ScenePoint, Shutter, TransformError,
    UnknownName, Value, Weighting, WorldRay, Zoom,
};
pub use imaging::focus::{Conjugates, Focus, FocusError};
pub use lens::{
    Bounds, Figure, Lens, LensError, Ray, Surface, first_order::FirstOrder, moving::MovingError,
    open::OpenError, pupil::EntrancePupil, refraction::Refraction,
};
pub use numeric::Real;
pub use plan::Plan;
pub use prescription::{
    Asphere, Blades, Glass, GlassLibrary, Interface, LensFileError, Medium, Position, Positions,
    Prescription, SearchPath, Sellmeier, Shape, SourceError, Stated,
    catalogue::{find as find_lens, names as lens_names},
    glass::Formula,
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
    rooms! { abi camera imaging lens message numeric plan prescription sampling trace }
}
