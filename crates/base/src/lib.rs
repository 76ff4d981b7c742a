//! Numerical tools and the words of messages, which every other crate uses.
//!
//! [`numeric`] finds roots, minima and integrals, interpolates, and defines [`Real`](numeric::Real), the number types of
//! ray tracing. [`message`] words what users read. The crate knows nothing of lenses.

#![forbid(unsafe_code)]

pub mod message;
pub mod numeric;
