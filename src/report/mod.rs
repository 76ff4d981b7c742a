//! What the library says about itself: errors against an extended-precision reference, run times, and
//! numerical stability.

pub mod condition;
pub mod reference;
pub mod stability;
