//! Numerical tools that several modules share, and [`Real`], the number types of ray tracing. The module knows
//! nothing of lenses; each file names the book or paper that it follows.
//!
//! | to | call | method |
//! |---|---|---|
//! | find a root in a bracket | [`root`] | Brent and Dekker |
//! | find where a condition ends | [`edge`] | bisection, to the last bit |
//! | find a minimum in a bracket | [`minimum`] | golden section |
//! | integrate over [0, 1] | [`gauss_legendre`] | 16-point Gauss-Legendre |
//! | go through tabulated points | [`Monotone`], [`on_broken_line`] | monotone cubic Hermite; straight lines |
//! | fill a cube evenly with points | [`STEPS`] | additive recurrence |
//! | add products without cancellation | [`difference_of_products`], [`cross`] | Kahan, with fused multiply-add |

mod interpolation;
mod points;
mod real;
mod search;

pub use interpolation::{Monotone, on_broken_line};
pub use points::STEPS;
pub use points::{GAUSS_POINTS, gauss_legendre};
pub use real::{Real, cross, difference_of_products, dot, in_range, unit};
pub use search::{edge, minimum, root};
