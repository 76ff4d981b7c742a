//! What every camera does to a ray on its way out: its place in the world, its clip range, its time.

use glam::DVec3;

use super::{CameraMotion, WorldRay};
use crate::trace::Ray;

/// A camera's place in the world, and the part of a ray and of time that it sees.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    pub to_world: CameraMotion,
    /// World units along a ray: where it begins and ends.
    pub clip: [f32; 2],
    /// When the shutter opens and closes.
    pub shutter: [f32; 2],
}

impl Placement {
    /// The time that a time number in [0, 1] stands for. In this form both ends are met exactly.
    pub fn time(&self, number: f32) -> f32 {
        let [open, close] = self.shutter;
        (1.0 - number) * open + number * close
    }

    /// The world-space ray of one in lens space, which is in mm.
    pub fn world_ray(&self, ray: Ray, units_per_mm: f64, time_number: f32) -> WorldRay {
        let time = self.time(time_number);
        let to_world = self.to_world.at(time);
        let origin = to_world.point(DVec3::from(ray.origin) * units_per_mm);
        let direction = to_world.direction(DVec3::from(ray.direction));
        WorldRay {
            origin: origin.as_vec3().into(),
            direction: direction.as_vec3().into(),
            mint: self.clip[0],
            maxt: self.clip[1],
            time,
        }
    }

    /// The world-space ray of a camera-space one in world units, in single precision and in the order
    /// of pbrt's sums; `range` is where it begins and ends in camera space.
    pub fn world_ray_single(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        range: [f32; 2],
        time_number: f32,
    ) -> WorldRay {
        let time = self.time(time_number);
        let to_world = self.to_world.at(time);
        let (direction, stretch) = to_world.direction_single(direction);
        let [mint, maxt] = range.map(|length| length * stretch);
        WorldRay { origin: to_world.point_single(origin), direction, mint, maxt, time }
    }
}
