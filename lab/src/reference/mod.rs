//! A lens and rays in, exact rays out: the walk in double-double numbers of 106 bits, and how much the lens
//! amplifies rounding.

mod aspheric;
pub mod condition;
mod double_double;
mod dual;
mod exact;

pub use double_double::DoubleDouble;
pub use exact::{ExactRay, Reference};
