//! Soft shadows: posts and balls in the light of a large lamp low on one side. A shadow is sharp next to its object
//! and becomes blurred farther away.

use super::super::{Ball, FLOOR, Finish, Material, Scene, Sphere, Sun, props, tilted};
use glam::Vec3;

pub fn scene() -> Scene {
    let ball = |x: f32, height: f32, z: f32, radius: f32, colour: [f32; 3]| {
        let material = Material::new(colour, Finish::Matte);
        Ball::new(Sphere::resting(Vec3::new(x, FLOOR.height + height + radius, z), radius), material)
    };
    let posts = (0..5_u8).map(|k| props::pole(-230.0 + 62.0 * f32::from(k), 1150.0, 190.0, 16.0));
    Scene {
        floor: |_| Material::new([0.62, 0.60, 0.56], Finish::Matte),
        balls: vec![
            ball(-40.0, 0.0, 880.0, 42.0, [0.66, 0.11, 0.07]),
            ball(90.0, 95.0, 960.0, 42.0, [0.76, 0.39, 0.05]),
            ball(-170.0, 0.0, 800.0, 26.0, [0.02, 0.33, 0.35]),
        ],
        boards: posts.collect(),
        lamps: Vec::new(),
        sun: Sun { towards: Vec3::new(-0.55, 0.62, 0.62), radius: 0.16 },
        pose: tilted(13.0, [0.0, 120.0, 0.0]),
        subject: |_, _| 900.0,
        ..props::scene()
    }
}
