//! Lenses: their files, glasses, first-order optics, exact single rays, and focus.
//!
//! A lens file becomes a table of interfaces; the table becomes a lens at one wavelength and stop; rays through that
//! lens give its focus, its axial beam and the irradiance of its film. The crate is independent of cameras.
//!
//! | type | is | module |
//! |---|---|---|
//! | [`Prescription`](prescription::Prescription) | the table of a lens: radii, distances, glasses, diameters | [`prescription`] |
//! | [`GlassLibrary`](prescription::GlassLibrary) | glasses by name, with their dispersion | [`prescription::glass`] |
//! | [`Lens`](lens::Lens) | a prescription at one wavelength and stop | [`lens`] |
//! | [`FirstOrder`](lens::first_order::FirstOrder) | the focal length and principal planes of a lens | [`lens`] |
//! | [`Path`](trace::Path) | a lens made ready for exact rays in one direction | [`trace`] |
//! | [`Walk`](trace::Walk) | a ray traced as far as it gets, with the reason if it is blocked | [`trace`] |
//! | [`AxialBeam`](imaging::axial_beam::AxialBeam) | the rays of a distant axial point that pass the lens | [`imaging`] |
//! | [`Focus`](imaging::focus::Focus) | film distances and the planes in focus | [`imaging`] |
//! | [`open`](imaging::open) | opens a lens at a wavelength, stop, zoom and focus | [`imaging`] |
//!
//! This crate depends on `base`; `trace`, `light` and `camera` depend on this crate.
//!
//! ```
//! use realistic_optics::imaging::focus::{Focus, FocusError};
//! use realistic_optics::lens::{Lens, Ray};
//! use realistic_optics::{prescription::catalogue, trace::Path};
//!
//! let lens = Lens::at_own_wavelength(&catalogue::find("tessar.50mm").expect("in the catalogue"));
//! let film = lens.rear().vertex - Focus::new(&lens)?.film_distance(2000.0)?;
//! let ray = Ray { origin: [0.0, 0.0, film], direction: [0.05, 0.0, 1.0] };
//! let path: Path = Path::film_to_scene(&lens);
//! let walk = path.walk(ray);
//! assert!(walk.blocked.is_none() && walk.ray.direction[2] > 0.99);
//! # Ok::<(), FocusError>(())
//! ```
//!
//! Lens space has its origin at the vertex of the first surface and +z toward the scene, in millimetres.
//!
//! Only the public interface of the crate `realistic` is stable; this crate may change in any version.

#![forbid(unsafe_code)]

pub mod imaging;
pub mod lens;
pub mod prescription;
pub mod trace;
