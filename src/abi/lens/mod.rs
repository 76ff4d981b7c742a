//! A lens without a film, for C programs that analyse lenses. All coordinates are in lens space: origin at the vertex
//! of the first interface, +z toward the scene, +x image right, +y image up, millimetres.
//!
//! `handle` opens and frees a lens; `facts` describes it and finds its focus; `trace` traces exact rays through it in
//! either direction, with the points where they meet its surfaces. `catalogue` lists the names of the built-in lenses.

mod catalogue;
mod facts;
mod handle;
mod trace;

pub use catalogue::*;
pub use facts::*;
pub use handle::*;
pub use trace::*;
