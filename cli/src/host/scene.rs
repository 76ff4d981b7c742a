//! The built-in scene as a renderer sees it: what a ray meets, and what hides the light.
//! Millimetres, the lens' front vertex at the origin, +z into the scene, +x to the right,
//! +y up.

use super::camera::{LEVEL, Pose};
use super::effects::Effects;
use super::shapes::{Bounds, Floor, Hit, Panel, Ray, Shape, Sphere};
use super::sky::Sun;
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
    /// Through and off, as a thin sheet of glass: what goes through keeps its direction.
    Sheet,
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
    /// RMS slope of the facets that reflect and refract; 0 for a polished surface.
    pub roughness: f32,
}

impl Material {
    /// A polished one.
    pub fn new(colour: impl Into<Vec3>, finish: Finish) -> Self {
        Self { colour: colour.into(), finish, roughness: 0.0 }
    }

    /// The same with rough facets.
    pub fn rough(self, roughness: f32) -> Self {
        Self { roughness, ..self }
    }
}

/// A ball.
#[derive(Clone, Copy)]
pub struct Ball {
    /// Where it is.
    pub shape: Sphere,
    /// What it is of.
    pub material: Material,
    /// What is painted on it: its colour by the direction from its centre.
    pub paint: Option<fn(Vec3) -> Vec3>,
}

impl Ball {
    /// A plain one.
    pub fn new(shape: Sphere, material: Material) -> Self {
        Self { shape, material, paint: None }
    }

    fn material(&self, normal: Vec3) -> Material {
        match self.paint {
            Some(paint) => Material { colour: paint(normal), ..self.material },
            None => self.material,
        }
    }
}

/// An upright board; with a title it is one of the cards.
#[derive(Clone, Copy)]
pub struct Board {
    /// Where it is.
    pub panel: Panel,
    /// What is written over the arrows.
    pub title: Option<&'static str>,
    /// What it is of; a card has its own colours.
    pub material: Material,
}

/// Lamps that lie close together.
#[derive(Clone)]
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
#[derive(Clone)]
pub struct Scene {
    /// The colour and finish of the floor.
    pub floor: fn(Vec3) -> Material,
    /// Roughness of the floor.
    pub floor_roughness: f32,
    /// Balls, which alone may move.
    pub balls: Vec<Ball>,
    /// Boards.
    pub boards: Vec<Board>,
    /// Lamps, at rest.
    pub lamps: Vec<Lamps>,
    /// The light.
    pub sun: Sun,
    /// Where the camera stands.
    pub pose: Pose,
    /// How far before the camera that is which a lens of this focal length and film diagonal would be focused on.
    pub subject: fn(f64, f64) -> f32,
}

impl Scene {
    /// The built-in scene, with everything in its place.
    pub fn new() -> Self {
        Self {
            floor: props::tiles,
            floor_roughness: 0.03,
            balls: props::balls(),
            boards: props::boards(),
            lamps: props::lamps().into(),
            sun: Sun::EVENING,
            pose: LEVEL,
            subject: props::subject,
        }
    }

    /// The same scene with nothing but these effects: where one is off, reflectors or glass are
    /// polished, the sun is a point, or the balls rest. (Depth of field is the camera's.)
    pub fn with(mut self, effects: Effects) -> Self {
        let balls = self.balls.iter_mut().map(|ball| &mut ball.material);
        for material in balls.chain(self.boards.iter_mut().map(|board| &mut board.material)) {
            let kept = match material.finish {
                Finish::Glass | Finish::Sheet => effects.translucency,
                _ => effects.gloss,
            };
            if !kept {
                material.roughness = 0.0;
            }
        }
        if !effects.gloss {
            self.floor_roughness = 0.0;
        }
        if !effects.soft_shadow {
            self.sun.radius = 0.0;
        }
        if !effects.motion {
            self.balls.iter_mut().for_each(|ball| ball.shape.velocity = Vec3::ZERO);
        }
        self
    }

    /// The nearest surface that a ray meets beyond `from`.
    pub fn nearest(&self, ray: &Ray, from: f32) -> Option<(Hit, Material)> {
        let mut best: Option<(Hit, Material)> = None;
        let mut meet = |shape: &dyn Shape, material: &dyn Fn(&Hit) -> Material| {
            let to = best.map_or(f32::INFINITY, |(hit, _)| hit.distance);
            if let Some(hit) = shape.meet(ray, from, to) {
                best = Some((hit, material(&hit)));
            }
        };
        let rough = self.floor_roughness;
        meet(&FLOOR, &|hit| (self.floor)(ray.at(hit.distance)).rough(rough));
        for ball in &self.balls {
            meet(&ball.shape, &|hit| ball.material(hit.normal));
        }
        for board in &self.boards {
            meet(&board.panel, &|hit| board.material(ray.at(hit.distance)));
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
        let through = |material: &Material| match material.finish {
            Finish::Glass => 0.55,
            Finish::Sheet => 0.85,
            _ => 0.0,
        };
        let boards = self.boards.iter().filter(|board| blocks(&board.panel)).map(|board| &board.material);
        let balls = self.balls.iter().filter(|ball| blocks(&ball.shape)).map(|ball| &ball.material);
        boards.chain(balls).map(through).product()
    }

    /// The part of the sky that the balls leave free over a point at a time.
    pub fn open_sky(&self, point: Vec3, normal: Vec3, time: f32) -> f32 {
        let free = |ball: &Ball| {
            let towards = ball.shape.centre_at(time) - point;
            let square = ball.shape.radius * ball.shape.radius;
            let distance = towards.length_squared().max(square);
            1.0 - normal.dot(towards).max(0.0) / distance.sqrt() * square / distance
        };
        self.balls.iter().map(free).product()
    }
}

impl Board {
    fn material(&self, point: Vec3) -> Material {
        let Some(title) = self.title else {
            return self.material;
        };
        let at = self.panel.place(point) / self.panel.size * card::GRID;
        Material { colour: card::colour(title, at), ..self.material }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes::NOON;
    use super::*;
    use glam::Vec2;

    fn looked_at(scene: &Scene, x: f32, y: f32, z: f32) -> Vec3 {
        let target = Vec3::new(x, y, z);
        let ray = Ray { origin: Vec3::ZERO, direction: target.normalize(), time: NOON };
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
        let subject = |focal_length| (Scene::new().subject)(focal_length, 35.0);
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
