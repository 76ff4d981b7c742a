//! Surfaces that are neither spheres nor planes, in lanes: the geometry, the notation and the proof of the first crossing
//! are those of [`Aspheric`](crate::trace::aspheric::Aspheric).
//!
//! A conic is met in closed form ([`Conic`]), a surface with terms by Newton's iteration ([`LaneAsphere`]): the steps that
//! `plan` found when the lens was compiled, more for lanes that are not there yet. What is left open then, be it the convergence
//! or the proof, goes one by one to the walk's own procedure in double precision. No lane's outcome depends on its
//! neighbours, so that every width gives the same bits.

mod conic;
mod figure;
mod newton;
mod plan;

pub use figure::{Conic, LaneAsphere, Profile};
