//! The objects of a scene: materials, and the shapes that are made of them.

use super::card::GRID;
use super::print::Print;
use super::shapes::{Bounds, Floor, Panel, Sphere};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The floor under all objects.
pub const FLOOR: Floor = Floor { height: -155.0 };

/// Reflection and transmission of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finish {
    /// Reflects in all directions.
    Matte,
    /// Reflects in all directions, under a clear coat that reflects like a mirror.
    Coated,
    /// Reflects like a mirror, tinted.
    Metal,
    /// Refracts and reflects like solid glass.
    Glass,
    /// Transmits and reflects like a thin sheet of glass: transmitted light keeps its direction.
    Sheet,
    /// Emits light.
    Lamp,
}

/// Colour and finish at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflectance, or radiance of a lamp.
    pub colour: Vec3,
    /// Finish of the surface.
    pub finish: Finish,
    /// RMS slope of the facets that reflect and refract; 0 for a polished surface.
    pub roughness: f32,
}

impl Material {
    /// Makes a polished material.
    pub fn new(colour: impl Into<Vec3>, finish: Finish) -> Self {
        Self { colour: colour.into(), finish, roughness: 0.0 }
    }

    /// Returns the material with rough facets.
    pub fn rough(self, roughness: f32) -> Self {
        Self { roughness, ..self }
    }
}

/// The paint on a ball: its colour as a function of the direction from its centre.
pub type Paint = Arc<dyn Fn(Vec3) -> Vec3 + Send + Sync>;

/// A ball.
#[derive(Clone)]
pub struct Ball {
    /// Shape of the ball.
    pub shape: Sphere,
    /// Material without paint.
    pub material: Material,
    /// Paint, which replaces the material's colour.
    pub paint: Option<Paint>,
}

impl Ball {
    /// Makes a plain ball.
    pub fn new(shape: Sphere, material: Material) -> Self {
        Self { shape, material, paint: None }
    }

    /// Makes a plain ball that stands on the floor at x and z.
    pub fn standing([x, z]: [f32; 2], radius: f32, material: Material) -> Self {
        Self::new(Sphere::resting(Vec3::new(x, FLOOR.height + radius, z), radius), material)
    }

    /// Returns the material at the point with this surface normal.
    pub fn material(&self, normal: Vec3) -> Material {
        match &self.paint {
            Some(paint) => Material { colour: paint(normal), ..self.material },
            None => self.material,
        }
    }
}

/// An upright board; a board with a print is one of the cards.
#[derive(Clone)]
pub struct Board {
    /// Shape of the board.
    pub panel: Panel,
    /// Print that covers the whole board.
    pub print: Option<Arc<Print>>,
    /// Material of a board without a print; a print has its own colours.
    pub material: Material,
}

/// Lamps that lie close together.
#[derive(Clone)]
pub struct Lamps {
    /// A box around all of the lamps.
    pub bounds: Bounds,
    /// The lamps.
    pub lamps: Vec<Ball>,
}

/// Largest rounding error of a point of a solid's surface, mm.
const ROUNDING: f32 = 0.1;

/// A rectangle on the surface of a solid that emits light where its material is a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    /// Corner of the rectangle.
    pub corner: Vec3,
    /// The two sides from the corner, which form a right angle.
    pub sides: [Vec3; 2],
    /// Normal of the surface.
    pub normal: Vec3,
    /// Material of the solid as a function of the point and the normal.
    pub material_at: fn(Vec3, Vec3) -> Material,
}

impl Pane {
    /// Returns the area, mm².
    pub fn area(&self) -> f32 {
        self.sides[0].length() * self.sides[1].length()
    }

    /// Returns the point at these fractions of the sides.
    pub fn point(&self, [u, v]: [f32; 2]) -> Vec3 {
        self.corner + u * self.sides[0] + v * self.sides[1]
    }

    /// Whether a point is in the pane's plane, within rounding error.
    pub fn is_level_with(&self, point: Vec3) -> bool {
        (point - self.corner).dot(self.normal).abs() <= ROUNDING
    }

    /// Whether a point of a solid's surface is on the pane, within rounding error.
    pub fn contains(&self, point: Vec3) -> bool {
        let from = point - self.corner;
        let is_within = |side: &Vec3| {
            let (along, length) = (from.dot(*side), side.length_squared());
            let margin = ROUNDING * length.sqrt();
            (-margin..=length + margin).contains(&along)
        };
        self.is_level_with(point) && self.sides.iter().all(is_within)
    }

    /// Returns the radiance at a point of the pane.
    pub fn radiance(&self, point: Vec3) -> Vec3 {
        let material = (self.material_at)(point, self.normal);
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
    /// Makes a board of this size without a print, with its top left corner at `corner`.
    pub fn plain(corner: Vec3, size: Vec2, material: Material) -> Self {
        Self { panel: Panel { corner, size }, print: None, material }
    }

    /// Returns the material at a point.
    pub fn material(&self, point: Vec3) -> Material {
        let Some(print) = &self.print else {
            return self.material;
        };
        let at = self.panel.coordinates(point) / self.panel.size * Vec2::from(GRID);
        Material { colour: print.colour(at), ..self.material }
    }
}
