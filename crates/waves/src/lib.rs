//! Diffraction: wavefronts, point spread functions (PSF) and modulation transfer functions (MTF) of a lens.
//!
//! Light of an object point leaves the lens as a wave. Near the film it is a sum of plane waves, one for each ray: a ray
//! with the unit direction d in a medium of index n' is the plane wave exp(i k n' d·x). With the optical path (OPL) of the
//! ray to a point P on it, its phase at the image point P0 is that of
//!
//! ```text
//! W = OPL(P) + n' (P0 - P)·d - OPL of the chief ray to P0,
//! ```
//!
//! wherever on the ray P lies. W is the wavefront's path difference; no exit pupil and no reference sphere is needed, so
//! that telecentric lenses, tilted film and lenses without an axis are no special cases. With q = n' d on the film plane,
//! the field at a film point x is
//!
//! ```text
//! U(x) = ∫ a(q) exp(i k (W(q) + q·(x - P0))) d²q,   |a|² d²q = the power of the rays in d²q,
//! ```
//!
//! and |U|²/λ² is the power per area of film (M. Born and E. Wolf, *Principles of Optics*, §8.8 and §9.1).
//!
//! | module | is |
//! |---|---|
//! | [`object`] | an object point, at a finite distance or at infinity, and its rays |
//! | `pupil` | the nodes of a quadrature over the rays that pass, found row by row |
//! | [`wavefront`] | the rays traced with their optical paths; RMS, Zernike coefficients |
//! | [`psf`], [`mtf`] | the power on the film and its Fourier transform |
//! | [`seidel`] | third-order sums by surface |
//! | `fourier` | the sum over scattered plane waves at all pixels |
//!
//! Everything is in double precision, mm and radians, and for one wavelength; sums over wavelengths are sums of powers. The
//! field is scalar: polarisation and the obliquity of steep cones are left out, which matters from about f/1 on.
//!
//! This crate depends on `base`, `optics` and `trace`. Only the public interface of the crate `realistic` is stable; the
//! interface of this crate may change in any version.

#![forbid(unsafe_code)]

mod fourier;
pub mod mtf;
pub mod object;
pub mod psf;
mod pupil;
mod quadrature;
pub mod seidel;
pub mod wavefront;
pub mod zernike;

pub use mtf::{Mtf, airy_mtf};
pub use object::ObjectPoint;
pub use psf::Psf;
pub use wavefront::{FilmPlane, Sampling, WaveError, Wavefront};
