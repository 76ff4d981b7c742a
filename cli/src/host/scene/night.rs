//! The scene at night: a card and matte balls in the light of one lamp outside the picture, and many small lamps in
//! the dark, far behind the plane in focus.

use super::objects::{Ball, Finish, Lamps, Material};
use super::pose::LEVEL;
use super::props;
use super::shapes::Sphere;
use super::world::{Light, Scene};
use glam::Vec3;

/// z of the card, mm.
const STAGE: f32 = 1000.0;

/// Makes the scene at night, which has neither mirrors nor glass.
pub fn scene() -> Scene {
    let matte = |colour: [f32; 3]| Material::new(colour, Finish::Matte);
    Scene {
        floor: |_| Material::new([0.42, 0.40, 0.38], Finish::Matte),
        floor_roughness: 0.0,
        balls: vec![
            Ball::standing([150.0, 1020.0], 64.0, matte([0.66, 0.11, 0.07])),
            Ball::standing([-20.0, 1500.0], 90.0, matte([0.76, 0.39, 0.05])),
            Ball::standing([-420.0, 1900.0], 140.0, matte([0.02, 0.33, 0.35])),
        ],
        boards: props::card("realistic", Vec3::new(-270.0, 10.0, STAGE), 196.0).into(),
        lamps: vec![
            street(),
            town(),
            [lamp(Vec3::new(-650.0, 900.0, 350.0), 60.0, [90.0, 82.0, 70.0])].into_iter().collect(),
        ],
        light: Light::Lamps,
        pose: LEVEL,
        subject: |_, _| STAGE,
        ..props::scene()
    }
}

const COLOURS: [[f32; 3]; 5] =
    [[1.0, 0.55, 0.2], [1.0, 0.8, 0.5], [0.3, 0.6, 1.0], [1.0, 0.25, 0.15], [0.35, 0.9, 0.4]];

/// Makes two rows of lamps that lead away from the camera.
fn street() -> Lamps {
    let placed_lamp = |index: u8| {
        let (side, step) = (f32::from(index % 2) * 2.0 - 1.0, f32::from(index / 2));
        let z = 3000.0 + 900.0 * step;
        let colour = Vec3::from(COLOURS[usize::from(index % 2)]) * 900.0;
        lamp(Vec3::new(side * 1100.0 - 0.05 * z, 750.0, z), 4.0, colour.to_array())
    };
    (0..20).map(placed_lamp).collect()
}

/// Makes the lights of a town, which are a few millimetres large, like those of the street.
fn town() -> Lamps {
    let placed_lamp = |index: u8| {
        let step = f32::from(index);
        let (a, b) = ((step * 0.618_034).fract(), (step * 0.754_878).fract());
        let z = 9000.0 + 9000.0 * b;
        let colour = Vec3::from(COLOURS[usize::from(index) % 5]) * 3500.0;
        lamp(
            Vec3::new((a - 0.5) * 0.75 * z, (0.02 + 0.2 * (a * 7.0 + b).fract()) * z, z),
            6.0,
            colour.to_array(),
        )
    };
    (0..40).map(placed_lamp).collect()
}

fn lamp(centre: Vec3, radius: f32, colour: [f32; 3]) -> Ball {
    Ball::new(Sphere::resting(centre, radius), Material::new(colour, Finish::Lamp))
}
