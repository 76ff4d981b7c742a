//! A scene as a renderer sees it: the nearest surface that a ray intersects, and what hides the light.
//! Millimetres, the lens' front vertex at the origin, +z into the scene, +x to the right,
//! +y up.

use super::effects::{Effect, Effects};
use super::objects::{Ball, Board, FLOOR, Finish, Lamps, Material, Pane};
use super::pose::{Pose, moved_back};
use super::shapes::{Hit, Ray, Shape};
use super::sky::Sun;
use super::solids::Solids;
use glam::Vec3;
use std::sync::Arc;

/// What lights a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Sun and sky, through air; lamps only shine.
    Day,
    /// The lamps, before the dark.
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
    /// Balls, which alone may move.
    pub balls: Vec<Ball>,
    /// Boards.
    pub boards: Vec<Board>,
    /// Many more, at rest.
    pub solids: Arc<Solids>,
    /// Lamps, at rest.
    pub lamps: Vec<Lamps>,
    /// Where solids shine.
    pub panes: Vec<Pane>,
    /// What lights it.
    pub light: Light,
    /// The sun, by day.
    pub sun: Sun,
    /// Where the camera stands.
    pub pose: Pose,
    /// How far before the camera that is which a lens of this focal length and film diagonal would be focused on.
    pub subject: fn(f64, f64) -> f32,
}

/// What a ray meets that is no solid of the hierarchy.
#[derive(Clone, Copy)]
enum Met<'a> {
    Floor,
    Ball(&'a Ball),
    Board(&'a Board),
}

impl Scene {
    /// The same scene with nothing but these effects: where one is off, reflectors or glass are
    /// polished, the sun is a point, or the balls rest. (Depth of field is the camera's.)
    pub fn with(mut self, effects: &Effects) -> Self {
        let balls = self.balls.iter_mut().map(|ball| &mut ball.material);
        for material in balls.chain(self.boards.iter_mut().map(|board| &mut board.material)) {
            let kept = match material.finish {
                Finish::Glass | Finish::Sheet => effects.has(Effect::Translucency),
                _ => effects.has(Effect::Gloss),
            };
            if !kept {
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

    /// The same scene with its camera moved back along its axis, mm.
    pub fn moved_back(&self, distance: f32) -> Self {
        Self { pose: moved_back(&self.pose, distance), ..self.clone() }
    }

    /// The nearest surface that a ray intersects beyond `from`, a lamp's or another.
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

    /// The nearest surface that a ray intersects beyond `from` and that is no lamp's.
    pub fn nearest_surface(&self, ray: &Ray, from: f32) -> Option<(Hit, Material)> {
        // What it is made of is asked of the nearest alone: the floor's pattern takes longer than meeting it.
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

    /// Whether any surface but a lamp's lies along a ray between two distances.
    pub fn hides(&self, ray: &Ray, from: f32, to: f32) -> bool {
        let hides = |shape: &dyn Shape| shape.intersect(ray, from, to).is_some();
        self.solids.hides(ray, from, to)
            || hides(&FLOOR)
            || self.balls.iter().any(|ball| hides(&ball.shape))
            || self.boards.iter().any(|board| hides(&board.panel))
    }

    /// The part of the light that comes through along a ray from far away.
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
