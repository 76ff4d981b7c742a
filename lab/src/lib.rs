//! What the library says about itself: errors against an extended-precision reference, run times, and
//! numerical stability.

pub mod bench;
mod clock;
mod compiled;
pub mod condition;
pub mod disk_statistics;
mod dual;
pub mod irradiance;
pub mod kernel_rays;
pub mod machine;
pub mod measurement;
pub mod outline;
pub mod picture;
pub mod pupil_table;
pub mod ray_map;
pub mod ray_set;
pub mod reference;
pub mod refractions;
pub mod renderers;
pub mod sampler;
pub mod scene;
pub mod sequence;
pub mod set_up;
pub mod stability;
pub mod statistics;
pub mod subject;
pub mod suite;
pub mod table;
