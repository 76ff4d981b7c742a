//! A lens without a film, for a C caller: what programs that analyse lenses ask for. All in lens space: origin at the
//! vertex of the first interface, +z toward the scene, +x image right, +y image up, millimetres.
//!
//! `handle` opens and frees a lens; `facts` says what it is and where it is sharp; `trace` takes rays through it exactly, either
//! way, with the points where they meet its surfaces. `catalogue` has the names of the built-in lenses.

mod catalogue;
mod facts;
mod handle;
mod trace;

pub use catalogue::*;
pub use facts::*;
pub use handle::*;
pub use trace::*;
