//! What a camera needs for its film, pupil and place, and what is left out.
//!
//! In goes a `Task` (lens, film side, pupil sampler, precision and tolerance asked for); out come one decision,
//! [`Tracing`], and a [`Plan`] that says what was kept and left out, and why. Without a tolerance what it leaves out changes
//! no bit of any ray. A tolerance above 0 allows a cheaper model of the lens ([`choice`]), whose error is measured and
//! stated, and another one for rays asked for one by one than for those in batches.

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
pub(crate) use decide::Decision;
pub(crate) use describe::describe_sampling;
pub use evaluate::{Errors, TooFarOff};
pub use items::{Item, Plan};
pub(crate) use task::{FilmSide, Kernels, Task};
pub use tracing::{Entry, Precision, Tracing};
