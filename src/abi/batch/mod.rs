//! Many rays in one call, with their differentials or without, as pbrt's array of structures and as structure of
//! arrays.

mod arrays;
mod blocks;
mod differentials;
mod rays;
mod structures;

pub use differentials::{
    realistic_camera_generate_ray_differentials, realistic_camera_generate_ray_differentials_soa,
};
pub use rays::{realistic_camera_generate_rays, realistic_camera_generate_rays_soa};
