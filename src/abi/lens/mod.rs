//! A lens without a film, for a C caller: what programs that analyse lenses ask for. All in lens space: origin at the
//! vertex of the first interface, +z toward the scene, +x image right, +y image up, millimetres.
//!
//! `handle` opens and frees a lens, `facts` says what it is, `focus` where it is sharp, and `trace` takes rays through it
//! exactly, either way, of which `points` tells every surface's point. `catalogue` has the names of the
//! built-in ones.

mod catalogue;
mod facts;
mod focus;
mod handle;
mod points;
mod trace;

pub use catalogue::*;
pub use facts::*;
pub use focus::*;
pub use handle::*;
pub use points::*;
pub use trace::*;
