//! What every camera does to a ray on its way out: its place in the world, its clip range, its time.

use glam::DVec3;

use super::{
    CameraMotion, CameraToWorld, WorldRay,
    block::{BLOCK, RayBlock},
};
use crate::trace::{Ray, Real};

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
    #[inline(always)]
    pub fn world_ray(&self, ray: Ray, units_per_mm: f64, time_number: f32) -> WorldRay {
        let time = self.time(time_number);
        let (origin, direction) = placed(&self.to_world.at(time), ray.origin, ray.direction, units_per_mm);
        WorldRay { origin, direction, mint: self.clip[0], maxt: self.clip[1], time }
    }

    /// [`Placement::world_ray`] of the first `n` rays of a block: all but the weights.
    #[inline(always)]
    pub fn world_rays<S: Real>(
        &self,
        origin: &[[S; BLOCK]; 3],
        direction: &[[S; BLOCK]; 3],
        units_per_mm: f64,
        time_numbers: &[f32; BLOCK],
        n: usize,
        rays: &mut RayBlock,
    ) {
        let n = n.min(BLOCK);
        for (time, number) in rays.time[..n].iter_mut().zip(time_numbers) {
            *time = self.time(*number);
        }
        rays.mint[..n].fill(self.clip[0]);
        rays.maxt[..n].fill(self.clip[1]);
        let RayBlock { origin: world_origin, direction: world_direction, time, .. } = rays;
        let [ox, oy, oz] = world_origin.each_mut().map(|array| &mut array[..n]);
        let [dx, dy, dz] = world_direction.each_mut().map(|array| &mut array[..n]);
        let lens_ray =
            |i: usize| [origin, direction].map(|[x, y, z]| [x[i].to_f64(), y[i].to_f64(), z[i].to_f64()]);
        match &self.to_world {
            CameraMotion::Still(to_world) => {
                // A copy, which no write can be thought to change.
                let to_world = *to_world;
                for i in 0..n {
                    let [o, d] = lens_ray(i);
                    ([ox[i], oy[i], oz[i]], [dx[i], dy[i], dz[i]]) = placed(&to_world, o, d, units_per_mm);
                }
            }
            moving @ CameraMotion::Moving(_) => {
                for i in 0..n {
                    let [o, d] = lens_ray(i);
                    ([ox[i], oy[i], oz[i]], [dx[i], dy[i], dz[i]]) =
                        placed(&moving.at(time[i]), o, d, units_per_mm);
                }
            }
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

/// A ray in lens space, mm, put into the world.
#[inline(always)]
fn placed(
    to_world: &CameraToWorld,
    origin: [f64; 3],
    direction: [f64; 3],
    units_per_mm: f64,
) -> ([f32; 3], [f32; 3]) {
    let origin = to_world.point(DVec3::from(origin) * units_per_mm);
    let direction = to_world.direction(DVec3::from(direction));
    (origin.as_vec3().into(), direction.as_vec3().into())
}
