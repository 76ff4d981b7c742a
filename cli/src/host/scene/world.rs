//! A scene as a renderer sees it: the nearest surface that a ray intersects, and occlusion of the light. Lengths are
//! in millimetres; the origin is the lens's front vertex, with +z into the scene, +x to the right and +y up.

use super::effects::{Effect, Effects};
use super::objects::{Ball, Board, FLOOR, Finish, Lamps, Material, Pane};
use super::pose::{Pose, moved_back};
use super::shapes::{Hit, Ray, Shape};
use super::sky::Sun;
use super::solids::Solids;
use glam::Vec3;
use std::sync::Arc;

/// The illumination of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Sun and sky, through air; lamps are visible but do not light anything.
    Day,
    /// The lamps, in the dark.
    Lamps,
    /// The lamps and a dusk sky.
    Dusk,
}

/// The whole scene.
#[derive(Clone)]
pub struct Scene {
    /// The colour and finish of the floor.
    pub floor: fn(Vec3) -> Material,
    /// Roughness of the floor.
    pub floor_roughness: f32,
    /// Balls, the only objects that may move.
    pub balls: Vec<Ball>,
    /// Boards.
    pub boards: Vec<Board>,
    /// Other solids, at rest.
    pub solids: Arc<Solids>,
    /// Lamps, at rest.
    pub lamps: Vec<Lamps>,
    /// Areas of solids that emit light.
    pub panes: Vec<Pane>,
    /// Illumination.
    pub light: Light,
    /// The sun, for a scene by day.
    pub sun: Sun,
    /// Pose of the camera.
    pub pose: Pose,
    /// Distance from the camera to the default subject, for a lens of this focal length and film diagonal.
    pub subject: fn(f64, f64) -> f32,
}

/// A surface that a ray meets and that is not in the hierarchy of solids.
#[derive(Clone, Copy)]
enum Met<'a> {
    Floor,
    Ball(&'a Ball),
    Board(&'a Board),
}

impl Scene {
    /// Returns the scene with only these effects. Without the corresponding effect, reflectors or glass are polished,
    /// the sun is a point, or the balls are at rest. (Depth of field is the camera's task.)
    pub fn with(mut self, effects: &Effects) -> Self {
        let balls = self.balls.iter_mut().map(|ball| &mut ball.material);
        for material in balls.chain(self.boards.iter_mut().map(|board| &mut board.material)) {
            let is_rough = match material.finish {
                Finish::Glass | Finish::Sheet => effects.has(Effect::Translucency),
                _ => effects.has(Effect::Gloss),
            };
            if !is_rough {
                material.roughness = 0.0;
            }
        }
        if !effects.has(Effect::Gloss) {
            self.floor_roughness = 0.0;
        }
        if !effects.has(Effect::SoftShadow) {
            self.sun.radius = 0.0;
        }
        if !effects.has(Effect::Motion) {
            self.balls.iter_mut().for_each(|ball| ball.shape.velocity = Vec3::ZERO);
        }
        self
    }

    /// Returns the scene with its camera moved back along the camera's axis by `distance`, mm.
    pub fn moved_back(&self, distance: f32) -> Self {
        Self { pose: moved_back(&self.pose, distance), ..self.clone() }
    }

    /// Returns the nearest surface that a ray intersects beyond `from`, lamps included.
    pub fn nearest(&self, ray: &Ray, from: f32) -> Option<(Hit, Material)> {
        let mut best = self.nearest_surface(ray, from);
        let lamps = self.lamps.iter().filter(|group| group.bounds.intersects(ray));
        for lamp in lamps.flat_map(|group| &group.lamps) {
            let to = best.map_or(f32::INFINITY, |(hit, _)| hit.distance);
            if let Some(hit) = lamp.shape.intersect(ray, from, to) {
                best = Some((hit, lamp.material));
            }
        }
        best
    }

    /// Returns the nearest surface that a ray intersects beyond `from`, without lamps.
    pub fn nearest_surface(&self, ray: &Ray, from: f32) -> Option<(Hit, Material)> {
        // The material is evaluated only for the nearest surface: the floor's pattern takes longer than the floor's
        // intersection.
        let mut best: Option<(Hit, Met)> = None;
        let mut nearer = |shape: &dyn Shape, met| {
            let to = best.map_or(f32::INFINITY, |(hit, _)| hit.distance);
            if let Some(hit) = shape.intersect(ray, from, to) {
                best = Some((hit, met));
            }
        };
        nearer(&FLOOR, Met::Floor);
        for ball in &self.balls {
            nearer(&ball.shape, Met::Ball(ball));
        }
        for board in &self.boards {
            nearer(&board.panel, Met::Board(board));
        }
        let to = best.map_or(f32::INFINITY, |(hit, _)| hit.distance);
        let own = |(hit, met): (Hit, Met<'_>)| {
            let material = match met {
                Met::Floor => (self.floor)(ray.at(hit.distance)).rough(self.floor_roughness),
                Met::Ball(ball) => ball.material(hit.normal),
                Met::Board(board) => board.material(ray.at(hit.distance)),
            };
            (hit, material)
        };
        self.solids.nearest(ray, from, to).or_else(|| best.map(own))
    }

    /// Whether any surface except a lamp's blocks a ray between two distances.
    pub fn hides(&self, ray: &Ray, from: f32, to: f32) -> bool {
        let hides = |shape: &dyn Shape| shape.intersect(ray, from, to).is_some();
        self.solids.hides(ray, from, to)
            || hides(&FLOOR)
            || self.balls.iter().any(|ball| hides(&ball.shape))
            || self.boards.iter().any(|board| hides(&board.panel))
    }

    /// Returns the share of the light of a distant source that is transmitted along a ray.
    pub fn light_through(&self, ray: &Ray, from: f32) -> f32 {
        let blocks = |shape: &dyn Shape| shape.intersect(ray, from, f32::INFINITY).is_some();
        let through = |material: &Material| match material.finish {
            Finish::Glass => 0.55,
            Finish::Sheet => 0.85,
            _ => 0.0,
        };
        let boards = self.boards.iter().filter(|board| blocks(&board.panel)).map(|board| &board.material);
        let balls = self.balls.iter().filter(|ball| blocks(&ball.shape)).map(|ball| &ball.material);
        boards.chain(balls).map(through).product()
    }

    /// Returns the share of the sky above a point that no ball covers at a given time.
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
