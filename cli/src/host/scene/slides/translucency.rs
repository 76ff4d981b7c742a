//! Translucency: a sheet of frosted glass in front of a card, which nearly touches the sheet, and of objects farther
//! behind.

use super::super::{Ball, Board, Finish, Material, Scene, props, tilted};
use glam::{Vec2, Vec3};

/// z of the sheet, mm.
const STAGE: f32 = 800.0;

pub fn scene() -> Scene {
    let ball = |x: f32, z: f32, radius: f32, colour: [f32; 3]| {
        Ball::standing([x, z], radius, Material::new(colour, Finish::Matte))
    };
    let frosted = Material::new([0.90, 0.96, 0.95], Finish::Sheet).rough(0.13);
    let sheet = Board::plain(Vec3::new(-60.0, 120.0, STAGE), Vec2::new(270.0, 272.0), frosted);
    let dark = Material::new([0.05, 0.045, 0.04], Finish::Matte);
    let bar = |x: f32, y: f32, width: f32, height: f32| {
        Board::plain(Vec3::new(x, y, STAGE - 1.0), Vec2::new(width, height), dark)
    };
    let frame = [
        bar(-66.0, 126.0, 282.0, 6.0),
        bar(-66.0, 126.0, 6.0, 281.0),
        bar(210.0, 126.0, 6.0, 281.0),
        bar(-66.0, -149.0, 282.0, 6.0),
    ];
    let near = props::card("near", Vec3::new(-185.0, 20.0, STAGE + 40.0), 190.0);
    let far = props::card("far", Vec3::new(70.0, 80.0, STAGE + 500.0), 230.0);
    Scene {
        balls: vec![
            ball(60.0, STAGE + 90.0, 45.0, [0.66, 0.11, 0.07]),
            ball(175.0, STAGE + 240.0, 50.0, [0.76, 0.39, 0.05]),
            ball(-240.0, STAGE + 420.0, 80.0, [0.02, 0.33, 0.35]),
        ],
        boards: [sheet].into_iter().chain(frame).chain(near).chain(far).collect(),
        lamps: Vec::new(),
        pose: tilted(3.0, [0.0, 10.0, 0.0]),
        subject: |_, _| STAGE + 40.0,
        ..props::scene()
    }
}
