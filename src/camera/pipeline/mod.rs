//! From samples to world rays: film ray, trace, weight and world ray, for one sample, three, or many.

pub(crate) mod batch;
pub(crate) mod block;
pub(crate) mod compiled;
pub(crate) mod few;
pub(crate) mod film_rays;
pub(crate) mod tracer;
