//! Numerical tools and the formatting of messages, which every other crate of the library uses.
//!
//! The numerical tools are those that more than one crate needs: curves, searches, quadrature, and vectors of three
//! components. Messages are for people: they suggest the nearest known name, have few digits, and fit on a page.
//!
//! | name | is |
//! |---|---|
//! | [`numeric::Real`] | the trait of the number types with which rays are traced |
//! | [`numeric::dot`], [`numeric::cross`], [`numeric::unit`] | vectors of three components, without loss of digits |
//! | [`numeric::Monotone`] | a smooth curve through tabulated points |
//! | [`numeric::root`], [`numeric::minimum`], [`numeric::edge`] | searches in a bracket |
//! | [`numeric::gauss_legendre`] | the points and weights of a quadrature |
//! | [`message::Level`], [`message::Log`] | the severity of a message; the receiver of messages |
//! | [`message::nearest`], [`message::short`] | the correction of a misspelt name; a number in six significant digits |
//!
//! This crate depends on no other crate; `simd`, `optics`, `trace`, `light` and `camera` depend on it.
//!
//! ```
//! use realistic_base::{
//!     message::{nearest, short},
//!     numeric::root,
//! };
//!
//! let angle = root(0.0, 1.5, |x| x.cos() - x);
//! assert_eq!(short(angle), "0.739085");
//! assert_eq!(nearest("focusdistnace", ["focus_distance", "fov"]), Some("focus_distance"));
//! ```
//!
//! Only the public interface of the crate `realistic` is stable; this crate may change in any version.

#![forbid(unsafe_code)]

pub mod message;
pub mod numeric;
