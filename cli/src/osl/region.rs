//! The region of the sampling plane that is the pupil of a film point, represented by the upper half of its outline.
//!
//! The film point lies on +x, so the region is symmetric about the x axis.

use std::f64::consts::PI;

/// The outline above the x axis.
#[derive(Clone, Debug)]
pub struct Region {
    /// Points counter-clockwise from the greatest x to the least.
    points: Vec<[f64; 2]>,
}

/// Number of points of the outline, minus one; they are images of points over half a turn of the unit circle.
const DIRECTIONS: usize = 112;

impl Region {
    /// Returns the image of the unit disk under a map, from the map's values at the edge of the disk; `None` if the
    /// map has no value there.
    pub fn of(map: impl Fn([f64; 2]) -> Option<[f64; 2]>) -> Option<Self> {
        let point = |i: usize| {
            let (sin, cos) = (PI * i as f64 / DIRECTIONS as f64).sin_cos();
            map([cos, sin])
        };
        Some(Self { points: (0..=DIRECTIONS).map(point).collect::<Option<_>>()? })
    }

    /// Returns the least and the greatest x.
    pub fn reach(&self) -> [f64; 2] {
        let all = || self.points.iter().map(|point| point[0]);
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Returns the greatest y at x; `None` outside the region.
    pub fn height(&self, x: f64) -> Option<f64> {
        let crossings = self.points.windows(2).filter_map(|pair| {
            let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
            if !(x0.min(x1) <= x && x <= x0.max(x1)) {
                return None;
            }
            Some(if x0 == x1 { y0.max(y1) } else { y0 + (x - x0) / (x1 - x0) * (y1 - y0) })
        });
        crossings.reduce(f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ellipse_beside_the_axis_has_the_heights_of_its_equation() {
        let region = Region::of(|[x, y]| Some([5.0 + 2.0 * x, 3.0 * y])).expect("a map");
        let [from, to] = region.reach();
        assert!((from - 3.0).abs() < 1e-12 && (to - 7.0).abs() < 1e-12, "{from} {to}");
        for x in [-0.9, -0.5, 0.0, 0.3, 0.8_f64] {
            let expected = 3.0 * (1.0 - x * x).sqrt();
            let found = region.height(5.0 + 2.0 * x).expect("inside");
            assert!((found - expected).abs() < 2e-3, "{x}: {found} {expected}");
        }
        assert_eq!(region.height(7.1), None);
        assert!(Region::of(|_| None).is_none());
    }
}
