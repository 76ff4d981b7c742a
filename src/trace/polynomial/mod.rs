//! The lens as polynomials, fitted to exact rays.
//!
//! A lens of surfaces of revolution is symmetric about its axis, so that from film position x and pupil position p (vectors
//! of the plane) position x' and direction q' on the other side are
//!
//! x' = A x + B p,  q' = C x + D p,  A to D polynomials in x·x, x·p and p·p
//!
//! (M. Herzberger, *Modern Geometrical Optics*, 1958; in rendering M. Hullin, J. Hanika and W. Heidrich,
//! "Polynomial Optics", EGSR 2012). Order 2 m + 1 has A to D of total degree m; order 1 is the
//! thick lens, fitted.
//!
//! What is good for the fit: p is the slope at the film less the slope toward the pupil's centre, x and p
//! are scaled to the unit disk, and the invariants to [-1, 1]; x' lies on the front surface itself, and q' is
//! the direction in stereographic projection, d_xy/(1 + d_z). Both stay smooth where a fisheye looks
//! beyond 90°, and the unit direction comes back without a square root.
//!
//! `terms` has the variables and the sums of monomials, `fit` the coefficients by `least_squares`, and `lens` takes rays through the
//! result as a kernel does.

mod fit;
mod least_squares;
mod lens;
mod terms;

pub(crate) use fit::Fits;
pub use fit::{FitError, ORDERS, Polynomial};
pub(crate) use least_squares::LeastSquares;
pub use lens::PolynomialLens;
pub(crate) use terms::{LaneScaling, Scaling, exponents, monomials, sum};
