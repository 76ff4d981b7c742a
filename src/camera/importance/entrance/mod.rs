//! The pupil of a lens as points of the scene see it: for each field angle and distance the region of a plane through which
//! rays get to the film.
//!
//! A point P at the distance D from a fixed point Q of the axis, at the angle θ to it, sees the lens through the plane
//! across PQ at Q (`spot`). The rays that get through cross that plane within an outline (`outline`), which is tabulated
//! over 1/D and over θ up to where the film or the lens ends (`table`, made by `build`). Between the table's
//! outlines others are interpolated; what that leaves out is looked for halfway between them, and at last with rays
//! from the film (`repair`).

mod build;
mod outline;
mod repair;
mod sight;
mod spot;
mod table;

pub(super) use build::build;
pub(super) use outline::Probe;
pub(super) use repair::{FilmRay, RAYS};
pub(super) use table::{Entrance, Node};
