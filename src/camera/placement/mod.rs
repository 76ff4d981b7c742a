//! The camera's pose in the world, its motion, and its shutter: what every camera does to a ray on its way out.
//!
//! In come rays in camera space and times as fractions of the shutter's interval, out go rays in world space ([`Placement`]). With
//! M the camera-to-world transform and s units of camera space per millimetre, a ray (o, d) of lens space becomes (M s o, M d/|M d|); `motion`
//! interpolates M over time, `interpolated` in lanes. `to_world` is the whole in lanes, `single` the same with the
//! single-precision arithmetic of pbrt's stock cameras.

mod interpolated;
pub(crate) mod motion;
pub(crate) mod shutter;
mod single;
mod to_world;
pub(crate) mod transform;

use glam::DVec3;

use crate::{camera::rays::WorldRay, plan::Plan, trace::Ray};
use motion::CameraMotion;
use shutter::time_at;
use transform::CameraToWorld;

pub(crate) use single::{RangedRays, SingleToWorld};
pub(crate) use to_world::ToWorld;

/// A camera's place in the world, and the part of a ray and of time that it sees.
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    pub to_world: CameraMotion,
    /// World units along a ray: where it begins and ends.
    pub clip: [f32; 2],
    /// When the shutter opens and closes, in either order: time runs from the first to the second.
    pub shutter: [f32; 2],
}

impl Placement {
    /// The time that a fraction of the shutter's interval is.
    #[inline(always)]
    pub fn time(&self, number: f32) -> f32 {
        time_at(self.shutter, number)
    }

    /// The world-space ray of one in lens space, which is in mm.
    #[inline(always)]
    pub fn world_ray(&self, ray: Ray, units_per_mm: f64, time_number: f32) -> WorldRay {
        let time = self.time(time_number);
        let (origin, direction) = placed(&self.to_world.at(time), ray.origin, ray.direction, units_per_mm);
        WorldRay { origin, direction, mint: self.clip[0], maxt: self.clip[1], time }
    }

    /// The world-space ray from camera space's origin straight ahead.
    pub fn axial_ray(&self, time_number: f32) -> WorldRay {
        self.world_ray(Ray { origin: [0.0; 3], direction: [0.0, 0.0, 1.0] }, 1.0, time_number)
    }

    /// Adds what is kept and left out of time and the place in the world to a plan.
    pub(crate) fn describe(&self, plan: &mut Plan) {
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

/// A ray in lens space, mm, put into the world.
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
