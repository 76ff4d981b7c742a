//! The figure of a surface that is not symmetric about its axis, with bounds on its sagitta, slopes and second
//! derivatives over the clear aperture and a region around it.
//!
//! **The bounds are proven.** Every figure is symmetric in x and in y, so that a quarter of the region has all of its
//! bounds. It is divided into squares. On each square the formula of the surface is evaluated
//! with intervals that carry derivatives ([`Hessian`] of [`Interval`]s), whose roundings are directed outward.

use realistic_base::numeric::{Hessian, Interval};

use crate::prescription::{Cylinder, Unsymmetric, UnsymmetricConstants};

/// A figure z(x, y) with its rim, the edge of the clear aperture. z is counted from the vertex plane toward the film.
#[derive(Clone, Debug, PartialEq)]
pub struct UnsymmetricFigure {
    /// The surface.
    pub surface: Unsymmetric,
    /// Radius of the rim, mm: the clear semi-diameter.
    pub rim: f64,
    /// Bounds from the axis to the rim.
    pub inside: RegionBounds,
    /// Bounds from the axis to the reach.
    pub beyond: RegionBounds,
    /// The distance from the axis up to which rays are followed to the surface, mm. Rays that meet the surface between
    /// the rim and the reach are clipped by the aperture.
    pub reach: f64,
}

/// Bounds of a figure in a region around the axis; infinite where the figure ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionBounds {
    /// Minimum and maximum z, mm.
    pub sagitta: [f64; 2],
    /// Maximum length of the gradient of z.
    pub slope: f64,
    /// Minimum and maximum of the second derivatives of z in any direction perpendicular to the axis, 1/mm.
    pub curvature: [f64; 2],
}

/// Number of squares along a side of the quarter of a region.
const SQUARES: u32 = 24;
/// Possible reaches in clear semi-diameters. The largest is used to which the figure has bounds, and rises or falls beyond
/// its rim by at most a semi-diameter: farther terms of high powers would stand in the way of rays that meet the surface.
const REACHES: [f64; 4] = [3.0, 2.0, 1.5, 1.2];

impl UnsymmetricFigure {
    /// Builds the figure of a surface with this clear semi-diameter.
    pub fn new(surface: &Unsymmetric, semi_diameter: f64) -> Self {
        let bounds = |reach: f64| RegionBounds::of(surface, reach * semi_diameter);
        let inside = bounds(1.0);
        let [low, high] = inside.sagitta;
        let stays_near = |bounds: &RegionBounds| {
            let [least, most] = bounds.sagitta;
            bounds.is_finite() && least >= low - semi_diameter && most <= high + semi_diameter
        };
        let beyond =
            REACHES.into_iter().map(|reach| (reach, bounds(reach))).find(|(_, bounds)| stays_near(bounds));
        let (reach, beyond) = beyond.unwrap_or((1.0, inside));
        Self { surface: *surface, rim: semi_diameter, inside, beyond, reach: reach * semi_diameter }
    }

    /// Returns z at (x, y), mm; NaN where the surface ends.
    pub fn sagitta(&self, point: [f64; 2]) -> f64 {
        self.surface.constants(1.0).sagitta(point)
    }

    /// Returns the cylinder that the figure is, if it is one without terms.
    pub fn cylinder(&self) -> Option<Cylinder> {
        self.surface.cylinder()
    }
}

impl RegionBounds {
    /// Returns the bounds in the circle of this radius around the axis.
    pub fn of(surface: &Unsymmetric, radius: f64) -> Self {
        let constants = surface.constants(1.0);
        let edge = |i: u32| radius * (f64::from(i) / f64::from(SQUARES));
        let side = |i: u32| Interval { low: edge(i), high: edge(i + 1) };
        let mut all = Self {
            sagitta: [f64::INFINITY, f64::NEG_INFINITY],
            slope: 0.0,
            curvature: [f64::INFINITY, f64::NEG_INFINITY],
        };
        for i in 0..SQUARES {
            for j in 0..SQUARES {
                let square = [side(i), side(j)];
                if square[0].low.hypot(square[1].low) <= radius {
                    all.widen(&constants, square);
                }
            }
        }
        all
    }

