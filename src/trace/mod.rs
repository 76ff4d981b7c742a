//! Exact tracing of rays through a lens.
//!
//! [`Path`] is a lens made ready for one direction of travel; [`Path::walk`] takes one ray
//! through it and says why a ray does not arrive ([`Blocked`]). The same code serves both directions: a path
//! counts its own axis forward, so that scene to film is film to scene with the surfaces in the
//! other order and their curvatures turned round. [`kernel::Kernel`] is the same lens compiled for speed.
//!
//! **Method.** A ray is a point P and V = n D, its direction D times the refractive index n. From surface to surface:
//!
//! 1. P is counted from the next surface's vertex: z less the distance.
//! 2. The ray meets a sphere or plane of curvature c at P + t V, t = 2 f/(g + e), with f = (c/2) P·P - z and g = N·V at P, and
//!    e = √(g² - 2 c n² f) = n cos I at the hit (`surface`); it meets an aspheric surface by Newton's iteration, with a proof that
//!    the crossing is the first (`aspheric`).
//! 3. The point is tested against the clear aperture, and in the stop against the figure of the blades (`surface`).
//! 4. Snell's law, with N the unit normal and n' the index behind: V' = V + (e' - e) N, e' = √(e² + n'² - n²) = n' cos I'
//!    (W. J. Smith, *Modern Optical Engineering*). Where the root is of a negative number, the ray is totally reflected.
//!
//! `path` is the loop over the surfaces. [`polynomial`] has fitted polynomials in the place of all that.

use thiserror::Error;

mod aspheric;
pub mod kernel;
mod path;
pub mod polynomial;
mod surface;

pub use aspheric::evaluations;
pub(crate) use path::FoldedPaths;
pub use path::{Direction, Meeting, Path, StepKind, Walk};
pub(crate) use surface::PathSurface;

pub use crate::{lens::Ray, numeric::Real};

/// Why a ray does not get through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
pub enum Blocked {
    /// It passes beside a surface.
    #[error("missed")]
    Missed,
    /// It meets a surface outside the clear aperture.
    #[error("clipped")]
    Clipped,
    /// It is totally reflected.
    #[error("reflected")]
    Reflected,
    /// The next surface lies behind it, or it travels backward.
    #[error("turned_back")]
    TurnedBack,
}

/// A ray on its way: position and V = n D in the frame of the current vertex.
#[derive(Clone, Copy)]
pub(crate) struct State<R> {
    p: [R; 3],
    v: [R; 3],
    /// How far the ray was moved on from where it began or was last bent, in units of V.
    lead: R,
}
