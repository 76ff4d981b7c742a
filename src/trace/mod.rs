//! Exact tracing of rays through a lens.
//!
//! [`Path`] is a lens made ready for one direction of travel; [`Path::walk`] takes one ray
//! through it and says why a ray does not arrive. The same code serves both directions: a path
//! counts its own axis forward, so that scene to film is film to scene with the surfaces in the
//! other order and their curvatures turned round. [`kernel::Kernel`] is the same lens compiled for speed.

mod aspheric;
mod blades;
pub mod kernel;
mod path;
pub mod polynomial;
mod state;
mod surface;
mod work;

pub use path::{Direction, Meeting, Path, StepKind, Walk};
pub use state::Blocked;
pub use work::evaluations;

pub use crate::{lens::Ray, numeric::Real};
