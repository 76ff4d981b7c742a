//! The beam of a lamp in front of a lens, and grids of cells over parts of its cross-section.

use super::lamp::Lamp;
use realistic_base::numeric::{cross, dot, unit};
use realistic_optics::lens::Ray;

/// The light that a lamp sends to the front sphere.
pub(super) struct Beam {
    /// Centre of the sphere.
    center: [f64; 3],
    /// Unit vector from the centre to the lamp, and the distance between them, mm; `None` if the distance is infinite.
    toward: [f64; 3],
    distance: Option<f64>,
    /// Unit vectors perpendicular to the beam and to each other; the first is also perpendicular to the optical axis.
    across: [f64; 3],
    up: [f64; 3],
    /// Radius, mm, of a disk around the centre, perpendicular to the beam. All light that meets the sphere passes this
    /// disk.
    pub radius: f64,
}

impl Beam {
    /// Builds the beam of a lamp for a [`front_sphere`](super::lamp::front_sphere), given by z of its centre and its
    /// radius.
    pub fn new(lamp: Lamp, [z, sphere]: [f64; 2]) -> Self {
        let (toward, distance) = match lamp {
            Lamp::Distant(toward) => (unit(toward), None),
            Lamp::Point(at) => {
                let away = [at[0], at[1], at[2] - z];
                (unit(away), Some(dot(away, away).sqrt()))
            }
        };
        // The tangent cone of a near lamp is wider than the sphere in the plane through its centre. A lamp within the
        // sphere is rejected by `Lamp::check`.
        let radius = distance.map_or(sphere, |distance| sphere / (1.0 - (sphere / distance).powi(2)).sqrt());
        let across = if toward[0].hypot(toward[1]) > 1e-9 {
            unit([-toward[1], toward[0], 0.0])
        } else {
            [1.0, 0.0, 0.0]
        };
        let up = cross(toward, across);
        Self { center: [0.0, 0.0, z], toward, distance, across, up, radius }
    }

    /// Returns the ray through a point of the disk, given in units of the disk's radius, and the irradiance at that
    /// point, W/m².
    pub fn ray(&self, [x, y]: [f64; 2]) -> (Ray, f64) {
        let (x, y) = (x * self.radius, y * self.radius);
        let point: [f64; 3] = std::array::from_fn(|k| self.center[k] + x * self.across[k] + y * self.up[k]);
        let Some(distance) = self.distance else {
            let origin = std::array::from_fn(|k| point[k] + 2.0 * self.radius * self.toward[k]);
            return (Ray { origin, direction: self.toward.map(|part| -part) }, 1.0);
        };
        let origin: [f64; 3] = std::array::from_fn(|k| self.center[k] + distance * self.toward[k]);
        let direction: [f64; 3] = std::array::from_fn(|k| point[k] - origin[k]);
        // The intensity of the lamp is the same in all directions, and the irradiance at the centre is 1 W/m².
        (Ray { origin, direction }, (distance / dot(direction, direction).sqrt()).powi(3))
    }
}

/// A rectangle in the plane of the disk ([`Beam::radius`]), in units of the disk's radius.
pub(super) type Part = [[f64; 2]; 2];

/// A grid of `side` x `side` cells over a part.
#[derive(Clone, Copy)]
pub(super) struct BeamGrid {
    pub part: Part,
    pub side: usize,
}

impl BeamGrid {
    /// Returns the size of a cell along each axis.
    pub fn size(&self) -> [f64; 2] {
        self.part.map(|[from, to]| (to - from) / self.side as f64)
    }

    /// Returns the centre of a cell.
    pub fn center(&self, cell: usize) -> [f64; 2] {
        let (at, size) = ([cell % self.side, cell / self.side], self.size());
        [0, 1].map(|axis| self.part[axis][0] + (at[axis] as f64 + 0.5) * size[axis])
    }
}
