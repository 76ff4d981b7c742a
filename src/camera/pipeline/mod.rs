//! From samples to world rays: film ray, trace, weight and world ray, for one sample, four, or many.

pub(crate) mod arrays;
pub(crate) mod body;
pub(crate) mod compile;
mod film_sampling;
mod lanes;
pub(crate) mod tracer;
mod walk;
