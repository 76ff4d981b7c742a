//! Colour errors: the corner of a picture, with a bright window, stars, and lamps out of focus, rendered with one
//! wavelength and with several.

use super::super::{Ball, Board, Finish, Lamps, Material, Scene, Sphere, props};
use glam::{Vec2, Vec3};

/// Distance of the plane in focus, mm.
const STAGE: f32 = 4000.0;
/// Middle and width of the visible part, in the scene at that distance.
const MIDDLE: Vec2 = Vec2::new(641.5, 425.0);
const SHOWN: f32 = 88.0;

pub fn scene() -> Scene {
    let position = |x: f32, y: f32, z: f32| (MIDDLE + Vec2::new(x, y) * SHOWN).extend(STAGE) * (z / STAGE);
    let lit = |light: [f32; 3]| Material::new(light, Finish::Lamp);
    let lamp = |x: f32, y: f32, z: f32, radius: f32, light: f32| {
        Ball::new(Sphere::resting(position(x, y, z), radius), lit([light; 3]))
    };
    let pane = |k: u8| {
        let (x, y) = (f32::from(k % 2), f32::from(k / 2));
        let corner = position(-0.44 + 0.17 * x, 0.27 - 0.19 * y, STAGE);
        Board::plain(corner, Vec2::new(0.15, 0.17) * SHOWN, lit([0.5; 3]))
    };
    let corner = Vec3::new(-20_000.0, 20_000.0, 12_000.0);
    let night = Board::plain(corner, Vec2::splat(40_000.0), lit([0.004, 0.005, 0.008]));
    let stars = (0..20_u8).map(|k| {
        let (x, y) = (f32::from(k % 5), f32::from(k / 5));
        lamp(-0.02 + 0.11 * x, 0.28 - 0.1 * y, STAGE, 0.55, 1.6)
    });
    let near = (0..3_u8).map(|k| lamp(0.05 + 0.17 * f32::from(k), -0.2, 0.8 * STAGE, 1.3, 2.2));
    let far = (0..2_u8).map(|k| lamp(-0.38 + 0.2 * f32::from(k), -0.24, 1.3 * STAGE, 1.8, 2.2));
    Scene {
        floor: |_| Material::new(Vec3::ZERO, Finish::Lamp),
        balls: Vec::new(),
        boards: (0..4).map(pane).chain([night]).collect(),
        lamps: vec![stars.collect::<Lamps>(), near.collect(), far.collect()],
        subject: |_, _| STAGE,
        ..props::scene()
    }
}
