//! The light of lamps only, by path tracing from the camera. A path shows the lamps that it meets, and up to two
//! matte surfaces, each lit by one point of one lamp. Paths from the lamps use [`Lights`], too.

use super::shade::ShadingSample;
use crate::host::scene::shapes::Ray;
use crate::host::scene::{Finish, Material, Scene, Sphere};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Largest number of matte surfaces on a path between a lamp and the camera. Up to this number, the samples of a path
/// from the camera are independent.
pub const REFLECTIONS: u32 = 2;
/// Distance from the start of a ray, mm, within which the ray meets nothing.
pub const START: f32 = 0.05;

/// The lamps of a scene, chosen by their power.
pub struct Lights {
    lamps: Vec<(Sphere, Vec3)>,
    /// Cumulative shares of the power.
    shares: Vec<f32>,
}

/// A point of a lamp.
#[derive(Clone, Copy)]
pub struct LampPoint {
    /// Position of the point.
    pub point: Vec3,
    /// Normal of the surface at the point.
    pub normal: Vec3,
    /// Radiance in every direction outward.
    pub radiance: Vec3,
    /// Probability density per area, 1/mm², which includes the choice of lamps by power.
    pub density: f32,
}

impl Lights {
    /// Prepares the lamps of a scene that is lit by them.
    pub fn of(scene: &Scene) -> Self {
        let lamps: Vec<(Sphere, Vec3)> = scene
            .lamps
            .iter()
            .flat_map(|group| &group.lamps)
            .map(|lamp| (lamp.shape, lamp.material.colour))
            .collect();
        let power =
            |(sphere, radiance): &(Sphere, Vec3)| radiance.element_sum() * sphere.radius * sphere.radius;
        let total: f32 = lamps.iter().map(power).sum();
        let mut sum = 0.0;
        let shares = lamps
            .iter()
            .map(|lamp| {
                sum += power(lamp);
                sum / total
            })
            .collect();
        Self { lamps, shares }
    }

    /// Returns the index of a lamp for a number in [0, 1), the position of the number in that lamp's share, and the
    /// share.
    fn choose(&self, number: f32) -> (usize, f32, f32) {
        let index = self.shares.partition_point(|share| *share <= number).min(self.shares.len() - 1);
        let before = if index == 0 { 0.0 } else { self.shares[index - 1] };
        let share = self.shares[index] - before;
        (index, ((number - before) / share).clamp(0.0, 1.0), share)
    }

    /// Samples a point anywhere on a lamp.
    pub fn point(&self, choice: f32, [u, v]: [f32; 2]) -> LampPoint {
        let (index, _, share) = self.choose(choice);
        let (sphere, radiance) = self.lamps[index];
        let height = 1.0 - 2.0 * u;
        let (sin, cos) = (TAU * v).sin_cos();
        let level = (1.0 - height * height).max(0.0).sqrt();
        let normal = Vec3::new(level * cos, level * sin, height);
        let density = share / (4.0 * PI * sphere.radius * sphere.radius);
        LampPoint { point: sphere.centre + sphere.radius * normal, normal, radiance, density }
    }

    /// Returns the irradiance of a matte surface from one direction within the cone that one lamp fills, divided by
    /// the direction's density.
    fn irradiance(&self, scene: &Scene, point: Vec3, normal: Vec3, time: f32, [u, v]: [f32; 2]) -> Vec3 {
        let (index, u, share) = self.choose(u);
        let (sphere, radiance) = self.lamps[index];
        let towards = sphere.centre - point;
        let square = towards.length_squared();
        let sine_squared = sphere.radius * sphere.radius / square;
        if sine_squared >= 1.0 {
            return Vec3::ZERO;
        }
        // 1 - cos of the cone's half-angle, and of the direction's angle from the axis.
        let cone = sine_squared / (1.0 + (1.0 - sine_squared).sqrt());
        let down = u * cone;
        let level = (down * (2.0 - down)).sqrt();
        let axis = towards / square.sqrt();
        let (side, up) = axis.any_orthonormal_pair();
        let (sin, cos) = (TAU * v).sin_cos();
        let direction = (1.0 - down) * axis + level * (cos * side + sin * up);
        let cosine = normal.dot(direction);
        if cosine <= 0.0 {
            return Vec3::ZERO;
        }
        let shadow = Ray { origin: point, direction, time };
        let nearest = square.sqrt() - 1.5 * sphere.radius;
        match scene.nearest(&shadow, START) {
            Some((hit, material)) if material.finish != Finish::Lamp || hit.distance < nearest => Vec3::ZERO,
            _ => radiance * cosine * TAU * cone / share,
        }
    }

    /// Returns the radiance along a ray from the camera.
    pub fn radiance(&self, scene: &Scene, ray: &Ray, sample: ShadingSample) -> Vec3 {
        let Some((hit, material)) = scene.nearest(ray, 0.0) else { return Vec3::ZERO };
        if material.finish == Finish::Lamp {
            return material.colour;
        }
        let (mut ray, mut hit, mut material) = (*ray, hit, material);
        let (mut sum, mut through) = (Vec3::ZERO, Vec3::ONE);
        for reflection in 1..=REFLECTIONS {
            let normal = hit.normal;
            if normal.dot(ray.direction) >= 0.0 {
                break;
            }
            let point = ray.at(hit.distance);
            through *= material.colour;
            sum += through * self.irradiance(scene, point, normal, ray.time, sample.light) / PI;
            if reflection == REFLECTIONS {
                break;
            }
            ray = Ray { origin: point, direction: scattered(normal, sample.facet), time: ray.time };
            match scene.nearest(&ray, START) {
                Some((next, of)) if of.finish != Finish::Lamp => (hit, material) = (next, of),
                _ => break,
            }
        }
        sum
    }
}

/// Samples a direction from a matte surface, in proportion to the cosine.
pub fn scattered(normal: Vec3, [u, v]: [f32; 2]) -> Vec3 {
    let (side, up) = normal.any_orthonormal_pair();
    let (sin, cos) = (TAU * v).sin_cos();
    (u.sqrt() * (cos * side + sin * up) + (1.0 - u).max(0.0).sqrt() * normal).normalize()
}

/// Returns a finish in a lamplit scene that paths from the lamps cannot show, if there is one.
pub fn not_matte(scene: &Scene) -> Option<Finish> {
    let is_left = |material: &Material| !matches!(material.finish, Finish::Matte | Finish::Lamp);
    let floor = (scene.floor)(Vec3::ZERO);
    let balls = scene.balls.iter().map(|ball| ball.material);
    let boards = scene.boards.iter().map(|board| board.material);
    [floor].into_iter().chain(balls).chain(boards).find(is_left).map(|material| material.finish)
}
