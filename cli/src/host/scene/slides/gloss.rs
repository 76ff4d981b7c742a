//! Gloss: a card on a floor of brushed metal, whose reflections are sharp for objects near the floor and blurred for
//! objects higher up.

use super::super::{Ball, Finish, Light, Material, Scene, Sun, props, tilted};
use glam::Vec3;
use std::sync::Arc;

/// z of the card and the balls, mm.
const STAGE: f32 = 1100.0;

pub fn scene() -> Scene {
    Scene {
        floor: metal,
        floor_roughness: 0.04,
        balls: vec![
            Ball::standing(
                [165.0, STAGE],
                70.0,
                Material::new([0.90, 0.91, 0.93], Finish::Metal).rough(0.12),
            ),
            Ball::standing([75.0, STAGE - 170.0], 32.0, Material::new([0.66, 0.11, 0.07], Finish::Matte)),
            Ball::standing([-255.0, STAGE + 240.0], 60.0, Material::new([0.76, 0.39, 0.05], Finish::Matte)),
        ],
        boards: props::card("gloss", Vec3::new(-215.0, 45.0, STAGE), 200.0).into(),
        solids: Arc::default(),
        lamps: Vec::new(),
        panes: Vec::new(),
        light: Light::Day,
        sun: Sun { radius: 0.15, ..Sun::EVENING },
        pose: tilted(10.5, [-10.0, 60.0, 0.0]),
        subject: |_, _| STAGE,
    }
}

fn metal(_: Vec3) -> Material {
    Material::new([0.62, 0.63, 0.66], Finish::Metal)
}
