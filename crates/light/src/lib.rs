//! Light at the surfaces of a lens: transmission by Fresnel's equations and thin films, absorption, and ghosts.
//!
//! [`split`] contains the physics: from a stack of films and an angle, it computes the reflected and the transmitted
//! share of the light. The types below apply [`split`] to light along single rays and along rays in lanes.
//! `docs/light.md` has the theory.
//!
//! | type | is |
//! |---|---|
//! | [`Split`], [`Share`] | the effect of a surface on light at one angle |
//! | [`Boundary`] | the effect of a surface on light at every angle, from a table |
//! | [`Surfaces`] | the boundaries and the absorption of a lens |
//! | [`Light`] | the power and the polarisation of light along a ray |
//! | [`LitPath`] | a path whose rays carry light; the path of a ghost has two mirrors |
//! | [`Transmission`] | the light that rays in lanes carry through the kernel's steps |
//! | [`TStop`] | the f-number over the square root of the transmission |
//! | [`Ghosts`], [`GhostSpectrum`] | the paths with two reflections, at one wavelength or at many |
//! | [`Lamp`], [`Spray`] | a lamp, and the light on the film that comes from the lamp along one path |
//! | [`FilmGhosts`] | the paths with two reflections, sampled from the film |
//!
//! This crate depends on `base`, `simd`, `optics` and `trace`; `camera` depends on this crate.
//!
//! ```
//! use realistic_light::{LitPath, Surfaces, split};
//! use realistic_optics::lens::{Lens, Ray};
//! use realistic_optics::prescription::{Coating, catalogue};
//! use realistic_optics::trace::{Blocked, Path};
//!
//! // A bare surface of glass reflects ((n - 1)/(n + 1))² of the light that meets it head on.
//! assert!((split(&[], [1.0, 1.5], 1.0, 550.0).reflected.mean() - 0.04).abs() < 1e-12);
//!
//! let lens = Lens::at_own_wavelength(&catalogue::find("tessar.50mm").expect("in the catalogue"));
//! let path = LitPath::new(Path::scene_to_film(&lens), &Surfaces::new(&lens, Coating::QuarterWave));
//! let (_, power) = path.trace(Ray { origin: [0.0, 0.0, 10.0], direction: [0.0, 0.0, -1.0] })?;
//! assert!(power > 0.8 && power < 1.0);
//! # Ok::<(), Blocked>(())
//! ```
//!
//! Only the public interface of the crate `realistic` is stable; the interface of this crate may change in any version.

#![forbid(unsafe_code)]

mod absorption;
mod beam;
mod boundary;
mod coated;
mod film_ghosts;
mod ghosts;
mod lamp;
mod lane_light;
mod lane_surface;
mod pairs;
mod polarization;
mod shares;
mod spray;
mod stack;
mod sums;
mod t_stop;
mod transmission;
mod work;

pub use absorption::Absorbers;
pub use boundary::Boundary;
pub use coated::{LitPath, MediumAt, Pair, SpectralPaths, Surfaces};
pub use film_ghosts::{FilmGhosts, PairChoice, SlopeChoice};
pub use ghosts::{GhostSpectrum, Ghosts, LeftOut, beyond_pairs, paraxial_focus};
pub use lamp::{Lamp, LampError};
pub use polarization::Light;
pub use spray::{Landing, Spray};
pub use stack::{Share, Split, split};
pub use t_stop::TStop;
pub use transmission::Transmission;
#[doc(hidden)]
pub use work::work_spent;
