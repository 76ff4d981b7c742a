//! The pupil of a lens as points of the scene see it: for each field angle and distance the region of a plane through which
//! rays get to the film.
//!
//! A point P at the angle θ to the axis, as a point Q of the axis sees it, sees the lens through the plane across PQ at Q
//! (`spot`). Q is one point, or follows a fisheye's pupil (`sight`). The rays that get through cross that plane within an
//! outline (`outline`), which is tabulated over the nearness of P, the distance of the front from Q over that of P, and over
//! θ up to where the film or the lens ends (`table`, made by `build`). Between the table's outlines others are
//! interpolated; what that leaves out is looked for halfway between them, and at last with rays from the film (`repair`).
//! All this is as fine as the lens is cheap to trace (`detail`): rays are counted, and so many and no more are traced.

mod build;
mod detail;
mod fit;
mod outline;
mod probe;
mod repair;
mod sight;
mod spot;
mod table;

pub(super) use build::build;
pub(super) use detail::Work;
pub(super) use probe::Probe;
pub(super) use repair::FilmRay;
pub(super) use table::{Entrance, Node};
