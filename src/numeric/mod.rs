//! The few numerical tools that several rooms need, and [`Real`], the numbers that rays are traced in. Knows nothing
//! of lenses; each file says which book or paper it follows.
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
pub(crate) use points::STEPS;
pub use points::{GAUSS_POINTS, gauss_legendre};
pub use real::{Real, cross, difference_of_products, dot, in_range, unit};
pub use search::{edge, minimum, root};
