//! The objects of the built-in scene: a card to focus on and two balls beside it at the same distance; balls nearer
//! and farther away; a sign at eight metres on the axis, for lenses too long for the card; lamps behind, whose images
//! become out-of-focus disks.

use super::card;
use super::objects::{Ball, Board, FLOOR, Finish, Lamps, Material};
use super::pose::LEVEL;
use super::shapes::{Panel, Sphere};
use super::sky::Sun;
use super::world::{Light, Scene};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The top left corner of the card.
const CARD: Vec3 = Vec3::new(-270.0, 10.0, 1000.0);
/// The top left corner of the sign.
const SIGN: Vec3 = Vec3::new(-240.0, 262.0, 8000.0);

/// Makes the built-in scene.
pub fn scene() -> Scene {
    Scene {
        floor: tiles,
        floor_roughness: 0.03,
        balls: balls(),
        boards: boards(),
        solids: Arc::default(),
        lamps: lamps().into(),
        panes: Vec::new(),
        light: Light::Day,
        sun: Sun::EVENING,
        pose: LEVEL,
        subject,
    }
}

/// Returns the z of the default subject: the card, or the sign if the whole card does not fit on the film.
fn subject(focal_length: f64, film_diagonal: f64) -> f32 {
    let seen = film_diagonal / 2.0 / focal_length * f64::from(CARD.z);
    let fits = seen > f64::from(CARD.truncate().length());
    if fits { CARD.z } else { SIGN.z }
}

/// Returns the material of the floor's squares.
fn tiles(point: Vec3) -> Material {
    const SIDE: f32 = 155.0;
    let odd = ((point.x / SIDE).floor() + (point.z / SIDE).floor()).rem_euclid(2.0) > 0.5;
    let colour = if odd { [0.60, 0.55, 0.46] } else { [0.08, 0.13, 0.18] };
    Material::new(colour, Finish::Coated)
}

/// Distance from one pole to the next, mm.
const SPAN: f32 = 5200.0;

/// Makes the cards, and poles for the nearer string of lamps.
fn boards() -> Vec<Board> {
    let spans = [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5];
    let poles = spans.map(|span| pole(span * SPAN, 7010.0, 1980.0, 34.0));
    let cards = [card("realistic", CARD, 196.0), card("8 metres", SIGN, 480.0)];
    cards.into_iter().flatten().chain(poles).collect()
}

/// Makes two strings of lamps and a town.
fn lamps() -> [Lamps; 3] {
    [string(7000.0, 23.0, 410.0, [570.0, 1820.0]), string(12_000.0, 38.0, 640.0, [620.0, 1500.0]), town()]
}

/// Makes a card with its legs.
pub fn card(title: &str, corner: Vec3, width: f32) -> [Board; 3] {
    let [columns, rows] = card::GRID;
    let size = Vec2::new(width, width * rows / columns);
    let leg =
        |part| pole(corner.x + part * width, corner.z + 1.0, corner.y - FLOOR.height - 1.0, width / 30.0);
    let panel = Panel { corner, size };
    let print = Some(Arc::new(card::print(title)));
    let material = Material::new(Vec3::ONE, Finish::Matte);
    [Board { panel, print, material }, leg(0.15), leg(0.85)]
}

/// Makes a flat pole on the floor.
pub fn pole(x: f32, z: f32, height: f32, width: f32) -> Board {
    let corner = Vec3::new(x - width / 2.0, FLOOR.height + height, z);
    Board::plain(corner, Vec2::new(width, height), Material::new([0.11, 0.09, 0.08], Finish::Matte))
}

/// Makes balls on the floor, given by x, z, radius, colour and finish.
fn balls() -> Vec<Ball> {
    use Finish::{Coated, Glass, Metal};
    const CORAL: [f32; 3] = [0.66, 0.11, 0.07];
    const TEAL: [f32; 3] = [0.02, 0.33, 0.35];
    const AMBER: [f32; 3] = [0.76, 0.39, 0.05];
    const PLUM: [f32; 3] = [0.30, 0.08, 0.34];
    const CREAM: [f32; 3] = [0.76, 0.70, 0.60];
    const LEAF: [f32; 3] = [0.15, 0.36, 0.08];
    const GOLD: [f32; 3] = [0.95, 0.68, 0.28];
    const CHROME: [f32; 3] = [0.86, 0.87, 0.90];
    const CLEAR: [f32; 3] = [0.97, 0.99, 0.98];
    [
        // Balls in focus with the card.
        (50.0, 990.0, 46.0, CLEAR, Glass),
        (190.0, 1015.0, 64.0, CHROME, Metal),
        // Nearer balls.
        (136.0, 490.0, 45.0, CORAL, Coated),
        (-320.0, 620.0, 70.0, AMBER, Coated),
        (430.0, 690.0, 92.0, TEAL, Coated),
        (-600.0, 330.0, 120.0, PLUM, Coated),
        (640.0, 200.0, 130.0, GOLD, Metal),
        // Farther balls.
        (-170.0, 1800.0, 74.0, GOLD, Metal),
        (390.0, 1640.0, 100.0, TEAL, Coated),
        (-820.0, 1600.0, 190.0, CORAL, Coated),
        (500.0, 3000.0, 150.0, AMBER, Coated),
        (1300.0, 2100.0, 260.0, CREAM, Coated),
        (-800.0, 4200.0, 240.0, PLUM, Coated),
        (1500.0, 5600.0, 330.0, CORAL, Coated),
        (-335.0, 8110.0, 85.0, CORAL, Coated),
        (345.0, 8000.0, 100.0, TEAL, Coated),
        (-2300.0, 9500.0, 520.0, TEAL, Coated),
        (950.0, 10_000.0, 280.0, CREAM, Coated),
        (-2600.0, 3000.0, 480.0, LEAF, Coated),
        (3400.0, 4100.0, 560.0, PLUM, Coated),
        // Balls behind the camera, which are visible in mirrors.
        (-500.0, -1300.0, 330.0, AMBER, Coated),
        (900.0, -1800.0, 420.0, LEAF, Coated),
    ]
    .map(|(x, z, radius, colour, finish)| {
        let roughness = match finish {
            Glass => 0.08,
            Metal => 0.06,
            _ => 0.0,
        };
        let material = Material::new(colour, finish).rough(roughness);
        // One ball rolls past the card if the balls may move.
        let mut ball = Ball::standing([x, z], radius, material);
        if colour == CORAL && z < 500.0 {
            ball.shape.velocity = Vec3::new(-60.0, 0.0, 25.0);
        }
        ball
    })
    .into()
}

