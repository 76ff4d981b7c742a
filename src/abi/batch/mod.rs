//! Many rays in one call, with their differentials or without, at wavelengths of their own or the camera's, as pbrt's array of structures and as structure of
//! arrays.

mod arrays;
mod blocks;
mod differentials;
mod rays;
mod structures;
mod wavelengths;

pub use differentials::{
    realistic_camera_generate_ray_differentials, realistic_camera_generate_ray_differentials_soa,
};
pub use rays::{realistic_camera_generate_rays, realistic_camera_generate_rays_soa};
pub use wavelengths::{
    realistic_camera_generate_hero_rays_soa, realistic_camera_generate_rays_at,
    realistic_camera_generate_rays_at_soa,
};
