//! The lens as polynomials, fitted to exact rays.
//!
//! A lens of surfaces of revolution is symmetric about its axis. With film position x and pupil position p
//! (two-dimensional vectors), the position x' and the direction q' on the other side of the lens are therefore
//!
//! x' = A x + B p,  q' = C x + D p,  A to D polynomials in x·x, x·p and p·p
//!
//! (M. Herzberger, *Modern Geometrical Optics*, 1958; in rendering M. Hullin, J. Hanika and W. Heidrich, "Polynomial
//! Optics", EGSR 2012). In order 2 m + 1, A to D have total degree m; order 1 is a thick lens that is fitted to the
//! rays.
//!
//! Four choices make the fit accurate: p is the slope at the film minus the slope toward the pupil's centre; x and p
//! are scaled to the unit disk, and the invariants to [-1, 1]; x' lies on the front surface itself; and q' is the
//! direction in stereographic projection, d_xy/(1 + d_z). Position and direction stay smooth for a fisheye's rays
//! beyond 90°, and the unit direction is recovered without a square root.
//!
//! `terms` contains the variables and the sums of monomials, `fit` computes the coefficients by `least_squares`, and
//! `lens` traces rays through the result as a kernel does.

mod fit;
mod least_squares;
mod lens;
mod terms;

pub use fit::Fits;
pub use fit::{FitError, ORDERS, Polynomial};
pub use least_squares::LeastSquares;
pub use lens::PolynomialLens;
pub use terms::monomials;
