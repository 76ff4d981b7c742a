//! The print of the scene's cards: a title, an arrow up, an arrow to the right and a star. Every part of it looks
//! different in a mirror and upside down.

use super::print::Print;
use crate::drawing::shapes::{Anchor, Page, Stroke};
use crate::image::hex;
use std::f64::consts::TAU;

/// Width and height of a card in units of its print.
pub const GRID: [f32; 2] = [80.0, 66.0];

const PAPER: [f32; 3] = [0.88, 0.86, 0.80];
const INK: &str = "#262f55";
const RED: &str = "#ce3026";
const GREEN: &str = "#198b69";

/// Draws the print of a card with a title of up to nine letters.
pub fn print(title: &str) -> Print {
    let [width, height] = GRID.map(f64::from);
    let mut page = Page::on(hex(PAPER), width, height);
    let [line, none] = [1.0, 0.0].map(|width| Stroke::new(INK, width));
    let frame =
        |edge: f64| [[edge; 2], [width - edge, edge], [width - edge, height - edge], [edge, height - edge]];
    page.line(frame(2.5).into_iter().cycle().take(6), line);
    page.line([[6.0, 17.0], [74.0, 17.0]], line);
    page.text(title, [width / 2.0, 13.6], 13.0, Anchor::Middle, INK);
    // The corners run from the tip to the right, around the head and the shaft.
    let arrow = [[0.0, 0.0], [7.2, 9.0], [2.5, 9.0], [2.5, 30.0], [-2.5, 30.0], [-2.5, 9.0], [-7.2, 9.0]];
    page.area(arrow.map(|[x, y]| [14.0 + x, 21.0 + y]), RED, none);
    page.text("UP", [14.0, 62.0], 10.0, Anchor::Middle, RED);
    page.area(arrow.map(|[x, y]| [53.0 - y, 37.0 + x]), GREEN, none);
    page.text("RIGHT", [53.0, 62.0], 10.0, Anchor::Middle, GREEN);
    for ray in 0..16 {
        let at = |turn: f64| {
            let (sine, cosine) = (TAU * (f64::from(ray) + turn) / 16.0).sin_cos();
            [66.0 + 10.0 * cosine, 37.0 + 10.0 * sine]
        };
        page.area([[66.0, 37.0], at(0.0), at(0.5)], INK, none);
    }
    Print::of(&page)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn the_arrows_point_up_and_to_the_right_under_a_title() {
        let print = print("L");
        let at = |x: f32, y: f32| print.colour(Vec2::new(x, y)).max_position();
        let dark = |x: f32, y: f32| print.colour(Vec2::new(x, y)).element_sum() < 1.0;
        // The red arrow has a head and a shaft, and no head at its lower end.
        assert_eq!([at(19.0, 29.0), at(14.0, 45.0)], [0; 2]);
        assert!(dark(19.0, 29.0) && dark(14.0, 45.0) && !dark(19.0, 45.0));
        assert_eq!([at(45.0, 31.5), at(30.0, 37.0)], [1; 2]);
        assert!(dark(45.0, 31.5) && dark(30.0, 37.0) && !dark(25.0, 31.5));
        let ink = |columns: std::ops::Range<u8>, rows: std::ops::Range<u8>| {
            let samples =
                rows.flat_map(|y| columns.clone().map(move |x| [x, y].map(|at| f32::from(at) / 4.0)));
            samples.filter(|[x, y]| dark(*x, *y)).count()
        };
        // The first letter of the title has a stem at the left and a foot at the bottom.
        assert!(ink(148..160, 18..48) > 10 && ink(163..176, 18..48) == 0 && ink(161..172, 48..56) > 4);
    }
}
