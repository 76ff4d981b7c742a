//! Light tracing: the importance of rays from the scene, and directions toward the lens, as structures
//! of arrays.

mod aim;
mod arrays;
mod arrive;

pub use aim::{realistic_aimed, realistic_camera_sample_importance, realistic_scene_points};
pub use arrays::realistic_importance;
pub use arrive::{realistic_camera_importance, realistic_importance_rays};
