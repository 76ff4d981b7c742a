//! A lens and rays in, exact rays out: in double-double numbers of 106 bits by the walk's formulas for spheres and planes,
//! and by formulas and a search of its own for aspheres; and how much the lens amplifies rounding.

mod aspheric;
pub mod condition;
mod double_double;
mod dual;
mod exact;
mod scan;
mod whole_lens;

pub use double_double::DoubleDouble;
pub use exact::ExactRay;
pub use whole_lens::Reference;
