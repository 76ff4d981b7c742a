//! What a camera needs for its film, pupil and place, and what is left out.
//!
//! In goes a `Task` (lens, film side, pupil sampler, precision and tolerance asked for); out come one decision,
//! [`Tracing`], and a [`Plan`] that says what was kept and left out, and why. What it leaves out changes no bit of any
//! ray: aperture tests that no ray can fail (proven with bounds), surfaces that then do nothing, the interpolation of a
//! motion in a closed shutter. A tolerance above 0 allows a cheaper model of the lens, too ([`choice`]), whose
//! error is measured and stated, and another one for rays asked for one by one than for those in batches.

mod affine;
pub(crate) mod apertures;
pub mod choice;
mod cost;
mod decide;
mod describe;
mod evaluate;
mod items;
mod quantile;
mod strata;
mod task;
mod tracing;

pub use choice::Choice;
pub(crate) use decide::{Decision, Way};
pub(crate) use describe::describe_sampling;
pub use evaluate::{Errors, TooFarOff};
pub use items::{Item, Plan};
pub(crate) use task::{FilmSide, Kernels, Task};
pub use tracing::{Entry, Precision, Tracing};
