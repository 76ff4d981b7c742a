//! Motion blur: billiard balls, some of them rolling, in the spirit of Cook's "1984". The shadows of rolling balls
//! are blurred as well, and so are the reflections of other balls in them.

use super::super::{Ball, Finish, Material, Paint, Scene, Sun, print::Print, props, tilted};
use crate::drawing::shapes::{Anchor, Page};
use crate::image::hex;
use glam::{Vec2, Vec3};
use std::sync::Arc;

const RADIUS: f32 = 56.0;
const WHITE: Vec3 = Vec3::new(0.80, 0.78, 0.70);
const YELLOW: Vec3 = Vec3::new(0.80, 0.46, 0.02);
const PURPLE: Vec3 = Vec3::new(0.16, 0.03, 0.26);
const BLACK: Vec3 = Vec3::new(0.012, 0.012, 0.014);

pub fn scene() -> Scene {
    let ball = |x: f32, z: f32, [vx, vz]: [f32; 2], paint: Option<Paint>| {
        let mut ball = Ball::standing([x, z], RADIUS, Material::new(WHITE, Finish::Coated));
        ball.shape.velocity = Vec3::new(vx, 0.0, vz);
        Ball { paint, ..ball }
    };
    Scene {
        floor: |_| Material::new([0.015, 0.16, 0.075], Finish::Matte),
        balls: vec![
            ball(-225.0, 965.0, [0.0, 0.0], Some(painted("1", YELLOW, None))),
            ball(-90.0, 1045.0, [62.0, 34.0], Some(painted("9", WHITE, Some(YELLOW)))),
            ball(72.0, 1090.0, [24.0, 70.0], Some(painted("8", BLACK, None))),
            ball(186.0, 965.0, [80.0, -6.0], Some(painted("4", PURPLE, None))),
            ball(15.0, 815.0, [-12.0, -36.0], None),
        ],
        boards: Vec::new(),
        lamps: Vec::new(),
        sun: Sun { towards: Vec3::new(-0.6, 0.9, -0.1), radius: 0.06 },
        pose: tilted(14.0, [0.0, 130.0, 0.0]),
        subject: |_, _| 930.0,
        ..props::scene()
    }
}

/// Returns the paint of a ball: a disk with its number that faces up and forward, and a band around the ball.
fn painted(number: &str, colour: Vec3, band: Option<Vec3>) -> Paint {
    const SIDE: f32 = 24.0;
    let mut page = Page::on(hex(WHITE.to_array()), SIDE.into(), SIDE.into());
    page.text(number, [12.0, 17.8], 16.0, Anchor::Middle, &hex(BLACK.to_array()));
    let print = Print::of(&page);
    let forward = Vec3::new(0.12, 0.45, -0.88).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = forward.cross(right);
    Arc::new(move |at| {
        let position = Vec2::new(at.dot(right), at.dot(up)) / 0.72;
        match band {
            _ if at.dot(forward) > 0.0 && position.length() < 0.5 => print.colour((position + 0.5) * SIDE),
            Some(band) if at.y.abs() < 0.55 => band,
            _ => colour,
        }
    })
}
