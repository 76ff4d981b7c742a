//! The built-in scene as a renderer sees it: what a ray meets, and what hides the light.
//! Millimetres, the lens' front vertex at the origin, +z into the scene, +x to the right,
//! +y up.

use super::shapes::{Bounds, Floor, Hit, Panel, Ray, Shape, Sphere};
use super::{card, props};
use glam::Vec3;

/// What everything stands on.
pub const FLOOR: Floor = Floor { height: -155.0 };

/// How a surface sends light on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finish {
    /// In all directions.
    Matte,
    /// In all directions under a clear coat, which reflects.
    Coated,
    /// As a mirror, tinted.
    Metal,
    /// Through and off, as glass.
    Glass,
    /// It shines by itself.
    Lamp,
}

/// Colour and finish at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflectance, or radiance of a lamp.
    pub colour: Vec3,
    /// What it does with light.
    pub finish: Finish,
}

/// A ball of one material.
pub struct Ball {
    /// Where it is.
    pub shape: Sphere,
    /// What it is of.
    pub material: Material,
}

/// An upright board; with a title it is one of the cards.
pub struct Board {
    /// Where it is.
    pub panel: Panel,
    /// What is written over the arrows.
    pub title: Option<&'static str>,
}

/// Lamps that lie close together.
pub struct Lamps {
    bounds: Bounds,
    lamps: Vec<Ball>,
}

impl FromIterator<Ball> for Lamps {
    fn from_iter<I: IntoIterator<Item = Ball>>(lamps: I) -> Self {
        let lamps: Vec<Ball> = lamps.into_iter().collect();
        Self { bounds: Bounds::around(lamps.iter().map(|lamp| &lamp.shape)), lamps }
    }
}

/// The whole scene.
pub struct Scene {
    balls: Vec<Ball>,
    boards: Vec<Board>,
    lamps: [Lamps; 3],
}

impl Scene {
    /// Puts everything in its place.
    pub fn new() -> Self {
        Self { balls: props::balls(), boards: props::boards(), lamps: props::lamps() }
    }

    /// The z of what a lens of this focal length would be focused on: the card, or the sign
    /// when the film is too small for the whole card.
    pub fn subject(focal_length: f64, film_diagonal: f64) -> f32 {
        let seen = film_diagonal / 2.0 / focal_length * f64::from(props::CARD.z);
        let fits = seen > f64::from(props::CARD.truncate().length());
        if fits { props::CARD.z } else { props::SIGN.z }
    }

    /// The nearest surface that a ray meets beyond `from`.
    pub fn nearest(&self, ray: &Ray, from: f32) -> Option<(Hit, Material)> {
        let mut best: Option<(Hit, Material)> = None;
        let mut meet = |shape: &dyn Shape, material: &dyn Fn(Vec3) -> Material| {
            let to = best.map_or(f32::INFINITY, |(hit, _)| hit.distance);
            if let Some(hit) = shape.meet(ray, from, to) {
                best = Some((hit, material(ray.at(hit.distance))));
            }
        };
        meet(&FLOOR, &tiles);
        for ball in &self.balls {
            meet(&ball.shape, &|_| ball.material);
        }
        for board in &self.boards {
            meet(&board.panel, &|point| board.material(point));
        }
        let lamps = self.lamps.iter().filter(|group| group.bounds.meets(ray));
        for lamp in lamps.flat_map(|group| &group.lamps) {
            meet(&lamp.shape, &|_| lamp.material);
        }
        best
    }

    /// The part of the light that comes through along a ray from far away.
    pub fn light_through(&self, ray: &Ray, from: f32) -> f32 {
        let blocks = |shape: &dyn Shape| shape.meet(ray, from, f32::INFINITY).is_some();
        if self.boards.iter().any(|board| blocks(&board.panel)) {
            return 0.0;
        }
        let balls = self.balls.iter().filter(|ball| blocks(&ball.shape));
        balls
            .map(|ball| match ball.material.finish {
                Finish::Glass => 0.55,
                _ => 0.0,
            })
            .product()
    }

    /// The part of the sky that the balls leave free over a point.
    pub fn open_sky(&self, point: Vec3, normal: Vec3) -> f32 {
        let free = |ball: &Ball| {
            let towards = ball.shape.centre - point;
            let square = ball.shape.radius * ball.shape.radius;
            let distance = towards.length_squared().max(square);
            1.0 - normal.dot(towards).max(0.0) / distance.sqrt() * square / distance
        };
        self.balls.iter().map(free).product()
    }
}

impl Board {
    fn material(&self, point: Vec3) -> Material {
        let at = self.panel.place(point) / self.panel.size * card::GRID;
        let colour = self.title.map_or(Vec3::new(0.11, 0.09, 0.08), |title| card::colour(title, at));
        Material { colour, finish: Finish::Matte }
    }
}

/// The floor's squares.
fn tiles(point: Vec3) -> Material {
    const SIDE: f32 = 155.0;
    let odd = ((point.x / SIDE).floor() + (point.z / SIDE).floor()).rem_euclid(2.0) > 0.5;
    let colour = if odd { [0.60, 0.55, 0.46] } else { [0.08, 0.13, 0.18] };
    Material { colour: colour.into(), finish: Finish::Coated }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn looked_at(scene: &Scene, x: f32, y: f32, z: f32) -> Vec3 {
        let target = Vec3::new(x, y, z);
        let ray = Ray { origin: Vec3::ZERO, direction: target.normalize() };
        let (hit, material) = scene.nearest(&ray, 0.0).unwrap();
        assert!((ray.at(hit.distance) - target).length() < 1.0, "something stands before the card");
        material.colour
    }

    #[test]
    fn the_card_reads_from_left_to_right_and_stands_on_its_foot() {
        let scene = Scene::new();
        let Panel { corner, size } = scene.boards[0].panel;
        let unit = size.x / card::GRID.x;
        for row in 0..card::GRID.y as u8 {
            for column in 0..card::GRID.x as u8 {
                // Off the middle of the grid's cells, through which edges of the print run.
                let (right, down) = (f32::from(column) + 0.3, f32::from(row) + 0.35);
                assert_eq!(
                    looked_at(&scene, corner.x + right * unit, corner.y - down * unit, corner.z),
                    card::colour("realistic", Vec2::new(right, down)),
                    "column {column}, row {row}"
                );
            }
        }
    }

    #[test]
    fn long_lenses_look_at_the_sign() {
        let subject = |focal_length| Scene::subject(focal_length, 35.0);
        assert_eq!([10.0, 22.0, 50.0].map(subject), [1000.0; 3]);
        assert_eq!([100.0, 254.0].map(subject), [8000.0; 2]);
    }

    #[test]
    fn the_cards_stand_free_of_the_floor_and_the_balls() {
        let scene = Scene::new();
        for Board { panel, .. } in scene.boards.iter().filter(|board| board.title.is_some()) {
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
