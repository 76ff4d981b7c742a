//! The light of a lamp before a lens: a beam across which places are counted, and grids of cells over parts of it.

use super::lamp::Lamp;
use crate::{
    lens::Ray,
    numeric::{cross, dot, unit},
};

/// The light that a lamp sends to the front sphere.
pub(super) struct Beam {
    /// The sphere's middle.
    middle: [f64; 3],
    /// From there to the lamp, a unit vector, and how far, mm, if it is not infinitely far away.
    toward: [f64; 3],
    distance: Option<f64>,
    /// Two directions across the light, of which one lies across the axis.
    across: [f64; 3],
    up: [f64; 3],
    /// Of the disk in the plane through the middle, across the light, that all light for the sphere passes, mm.
    pub radius: f64,
}

impl Beam {
    /// `front` is a [`front_sphere`].
    pub fn new(lamp: Lamp, [z, sphere]: [f64; 2]) -> Self {
        let (toward, distance) = match lamp {
            Lamp::Distant(toward) => (unit(toward), None),
            Lamp::Point(at) => {
                let away = [at[0], at[1], at[2] - z];
                (unit(away), Some(dot(away, away).sqrt()))
            }
        };
        // A point sees more of the plane behind the sphere than the sphere is wide. A lamp within it has nothing of that
        // kind (`Lamp::check`).
        let radius = distance.map_or(sphere, |distance| sphere / (1.0 - (sphere / distance).powi(2)).sqrt());
        let across = if toward[0].hypot(toward[1]) > 1e-9 {
            unit([-toward[1], toward[0], 0.0])
        } else {
            [1.0, 0.0, 0.0]
        };
        let up = cross(toward, across);
        Self { middle: [0.0, 0.0, z], toward, distance, across, up, radius }
    }

    /// The ray through a place of the disk, in units of its radius, and the light there, W/m².
    pub fn ray(&self, [x, y]: [f64; 2]) -> (Ray, f64) {
        let (x, y) = (x * self.radius, y * self.radius);
        let point: [f64; 3] = std::array::from_fn(|k| self.middle[k] + x * self.across[k] + y * self.up[k]);
        let Some(distance) = self.distance else {
            let origin = std::array::from_fn(|k| point[k] + 2.0 * self.radius * self.toward[k]);
            return (Ray { origin, direction: self.toward.map(|part| -part) }, 1.0);
        };
        let origin: [f64; 3] = std::array::from_fn(|k| self.middle[k] + distance * self.toward[k]);
        let direction: [f64; 3] = std::array::from_fn(|k| point[k] - origin[k]);
        // The same intensity everywhere: that of 1 W/m² in the middle.
        (Ray { origin, direction }, (distance / dot(direction, direction).sqrt()).powi(3))
    }
}

/// A part of the plane through the middle of the front sphere, across the light, in units of the radius of the disk there that
/// all light for the sphere passes.
pub(super) type Part = [[f64; 2]; 2];

/// Cells over a part, `side` rows of `side`.
#[derive(Clone, Copy)]
pub(super) struct BeamGrid {
    pub part: Part,
    pub side: usize,
}

impl BeamGrid {
    /// How wide a cell is along each axis.
    pub fn size(&self) -> [f64; 2] {
        self.part.map(|[from, to]| (to - from) / self.side as f64)
    }

    /// The middle of a cell.
    pub fn place(&self, cell: usize) -> [f64; 2] {
        let (at, size) = ([cell % self.side, cell / self.side], self.size());
        [0, 1].map(|axis| self.part[axis][0] + (at[axis] as f64 + 0.5) * size[axis])
    }
}
