//! Exact rays through a lens, and the lens's amplification of rounding errors. Rays are traced in double-double numbers
//! of 106 bits, by the walk's formulas for spheres and planes, and by separate formulas and a separate search for
//! aspheres.

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
