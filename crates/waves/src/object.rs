//! An object point and its rays.

use realistic_optics::lens::{Lens, Ray};

/// A point that sends light into a lens. Its rays are identified by the point (x, y), mm, at which they would cross the
/// plane z = 0 through the front vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObjectPoint {
    /// A point in lens space, mm, with z > 0.
    At([f64; 3]),
    /// A point at infinity.
    Toward {
        /// Unit vector from the lens to the point, with z > 0.
        direction: [f64; 3],
        /// Distance of the wavefront, from which optical paths are counted, from the front vertex, mm.
        start: f64,
    },
}

impl ObjectPoint {
    /// Returns a point at infinity in a direction of any length, for a lens. `None` if it does not lie in front of the
    /// lens.
    pub fn toward(lens: &Lens, direction: [f64; 3]) -> Option<Self> {
        let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
        let direction = direction.map(|part| part / length);
        // The wavefront lies in front of the whole first surface, however it is inclined.
        (direction[2] > 0.0).then_some(Self::Toward { direction, start: 4.0 * lens.front().semi_diameter })
    }

    /// Returns the ray through the point (x, y) of the plane z = 0.
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        match *self {
            Self::At(origin) => Ray { origin, direction: [x - origin[0], y - origin[1], -origin[2]] },
            Self::Toward { direction, start } => {
                let ahead = start - (x * direction[0] + y * direction[1]);
                let [dx, dy, dz] = direction;
                let origin = [x + ahead * dx, y + ahead * dy, ahead * dz];
                Ray { origin, direction: [-dx, -dy, -dz] }
            }
        }
    }

    /// Returns the power through the plane z = 0 at (x, y) per area, for a point of unit intensity; for a point at
    /// infinity, of unit irradiance.
    pub fn power(&self, [x, y]: [f64; 2]) -> f64 {
        match *self {
            Self::At([px, py, pz]) => {
                let squared = (x - px).powi(2) + (y - py).powi(2) + pz * pz;
                pz / squared.powf(1.5)
            }
            Self::Toward { direction, .. } => direction[2],
        }
    }

    /// Returns where the ray through a point of lens space crosses the plane z = 0; infinite or NaN if nowhere.
    pub(crate) fn seen_through(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        match *self {
            Self::At([px, py, pz]) => {
                let part = pz / (pz - z);
                [px + part * (x - px), py + part * (y - py)]
            }
            Self::Toward { direction: [dx, dy, dz], .. } => [x - z * dx / dz, y - z * dy / dz],
        }
    }
}
