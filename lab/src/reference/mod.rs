//! Exact rays through a lens, and the lens's amplification of rounding errors. Rays are traced in double-double numbers
//! of 106 bits or in [`Wide`] numbers of 256 bits (77 decimal digits), through every kind of lens, by formulas and a search
//! for crossings that the walk does not share.

pub mod condition;
mod double_double;
mod dual;
mod exact;
mod form;
mod range;
mod scan;
mod sheet;
mod whole_lens;
mod wide;

pub use double_double::DoubleDouble;
pub use exact::ExactRay;
pub use whole_lens::Reference;
pub use wide::Wide;
