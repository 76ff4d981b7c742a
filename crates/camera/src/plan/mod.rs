//! Plans what a camera keeps for its film, pupil and pose, and what it leaves out.
//!
//! The input is a `Task` (lens, film side, pupil sampler, requested precision and tolerance). The results are a
//! decision, [`Tracing`], and a [`Plan`] that lists what is kept and left out, and why.
//!
//! Without a tolerance, leaving something out does not change any bit of any ray. A tolerance above 0 allows
//! a cheaper model of the lens: single precision, or polynomials of some order. For each kind of call (one
//! ray, a batch), the plan works as follows:
//!
//! 1. Order the candidates by the cost of a ray: t = t₀ + t₁ S for the exact trace through S surfaces, t = t₀ + t₁ C
//!    for polynomials of C coefficients, with measured constants (`cost`).
//! 2. In order of increasing cost, measure each candidate's errors on a stratified sample of the film and its
//!    pupil (`evaluate`). The k-th largest of n errors bounds their 99.9 % quantile, where k is the largest
//!    number such that fewer than k errors lie beyond the quantile with a probability of at most 1/500 (H. A.
//!    David and H. N. Nagaraja, *Order Statistics*, 2003, §7.1).
//! 3. Choose the first candidate whose bound is below the tolerance and whose weights' errors sum to at most
//!    a thousandth of the light ([`choice`]). The exact trace in double precision is always accepted.
//!
//! `task` has the types of input and output; `decide` makes the decision and writes the plan.

pub mod choice;
mod cost;
mod decide;
mod evaluate;
mod task;

pub use choice::Choice;
pub(crate) use decide::{Decision, Requests, describe_requests, describe_sampling};
pub use decide::{Item, Plan};

pub use task::{Entry, Precision, Tracing};
pub(crate) use task::{FilmSide, Kernels, Task};