/// Makes lamps on a line that hangs between a low and a high point in every span between poles.
fn string(z: f32, radius: f32, pitch: f32, [low, high]: [f32; 2]) -> Lamps {
    const WARM: [[f32; 3]; 3] = [[13.0, 7.4, 2.6], [13.0, 4.2, 1.5], [11.0, 8.8, 5.0]];
    let count = (3.0 * SPAN / pitch) as i32;
    let hang = |index: i32| {
        let x = (index as f32 + 0.25) * pitch;
        let across = (x / SPAN + 0.5).rem_euclid(1.0) * 2.0 - 1.0;
        let y = low + (high - low) * across * across;
        let colour = WARM[index.rem_euclid(3) as usize];
        lamp(Vec3::new(x, y, z), radius, colour)
    };
    (-count / 2..=count / 2).map(hang).collect()
}

/// Makes the lights of a town in front of the hills, close together on the axis.
fn town() -> Lamps {
    const TINTS: [[f32; 3]; 4] = [[7.0, 4.4, 1.6], [2.2, 4.8, 7.0], [7.5, 2.0, 1.2], [6.5, 5.9, 4.4]];
    let placed_lamp = |index: u8| {
        // Steps by the golden ratio and the plastic number give no visible pattern.
        let step = f32::from(index);
        let (a, b) = ((step * 0.618_034).fract(), (step * 0.754_878).fract());
        let z = 22_000.0 + 14_000.0 * b;
        let aside = 2.0 * a - 1.0;
        let x = 0.6 * aside * aside.abs() * z;
        let y = (0.003 + 0.03 * (a * 11.0 + b).fract()) * z;
        lamp(Vec3::new(x, y, z), 75.0, TINTS[usize::from(index % 4)])
    };
    (0..64).map(placed_lamp).collect()
}

fn lamp(centre: Vec3, radius: f32, colour: [f32; 3]) -> Ball {
    Ball::new(Sphere::resting(centre, radius), Material::new(colour, Finish::Lamp))
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{MID_SHUTTER, Ray};
    use super::*;
    use glam::Vec2;

    fn visible_colour(scene: &Scene, x: f32, y: f32, z: f32) -> Vec3 {
        let target = Vec3::new(x, y, z);
        let ray = Ray { origin: Vec3::ZERO, direction: target.normalize(), time: MID_SHUTTER };
        let (hit, material) = scene.nearest(&ray, 0.0).unwrap();
        assert!((ray.at(hit.distance) - target).length() < 1.0, "something stands before the card");
        material.colour
    }

    #[test]
    fn the_card_reads_from_left_to_right_and_stands_on_its_foot() {
        let scene = scene();
        let Panel { corner, size } = scene.boards[0].panel;
        let print = scene.boards[0].print.as_ref().unwrap();
        let [columns, rows] = card::GRID.map(|side| side as u8);
        let unit = size.x / f32::from(columns);
        for row in 0..rows {
            for column in 0..columns {
                let (right, down) = (f32::from(column) + 0.3, f32::from(row) + 0.35);
                let seen = visible_colour(&scene, corner.x + right * unit, corner.y - down * unit, corner.z);
                let printed = print.colour(Vec2::new(right, down));
                assert!((seen - printed).length() < 0.01, "column {column}, row {row}: {seen}, {printed}");
            }
        }
    }

    #[test]
    fn long_lenses_look_at_the_sign() {
        let subject = |focal_length| (scene().subject)(focal_length, 35.0);
        assert_eq!([10.0, 22.0, 50.0].map(subject), [1000.0; 3]);
        assert_eq!([100.0, 254.0].map(subject), [8000.0; 2]);
    }

    #[test]
    fn the_cards_stand_free_of_the_floor_and_the_balls() {
        let scene = scene();
        for Board { panel, .. } in scene.boards.iter().filter(|board| board.print.is_some()) {
            assert!(panel.corner.y - panel.size.y > FLOOR.height);
        }
        let shapes: Vec<Sphere> = scene.balls.iter().map(|ball| ball.shape).collect();
        for (index, a) in shapes.iter().enumerate() {
            for b in &shapes[index + 1..] {
                let gap = a.centre.distance(b.centre) - a.radius - b.radius;
                assert!(gap > 0.0, "{a:?} and {b:?} overlap");
            }
        }
    }
}
