//! The few numerical tools that several rooms need, and [`Real`], the numbers that rays are traced in. Knows nothing
//! of lenses; each file says which book or paper it follows.

mod linear;
mod minimum;
mod monotone;
mod quadrature;
pub(crate) mod quasirandom;
mod real;
mod root;
mod vector;

pub use linear::on_broken_line;
pub use minimum::minimum;
pub use monotone::Monotone;
pub use quadrature::{GAUSS_POINTS, gauss_legendre};
pub use real::Real;
pub use root::{edge, root};
pub use vector::{cross, difference_of_products, dot, in_range, unit};
