//! A lens without a film, for C programs that analyse lenses. All coordinates are in lens space: the origin
//! is the vertex of the first surface, +z points toward the scene, +x to the image's right, +y to the image's
//! top, in millimetres.
//!
//! `handle` opens and frees a lens; `facts` describes it and finds its focus; `trace` traces exact rays
//! through it in either direction and returns the points where they meet its surfaces. `catalogue` lists the
//! names of the built-in lenses.

mod catalogue;
mod facts;
mod handle;
mod trace;

pub use catalogue::*;
pub use facts::*;
pub use handle::*;
pub use trace::*;
