//! The beam of a lamp in front of a lens, and grids of cells over parts of its cross-section.

use super::lamp::Lamp;
use realistic_base::numeric::{cross, dot, unit};
use realistic_optics::lens::Ray;

/// The light that a lamp sends to the front sphere.
pub(super) struct Beam {
    /// Centre of the sphere.
    center: [f64; 3],
    /// Unit vector from the centre to the lamp, and the distance, mm, if it is finite.
    toward: [f64; 3],
    distance: Option<f64>,
    /// Unit vectors across the beam, perpendicular to each other; the first is perpendicular to the axis.
    across: [f64; 3],
    up: [f64; 3],
    /// Radius, mm, of the disk through the centre, across the beam, that all light for the sphere passes.
    pub radius: f64,
}

impl Beam {
    /// Builds the beam; `front` is a [`front_sphere`].
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

    /// Returns the ray through a point of the disk, in units of its radius, and the irradiance there, W/m².
    pub fn ray(&self, [x, y]: [f64; 2]) -> (Ray, f64) {
        let (x, y) = (x * self.radius, y * self.radius);
        let point: [f64; 3] = std::array::from_fn(|k| self.center[k] + x * self.across[k] + y * self.up[k]);
        let Some(distance) = self.distance else {
            let origin = std::array::from_fn(|k| point[k] + 2.0 * self.radius * self.toward[k]);
            return (Ray { origin, direction: self.toward.map(|part| -part) }, 1.0);
        };
        let origin: [f64; 3] = std::array::from_fn(|k| self.center[k] + distance * self.toward[k]);
        let direction: [f64; 3] = std::array::from_fn(|k| point[k] - origin[k]);
        // The lamp's intensity is uniform; it gives 1 W/m² at the centre.
        (Ray { origin, direction }, (distance / dot(direction, direction).sqrt()).powi(3))
    }
}

/// A rectangle of the disk's plane ([`Beam::radius`]), in units of the disk's radius.
pub(super) type Part = [[f64; 2]; 2];

/// Cells over a part, `side` rows of `side`.
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
