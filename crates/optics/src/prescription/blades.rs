//! The blades of an iris and the opening that they leave in the plane of the stop.

use std::{f64::consts::PI, ops::RangeInclusive};

/// A stop with blades. The opening is bounded by equal arcs, one for each blade; the corners lie on the circle of the
/// stop's clear diameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blades {
    /// Number of blades, in [`Blades::COUNTS`].
    pub count: u32,
    /// Direction of the first corner, in degrees from +x (image right) toward +y (image up).
    pub rotation: f64,
    /// Curvature of the arcs relative to the curvature of the circle, in [0, 1]: 0 for a polygon, 1 for the circle.
    pub curvature: f64,
}

impl Blades {
    /// Allowed numbers of blades. With more blades, the opening is a circle to within half a per cent of its radius.
    pub const COUNTS: RangeInclusive<u32> = 3..=32;

    /// Returns the cosine and sine of half the angle between two corners.
    fn half_angle(&self) -> (f64, f64) {
        let (sine, cosine) = (PI / f64::from(self.count)).sin_cos();
        (cosine, sine)
    }

    /// Returns the constants of the inequality that tests whether a point is inside the opening. Lengths are in units
    /// of the stop's radius, and m is the largest dot product of the point with [`Blades::normals`]. The point is
    /// inside if `bulge` (x² + y²) + `slant` m <= `bulge` + `slant` cos(π/n). The difference between the two sides is
    /// half the arcs' curvature times the power of the point with respect to the nearest arc; for straight blades it is
    /// the distance to the edge.
    pub fn constants(&self) -> BladeConstants {
        let (cosine, sine) = self.half_angle();
        let c = self.curvature;
        // 0 for the circle, where the arcs are concentric with the stop.
        let slant = ((1.0 - (c * sine).powi(2)).sqrt() - c * cosine).max(0.0);
        let bulge = c / 2.0;
        BladeConstants { bulge, slant, limit: bulge + slant * cosine }
    }

    /// Returns the directions from the stop's centre to the middles of the blades' edges.
    pub fn normals(&self) -> impl Iterator<Item = [f64; 2]> {
        let first = self.rotation.to_radians();
        let step = PI / f64::from(self.count);
        (0..self.count).map(move |blade| {
            let (sine, cosine) = (first + f64::from(2 * blade + 1) * step).sin_cos();
            [cosine, sine]
        })
    }

    /// Returns the area of the opening relative to the area of the circle.
    pub fn share(&self) -> f64 {
        let (cosine, sine) = self.half_angle();
        let c = self.curvature;
        // Area between an edge's chord and its arc, computed from half the angle of the arc; 0 for straight blades.
        let segment = if c > 0.0 {
            let half = (c * sine).asin();
            (half - half.sin() * half.cos()) / (c * c)
        } else {
            0.0
        };
        f64::from(self.count) * (sine * cosine + segment) / PI
    }
}

/// The constants of the inequality that describes the opening: see [`Blades::constants`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BladeConstants {
    /// Half the arcs' curvature.
    pub bulge: f64,
    /// Weight, in the test, of the distance toward the straight edge.
    pub slant: f64,
    /// Upper limit of the weighted sum in the test.
    pub limit: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_inside(blades: &Blades, [x, y]: [f64; 2]) -> bool {
        let BladeConstants { bulge, slant, limit } = blades.constants();
        let along = blades.normals().map(|[nx, ny]| nx * x + ny * y).fold(f64::NEG_INFINITY, f64::max);
        bulge * (x * x + y * y) + slant * along <= limit
    }

    /// Returns the distance from the centre to the edge of the opening in a direction, by bisection.
    fn edge(blades: &Blades, degrees: f64) -> f64 {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let (mut inside, mut outside) = (0.0, 2.0);
        for _ in 0..60 {
            let middle = f64::midpoint(inside, outside);
            *(if is_inside(blades, [middle * cosine, middle * sine]) { &mut inside } else { &mut outside }) =
                middle;
        }
        inside
    }

    #[test]
    fn corners_lie_on_the_circle_and_edges_where_geometry_has_them() {
        for count in [3, 5, 7, 8, 32] {
            for curvature in [0.0, 0.3, 0.9, 1.0] {
                let blades = Blades { count, rotation: 11.0, curvature };
                let half = 180.0 / f64::from(count);
                for corner in 0..count {
                    let degrees = 11.0 + f64::from(2 * corner) * half;
                    assert!((edge(&blades, degrees) - 1.0).abs() < 1e-12, "{blades:?}");
                }
                let chord = half.to_radians().cos();
                // Sagitta of the arc over the chord; the arc's radius is 1/c.
                let width = half.to_radians().sin();
                let sagitta = curvature * width * width / (1.0 + (1.0 - (curvature * width).powi(2)).sqrt());
                assert!((edge(&blades, 11.0 + half) - chord - sagitta).abs() < 1e-12, "{blades:?}");
            }
        }
    }

    #[test]
    fn the_share_of_the_circle_is_the_integral_of_the_figure() {
        for (count, curvature) in [(3, 0.0), (6, 0.0), (7, 0.4), (5, 1.0)] {
            let blades = Blades { count, rotation: 0.0, curvature };
            let steps = 4000;
            let sector = 180.0 / f64::from(count);
            let mean: f64 = (0..steps)
                .map(|i| edge(&blades, (f64::from(i) + 0.5) / f64::from(steps) * sector).powi(2))
                .sum::<f64>()
                / f64::from(steps);
            assert!((mean - blades.share()).abs() < 1e-7, "{blades:?}: {mean} {}", blades.share());
        }
        let triangle = Blades { count: 3, rotation: 0.0, curvature: 0.0 }.share();
        assert!((triangle - 27.0_f64.sqrt() / 4.0 / PI).abs() < 1e-15);
    }
}
