//! Surfaces that are neither spheres nor planes, in lanes. Geometry, notation and the proof of the first crossing are
//! those of [`Aspheric`](realistic_optics::trace::Aspheric).
//!
//! A conic is intersected in closed form ([`Conic`]), a surface with terms by Newton's iteration ([`LaneAsphere`]):
//! with the steps that `plan` chose when the lens was compiled, and with more for lanes that have not converged. If
//! convergence or the proof then remains open in a lane, its ray goes one by one to the walk's own procedure in
//! double precision. No lane's result depends on its neighbours, so that every width gives the same bits.

mod conic;
mod figure;
mod newton;
mod plan;

pub(crate) use figure::{Conic, LaneAsphere, Profile};
