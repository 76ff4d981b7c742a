//! What a scene is made of: materials, and the shapes that have one.

use super::card::GRID;
use super::print::Print;
use super::shapes::{Bounds, Floor, Panel, Sphere};
use glam::{Vec2, Vec3};
use std::sync::Arc;

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

/// What is painted on a ball: its colour by the direction from its centre.
pub type Paint = Arc<dyn Fn(Vec3) -> Vec3 + Send + Sync>;

/// A ball.
#[derive(Clone)]
pub struct Ball {
    /// Where it is.
    pub shape: Sphere,
    /// What it is of.
    pub material: Material,
    /// What is painted on it.
    pub paint: Option<Paint>,
}

impl Ball {
    /// A plain one.
    pub fn new(shape: Sphere, material: Material) -> Self {
        Self { shape, material, paint: None }
    }

    /// A plain one that stands on the floor at x and z.
    pub fn standing([x, z]: [f32; 2], radius: f32, material: Material) -> Self {
        Self::new(Sphere::resting(Vec3::new(x, FLOOR.height + radius, z), radius), material)
    }

    /// What it is of where its surface has this normal.
    pub fn material(&self, normal: Vec3) -> Material {
        match &self.paint {
            Some(paint) => Material { colour: paint(normal), ..self.material },
            None => self.material,
        }
    }
}

/// An upright board; with a print it is one of the cards.
#[derive(Clone)]
pub struct Board {
    /// Where it is.
    pub panel: Panel,
    /// What is printed on it, over the whole.
    pub print: Option<Arc<Print>>,
    /// What it is of; a print has its own colours.
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

/// What rounding may move a point of a solid's surface by, mm.
const ROUNDING: f32 = 0.1;

/// A rectangle of a solid's surface within which it shines where its look says so.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    /// A corner.
    pub corner: Vec3,
    /// The sides from there, at a right angle.
    pub sides: [Vec3; 2],
    /// The surface's normal.
    pub normal: Vec3,
    /// What the solid is made of, by the point and the normal.
    pub look: fn(Vec3, Vec3) -> Material,
}

impl Pane {
    /// Its area, mm².
    pub fn area(&self) -> f32 {
        self.sides[0].length() * self.sides[1].length()
    }

    /// The point at parts of its sides.
    pub fn point(&self, [u, v]: [f32; 2]) -> Vec3 {
        self.corner + u * self.sides[0] + v * self.sides[1]
    }

    /// Whether a point is in its plane, up to rounding.
    pub fn is_level_with(&self, point: Vec3) -> bool {
        (point - self.corner).dot(self.normal).abs() <= ROUNDING
    }

    /// Whether a point of a solid's surface is on it, up to rounding.
    pub fn contains(&self, point: Vec3) -> bool {
        let from = point - self.corner;
        let is_within = |side: &Vec3| {
            let (along, length) = (from.dot(*side), side.length_squared());
            let margin = ROUNDING * length.sqrt();
            (-margin..=length + margin).contains(&along)
        };
        self.is_level_with(point) && self.sides.iter().all(is_within)
    }

    /// The radiance of a point of it.
    pub fn radiance(&self, point: Vec3) -> Vec3 {
        let material = (self.look)(point, self.normal);
        if material.finish == Finish::Lamp { material.colour } else { Vec3::ZERO }
    }
}

impl FromIterator<Ball> for Lamps {
    fn from_iter<I: IntoIterator<Item = Ball>>(lamps: I) -> Self {
        let lamps: Vec<Ball> = lamps.into_iter().collect();
        Self { bounds: Bounds::around(lamps.iter().map(|lamp| &lamp.shape)), lamps }
    }
}

impl Board {
    /// One of this size without a print, its top left corner there.
    pub fn plain(corner: Vec3, size: Vec2, material: Material) -> Self {
        Self { panel: Panel { corner, size }, print: None, material }
    }

    /// What it is of at a point.
    pub fn material(&self, point: Vec3) -> Material {
        let Some(print) = &self.print else {
            return self.material;
        };
        let at = self.panel.place(point) / self.panel.size * Vec2::from(GRID);
        Material { colour: print.colour(at), ..self.material }
    }
}
