//! Exact tracing of rays through a lens.
//!
//! [`Path`] is a lens made ready for one direction of travel; [`Path::walk`] traces one ray through it and reports why
//! a ray is blocked ([`Blocked`]). The same code serves both directions. A path measures z along the direction of
//! travel, so that a path from scene to film is a path from film to scene with the surfaces in reverse order and their
//! curvatures negated. `realistic_trace::kernel::Kernel` is the same lens compiled for speed.
//!
//! **Method.** A ray is a point P and a vector V = n D, its direction D times the refractive index n. At each surface:
//!
//! 1. P is moved into the frame of the next surface's vertex: the distance between the vertices is subtracted from z. Where
//!    the surfaces do not share an axis, P and V are also turned (`frame_change`).
//! 2. The ray meets a sphere or plane of curvature c at P + t V, where t = 2 f/(g + e). Here f = (c/2) P·P - z and
//!    g = N·V at P, and e = √(g² - 2 c n² f) = n cos I at the hit (`surface`). The hit on an aspheric surface is found
//!    by Newton's iteration, with a proof that it is the first crossing (`aspheric`); that on a surface which is not
//!    symmetric by steps that cannot skip one (`unsymmetric`).
//! 3. The point is tested against the clear aperture (`surface`) and the apertures and obstructions in it (`aperture`).
//! 4. V is refracted by Snell's law: V' = V + (e' - e) N, where N is the unit normal, n' the index behind the surface,
//!    and e' = √(e² + n'² - n²) = n' cos I' (W. J. Smith, *Modern Optical Engineering*). A negative number under the
//!    root means total reflection.
//!
//! `path` is the loop over the surfaces. `realistic_trace::polynomial` replaces this whole method by fitted
//! polynomials.

use thiserror::Error;

mod aperture;
mod aspheric;
mod frame_change;
mod path;
mod surface;
mod unsymmetric;

pub use aperture::{ApertureTest, ConvexTest, Edge, OutlineTest, PictureTest};
pub use aspheric::{Aspheric, BendBound};
pub use frame_change::FrameChange;
pub use path::{Direction, FoldedPaths, Meeting, Path, StepKind, Walk};
pub use surface::PathSurface;
pub use unsymmetric::{CylinderSheet, SheetBounds, UnsymmetricSheet};

pub use crate::lens::Ray;
pub use realistic_base::numeric::Real;

/// The reason why a ray is blocked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
pub enum Blocked {
    /// The ray misses a surface.
    #[error("missed")]
    Missed,
    /// The ray meets a surface outside the clear aperture of that surface.
    #[error("clipped")]
    Clipped,
    /// The ray is totally reflected.
    #[error("reflected")]
    Reflected,
    /// The next surface lies behind the ray, or the ray travels backward.
    #[error("turned_back")]
    TurnedBack,
}

/// A ray between surfaces: its position and V = n D, in the frame of the current vertex.
#[derive(Clone, Copy)]
pub struct State<R> {
    p: [R; 3],
    v: [R; 3],
    /// Distance, in units of V, by which the ray was advanced since its origin or its last refraction.
    lead: R,
    /// Optical path since the ray's origin, mm: the sum of lengths times indices.
    path: R,
}

impl<R: Real> State<R> {
    /// Returns the point of the ray in the vertex plane, from which the search for a crossing starts because lengths
    /// there are of the same scale as the surface; and the distance from there, in units of V, of the point `slack`
    /// before the last one of the ray.
    ///
    /// # Errors
    /// The ray does not lead toward +z.
    #[inline(always)]
    fn at_vertex_plane(&self, slack: R) -> Result<([R; 3], R), Blocked> {
        let Self { p, v, lead, .. } = *self;
        if !(v[2] > R::ZERO) {
            return Err(Blocked::TurnedBack);
        }
        let to_plane = -p[2] / v[2];
        let start = [p[0] + to_plane * v[0], p[1] + to_plane * v[1], R::ZERO];
        Ok((start, -(lead + to_plane) - slack))
    }
}
