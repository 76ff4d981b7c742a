//! The environment camera: everything around a point, in spherical coordinates about the y axis.
//!
//! It is pbrt-v1's stock camera of this name (M. Pharr and G. Humphreys, *Physically Based Rendering*,
//! 1st ed. 2004, §6.3): θ = π y/yres from straight up, φ = 2π x/xres from +x toward +z, weight 1, and
//! `hither` and `yon` as distances from the point. Where the camera transform scales or shears, directions are made unit
//! vectors, which the stock camera's are not then, and the clip range follows.

use std::f32::consts::{PI, TAU};

use crate::camera::{
    film::Raster,
    placement::Placement,
    ray::{Sample, WorldRay},
};

/// A camera that looks in every direction. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct EnvironmentCamera {
    xres: f32,
    yres: f32,
    placement: Placement,
}

impl EnvironmentCamera {
    pub(crate) fn new(raster: Raster, placement: Placement) -> Self {
        Self { xres: raster.xres as f32, yres: raster.yres as f32, placement }
    }

    pub(crate) fn placement(&self) -> &Placement {
        &self.placement
    }

    /// The ray of a sample; its weight is 1.
    pub fn ray(&self, sample: &Sample) -> WorldRay {
        let theta = PI * sample.image_y / self.yres;
        let phi = TAU * sample.image_x / self.xres;
        let direction = [theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()];
        self.placement.world_ray_single([0.0; 3], direction, self.placement.clip, sample.time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::CameraToWorld;

    #[test]
    fn the_image_is_the_sphere_of_directions() {
        let placement =
            Placement { to_world: CameraToWorld::IDENTITY.into(), clip: [0.5, 8.0], shutter: [1.0, 3.0] };
        let camera = EnvironmentCamera::new(Raster { xres: 40, yres: 20 }, placement);
        for (image, expected) in [
            ([20.0, 10.0], [-1.0, 0.0, 0.0]),
            ([0.0, 10.0], [1.0, 0.0, 0.0]),
            ([10.0, 10.0], [0.0, 0.0, 1.0]),
            ([30.0, 10.0], [0.0, 0.0, -1.0]),
            ([13.0, 0.0], [0.0, 1.0, 0.0]),
            ([13.0, 20.0], [0.0, -1.0, 0.0]),
        ] {
            let sample = Sample { image_x: image[0], image_y: image[1], time: 0.25, ..Sample::default() };
            let ray = camera.ray(&sample);
            for (got, expected) in ray.direction.iter().zip(expected) {
                assert!((got - expected).abs() < 1e-6, "{image:?}: {ray:?}");
            }
            assert_eq!((ray.origin, ray.mint, ray.maxt, ray.time), ([0.0; 3], 0.5, 8.0, 1.5));
        }
    }
}
