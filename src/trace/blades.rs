//! The figure that an iris's blades leave open, as tracing tests it: a point in the plane of the stop in; whether a ray
//! gets through there out.

use crate::{
    numeric::Real,
    prescription::{BladeConstants, Blades},
};

/// The figure in a stop of one size, in numbers of type `R`.
///
/// With m the largest product of the point p with a normal, p is inside where `bulge` p² + `slant` m w <= `limit` w²; w is 1,
/// or what p was multiplied with to spare a division.
#[derive(Clone, Debug)]
pub struct StopFigure<R> {
    pub blades: Blades,
    pub normals: Box<[[R; 2]]>,
    pub bulge: R,
    /// mm.
    pub slant: R,
    /// mm².
    pub limit: R,
}

impl<R: Real> StopFigure<R> {
    /// In a stop of the given clear semi-diameter, mm.
    pub fn new(blades: Blades, semi_diameter: f64) -> Self {
        let BladeConstants { bulge, slant, limit } = blades.constants();
        Self {
            blades,
            normals: blades.normals().map(|normal| normal.map(R::from_f64)).collect(),
            bulge: R::from_f64(bulge),
            slant: R::from_f64(slant * semi_diameter),
            limit: R::from_f64(limit * semi_diameter * semi_diameter),
        }
    }

    /// Whether a ray gets through at a point; not where that is no number.
    pub fn passes(&self, [x, y]: [R; 2]) -> bool {
        let products = self.normals.iter().map(|[nx, ny]| *nx * x + *ny * y);
        let most = products.reduce(|most, product| if product > most { product } else { most });
        self.bulge * (x * x + y * y) + self.slant * most.unwrap_or(R::ZERO) <= self.limit
    }
}
