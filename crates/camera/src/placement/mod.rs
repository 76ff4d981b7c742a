//! The camera's pose in the world, its motion, and its shutter: the last step of every camera's rays.
//!
//! [`Placement`] transforms rays in camera space, with times as fractions of the shutter's interval, to rays
//! in world space. With M the camera-to-world transform and s the units of camera space per millimetre, a ray
//! (o, d) of lens space becomes (M s o, M d/|M d|). `motion` interpolates M over time, and `interpolated`
//! does so in lanes. `to_world` performs the whole transform in lanes; `single` does the same with the
//! single-precision arithmetic of pbrt's stock cameras.

mod interpolated;
pub(crate) mod motion;
pub(crate) mod shutter;
mod single;
mod to_world;
pub(crate) mod transform;

use glam::DVec3;

use crate::{plan::Plan, rays::WorldRay};
use motion::CameraMotion;
use realistic_optics::trace::Ray;
use shutter::time_at;
use transform::CameraToWorld;

pub(crate) use single::{RangedRays, SingleToWorld};
pub(crate) use to_world::ToWorld;

/// A camera's pose in the world, and the range of distances along rays and the interval of time that it sees.
#[derive(Clone, Debug)]
pub struct Placement {
    pub to_world: CameraMotion,
    /// Start and end of rays, as distances along them in world units.
    pub clip: [f32; 2],
    /// Opening and closing time of the shutter, in either order: time runs from the first value to the
    /// second.
    pub shutter: [f32; 2],
}

impl Placement {
    /// Returns the time at a fraction of the shutter's interval.
    #[inline(always)]
    pub fn time(&self, number: f32) -> f32 {
        time_at(self.shutter, number)
    }

    /// Returns the world-space ray of a ray in lens space (mm).
    #[inline(always)]
    pub fn world_ray(&self, ray: Ray, units_per_mm: f64, time_number: f32) -> WorldRay {
        let time = self.time(time_number);
        let (origin, direction) = placed(&self.to_world.at(time), ray.origin, ray.direction, units_per_mm);
        WorldRay { origin, direction, mint: self.clip[0], maxt: self.clip[1], time }
    }

    /// Returns the world-space ray that starts at the origin of camera space and points straight ahead.
    pub fn axial_ray(&self, time_number: f32) -> WorldRay {
        self.world_ray(Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] }, 1.0, time_number)
    }

    /// Adds to a plan the items of time and pose that the camera keeps or leaves out.
    pub fn describe(&self, plan: &mut Plan) {
        let [open, close] = self.shutter;
        if open == close {
            plan.left_out(
                "interpolation of time",
                "the shutter opens and closes at once",
                "one time for all rays",
            );
        } else {
            plan.kept(
                "interpolation of time",
                format!("the shutter is open from {open} to {close}"),
                "a ray has its own time",
            );
        }
        match &self.to_world {
            CameraMotion::Moving(_) => {
                plan.kept(
                    "interpolation of the motion",
                    "the camera moves while the shutter is open",
                    "a transform per ray",
                );
            }
            CameraMotion::Still(to_world) => {
                plan.left_out(
                    "interpolation of the motion",
                    "the camera stands still",
                    "one transform for all rays",
                );
                if to_world.is_identity() {
                    plan.left_out("camera to world", "it is the identity", "rays stay as they are");
                } else {
                    plan.kept(
                        "camera to world",
                        "it is not the identity",
                        "a 3 x 3 matrix and a move; nothing is divided by w",
                    );
                    plan.kept(
                        "making directions unit vectors",
                        "entries are floats: even a rotation is one to 1e-7 only",
                        "unit directions",
                    );
                }
            }
        }
    }
}

/// Transforms a ray in lens space, mm, to the world.
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