    /// Widens the bounds by those in a square.
    fn widen(&mut self, constants: &UnsymmetricConstants<f64>, [x, y]: [Interval; 2]) {
        let number = |number: f64| Interval { low: number, high: number };
        let variable = |value: Interval, [dx, dy]: [f64; 2]| Hessian {
            value,
            first: [number(dx), number(dy)],
            second: [number(0.0); 3],
        };
        let z = constants.sagitta([variable(x, [1.0, 0.0]), variable(y, [0.0, 1.0])]);
        let size = |part: Interval| part.high.max(-part.low);
        let [across, mixed, along] = z.second;
        // Gershgorin's circles contain the eigenvalues of the matrix of second derivatives.
        let twist = size(mixed);
        let wider = |[low, high]: [f64; 2], [from, to]: [f64; 2]| [low.min(from), high.max(to)];
        self.sagitta = wider(self.sagitta, [z.value.low, z.value.high]);
        self.slope = self.slope.max(size(z.first[0]).hypot(size(z.first[1])));
        self.curvature =
            wider(self.curvature, [across.low.min(along.low) - twist, across.high.max(along.high) + twist]);
    }

    /// Returns whether the figure has bounds in the region.
    pub fn is_finite(&self) -> bool {
        self.sagitta.iter().chain(&self.curvature).chain([&self.slope]).all(|bound| bound.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::{Biconic, Meridian, PROFILE_TERMS, Toroid};

    fn toroid(meridian: Meridian, radius: f64, conic: f64, rotation_radius: f64) -> Unsymmetric {
        let mut terms = [0.0; PROFILE_TERMS];
        terms[1] = 1e-6;
        Unsymmetric::Toroid(Toroid { meridian, radius, conic, terms, rotation_radius })
    }

    fn figures() -> Vec<Unsymmetric> {
        vec![
            toroid(Meridian::Y, 50.0, -0.5, 80.0),
            toroid(Meridian::X, -30.0, 0.2, 40.0),
            toroid(Meridian::Y, f64::INFINITY, 0.0, 25.0),
            Unsymmetric::Biconic(Biconic { radii: [80.0, 50.0], conics: [-1.0, 0.5] }),
            Unsymmetric::Biconic(Biconic { radii: [-40.0, f64::INFINITY], conics: [0.0, 0.0] }),
        ]
    }

    #[test]
    fn sagittae_are_those_of_opticstudio() {
        let biconic = Unsymmetric::Biconic(Biconic { radii: [80.0, 50.0], conics: [0.0; 2] });
        let plain = Unsymmetric::Toroid(Toroid {
            meridian: Meridian::Y,
            radius: 50.0,
            conic: 0.0,
            terms: [0.0; PROFILE_TERMS],
            rotation_radius: 80.0,
        });
        for (surface, z) in [(biconic, 1.648249), (plain, 1.645755)] {
            let figure = UnsymmetricFigure::new(&surface, 15.0);
            assert!((figure.sagitta([10.0, 10.0]) - z).abs() < 5e-7, "{surface:?}");
        }
        // A toroid is a circle in both meridians.
        let circle = |r: f64| r - (r * r - 100.0).sqrt();
        let figure = UnsymmetricFigure::new(&plain, 15.0);
        assert!((figure.sagitta([10.0, 0.0]) - circle(80.0)).abs() < 1e-14);
        assert!((figure.sagitta([0.0, 10.0]) - circle(50.0)).abs() < 1e-14);
    }

    #[test]
    fn bounds_hold_everywhere_and_are_close() {
        for surface in figures() {
            let figure = UnsymmetricFigure::new(&surface, 12.0);
            assert!(figure.reach >= 1.2 * 12.0 && figure.beyond.is_finite(), "{figure:?}");
            let mut curvatures = [f64::INFINITY, f64::NEG_INFINITY];
            let h = 1e-3;
            for i in 0..40 {
                for j in 0..40 {
                    let [x, y] = [i, j].map(|i| 12.0 * (f64::from(i) / 20.0 - 1.0));
                    if x.hypot(y) > 12.0 {
                        continue;
                    }
                    let z = figure.sagitta([x, y]);
                    let [low, high] = figure.inside.sagitta;
                    assert!(low <= z && z <= high, "{figure:?} at {x} {y}");
                    for k in 0..12 {
                        let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 12.0).sin_cos();
                        let at = |s: f64| figure.sagitta([x + s * cos, y + s * sin]);
                        let second = (at(h) - 2.0 * z + at(-h)) / (h * h);
                        curvatures = [curvatures[0].min(second), curvatures[1].max(second)];
                        assert!((at(h) - at(-h)).abs() / (2.0 * h) <= figure.inside.slope + 1e-9);
                    }
                }
            }
            let [low, high] = figure.inside.curvature;
            assert!(low <= curvatures[0] + 1e-6 && curvatures[1] - 1e-6 <= high, "{figure:?} {curvatures:?}");
            let width = curvatures[1] - curvatures[0] + 0.01 * curvatures[1].abs();
            assert!(high - low < 2.0 * width + 0.01, "{figure:?} {curvatures:?}");
        }
    }
}
