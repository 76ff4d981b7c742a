//! Many rays in one call, with their differentials or without, at the camera's wavelength or one each: as pbrt's array of
//! structures, as structure of arrays, and as arrays of any strides. The last two, column by column, are answered in `request`.

mod arrays;
mod blocks;
mod columns;
mod differentials;
mod rays;
mod request;
mod strided;
mod structures;
mod wavelengths;

pub use differentials::{
    realistic_camera_generate_ray_differentials, realistic_camera_generate_ray_differentials_at_soa,
    realistic_camera_generate_ray_differentials_soa,
};
pub use rays::{realistic_camera_generate_rays, realistic_camera_generate_rays_soa};
pub use strided::realistic_camera_generate_batch;
pub use wavelengths::{
    realistic_camera_generate_hero_rays_soa, realistic_camera_generate_rays_at,
    realistic_camera_generate_rays_at_soa,
};
