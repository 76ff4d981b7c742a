//! Surfaces that are neither spheres nor planes, in lanes. Geometry, notation and the proof of the first crossing are
//! those of [`Aspheric`](realistic_optics::trace::Aspheric).
//!
//! A conic is intersected in closed form ([`Conic`]), a surface with terms by Newton's iteration ([`LaneAsphere`]):
//! with the steps that `plan` chose when the lens was compiled, and with more steps for lanes that have not converged.
//! If convergence or the proof then remains open in a lane, the ray of that lane is traced singly, by the procedure of
//! the walk in double precision. The result of a lane does not depend on other lanes, so every width gives the same
//! bits.

mod conic;
mod figure;
mod newton;
mod plan;

pub(crate) use figure::{Common, Conic, LaneAsphere, Profile};
