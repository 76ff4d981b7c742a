//! What the library says about itself: errors against an extended-precision reference, run times, and
//! numerical stability.

pub mod bench;
mod clock;
pub mod condition;
pub mod irradiance;
pub mod machine;
pub mod picture;
pub mod ray_map;
pub mod reference;
pub mod refractions;
pub mod sampler;
pub mod scene;
pub mod sequence;
pub mod set_up;
pub mod stability;
pub mod statistics;
pub mod subject;
pub mod suite;
pub mod table;
