//! Numerical tools that several modules share, and [`Real`], the trait of the number types of ray tracing. The module
//! is independent of lenses; each file names the book or paper that it follows.
//!
//! | task | function or type | method |
//! |---|---|---|
//! | root in a bracket | [`root`] | Brent and Dekker |
//! | point where a condition changes | [`edge`] | bisection, to the last bit |
//! | minimum in a bracket | [`minimum`] | golden section |
//! | integral over [0, 1] | [`gauss_legendre`] | 16-point Gauss-Legendre |
//! | interpolation of tabulated points | [`Monotone`], [`on_broken_line`] | monotone cubic Hermite; piecewise linear |
//! | evenly distributed points in a cube | [`STEPS`] | additive recurrence |
//! | derivatives of a formula, and bounds of them | [`Gradient`], [`Hessian`], [`Interval`] | forward mode; interval arithmetic |
//! | products subtracted without cancellation | [`difference_of_products`], [`cross`] | Kahan, with fused multiply-add |

mod derivatives;
mod interpolation;
mod points;
mod real;
mod search;

pub use derivatives::{Arithmetic, Gradient, Hessian, Interval};
pub use interpolation::{Monotone, on_broken_line};
pub use points::STEPS;
pub use points::{GAUSS_POINTS, gauss_legendre};
pub use real::{Real, cross, difference_of_products, dot, in_range, unit};
pub use search::{edge, minimum, root};
