//! From samples to world rays: film ray, trace, weight and world ray, for one sample, four, or many.

pub(crate) mod arrays;
pub(crate) mod body;
pub(crate) mod compile;
pub(crate) mod film_sampling;
pub(crate) mod ghosts;
pub(crate) mod ideal;
mod lanes;
pub(crate) mod on_demand;
pub(crate) mod ray_maker;
pub(crate) mod spectral;
pub(crate) mod stock;
pub(crate) mod tracer;
mod walk;
