//! What a scene is made of: materials, and the shapes that have one.

use super::card;
use super::shapes::{Bounds, Floor, Panel, Sphere};
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

    /// What it is of where its surface has this normal.
    pub fn material(&self, normal: Vec3) -> Material {
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
    /// A box around all of them.
    pub bounds: Bounds,
    /// The lamps.
    pub lamps: Vec<Ball>,
}

impl FromIterator<Ball> for Lamps {
    fn from_iter<I: IntoIterator<Item = Ball>>(lamps: I) -> Self {
        let lamps: Vec<Ball> = lamps.into_iter().collect();
        Self { bounds: Bounds::around(lamps.iter().map(|lamp| &lamp.shape)), lamps }
    }
}

impl Board {
    /// What it is of at a point.
    pub fn material(&self, point: Vec3) -> Material {
        let Some(title) = self.title else {
            return self.material;
        };
        let at = self.panel.place(point) / self.panel.size * card::GRID;
        Material { colour: card::colour(title, at), ..self.material }
    }
}
