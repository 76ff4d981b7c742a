//! Exact tracing of rays through a lens.
//!
//! [`Path`] is a lens made ready for one direction of travel; [`Path::walk`] takes one ray
//! through it and says why a ray does not arrive. The same code serves both directions: a path
//! counts its own axis forward, so that scene to film is film to scene with the surfaces in the
//! other order and their curvatures turned round. [`kernel::Kernel`] is the same lens compiled for speed,
//! and [`KernelRays`] takes rays from anywhere to it.

mod clearance;
pub mod kernel;
mod kernel_rays;
mod path;
pub mod polynomial;
mod visit;
mod walk;

pub use clearance::Clearance;
pub use kernel_rays::KernelRays;
pub use path::{Direction, Path};
pub(crate) use visit::Visit;
#[doc(hidden)]
pub use walk::in_range;
pub use walk::{Blocked, Walk};

pub use crate::{lens::Ray, numeric::Real};
