//! What is printed on the scene's two cards: a title, an arrow up, an arrow to the right
//! and a star. Nothing of it looks the same in a mirror or upside down.

use crate::host::image::lettering::{self, LETTER as PIXELS};
use glam::{Vec2, Vec3};

/// The card's grid: one unit is one pixel of the title's letters.
pub const GRID: Vec2 = Vec2::new(80.0, 66.0);

/// Pixels of a letter, each way.
const LETTER: f32 = PIXELS as f32;
const PAPER: Vec3 = Vec3::new(0.88, 0.86, 0.80);
const INK: Vec3 = Vec3::new(0.02, 0.03, 0.09);
const RED: Vec3 = Vec3::new(0.62, 0.03, 0.02);
const GREEN: Vec3 = Vec3::new(0.01, 0.26, 0.14);

/// The colour at a place in grid units, x to the right and y down from the top left corner,
/// of a card with a title of up to nine letters.
pub fn colour(title: &str, at: Vec2) -> Vec3 {
    let edge = at.min(GRID - at).min_element();
    if (2.0..3.0).contains(&edge) || letters(title, at - start(title)) {
        return INK;
    }
    if (16.5..17.5).contains(&at.y) && (6.0..74.0).contains(&at.x) {
        return INK;
    }
    if arrow(at - Vec2::new(14.0, 21.0)) || letters("UP", at - Vec2::new(6.0, 54.0)) {
        return RED;
    }
    let sideways = at - Vec2::new(53.0, 37.0);
    if arrow(Vec2::new(sideways.y, -sideways.x)) || letters("RIGHT", at - Vec2::new(33.0, 54.0)) {
        return GREEN;
    }
    let from_star = at - Vec2::new(66.0, 37.0);
    let ray = from_star.to_angle() / std::f32::consts::TAU * 16.0;
    if from_star.length() < 10.0 && ray.rem_euclid(1.0) < 0.5 {
        return INK;
    }
    PAPER
}

/// Where a title begins that is centred at the top.
fn start(title: &str) -> Vec2 {
    Vec2::new((GRID.x - LETTER * title.len() as f32) / 2.0, 6.0)
}

/// An arrow whose tip is the origin and which points up: y grows down its shaft.
fn arrow(at: Vec2) -> bool {
    let head = at.y < 9.0 && at.x.abs() < at.y * 0.8;
    let shaft = (9.0..30.0).contains(&at.y) && at.x.abs() < 2.5;
    at.y > 0.0 && (head || shaft)
}

fn letters(text: &str, at: Vec2) -> bool {
    at.x >= 0.0 && at.y >= 0.0 && lettering::inked(text, at.x as usize, at.y as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_title_reads_from_left_to_right() {
        let rows: Vec<String> = (0..8)
            .map(|y| {
                let pixel = |x| start("Lr") + Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let ink = |x| {
                    if colour("Lr", pixel(x)) == INK { '#' } else { '.' }
                };
                (0..16).map(ink).collect()
            })
            .collect();
        assert_eq!(
            rows,
            [
                "####............",
                ".##.............",
                ".##.....##.###..",
                ".##......###.##.",
                ".##...#..##..##.",
                ".##..##..##.....",
                "#######.####....",
                "................",
            ]
        );
    }
}
