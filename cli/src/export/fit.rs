//! Least squares: finds the coefficients of a law that best match the exact chief rays.
//!
//! The method is Levenberg and Marquardt's as in MINPACK (J. J. Moré, "The Levenberg-Marquardt algorithm:
//! implementation and theory", 1978), from the crate of that name. Every residual is in pixels on the film.

use super::field::ChiefField;
use super::law::{Law, LawShape, Quantity, series};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

/// A point to which the law is fitted, each coordinate divided by its largest value. The weight is the size of a unit
/// of y in pixels at this point, times the square root of the point's share of the film.
#[derive(Clone, Copy, Debug)]
struct Point {
    x: f64,
    y: f64,
    weight: f64,
}

struct Problem {
    points: Vec<Point>,
    law: Law,
    /// Whether c is fitted, too.
    is_scale_free: bool,
}

/// Returns the law of this shape that best matches the rays, by the mean square error over the film; c is `scale` if
/// given, else fitted.
pub fn fit(shape: LawShape, field: &ChiefField, scale: Option<f64>) -> Law {
    let last = field.rings[field.rings.len() - 1];
    let [from, to] = [shape.from, shape.to];
    let unit = [from.of(last.radius, last.angle), to.of(last.radius, last.angle)];
    let angles = field.odd(|ring| ring.angle);
    let points = field.rings[1..].iter().map(|ring| {
        let worth = if to == Quantity::Radius {
            1.0
        } else {
            // dr/dy of the exact rays.
            let half = 0.5 * field.rings[1].radius;
            let [y0, y1] = [-half, half].map(|by| {
                let radius = ring.radius + by;
                to.of(radius, angles.at(radius))
            });
            2.0 * half / (y1 - y0)
        };
        let (x, y) = (from.of(ring.radius, ring.angle) / unit[0], to.of(ring.radius, ring.angle) / unit[1]);
        // The square of the weight grows with the circumference of the ring, so that equal areas of the film count
        // equally.
        Point { x, y, weight: worth.abs() * unit[1] * ring.radius.sqrt() }
    });
    let in_units = scale.map(|scale| scale * unit[0] / unit[1]);
    let [numerator, denominator] = shape.terms.map(|count| vec![0.0; count]);
    let law = Law { shape, scale: in_units.unwrap_or(1.0), numerator, denominator };
    let mut problem = Problem { points: points.collect(), law, is_scale_free: scale.is_none() };
    // The fit of a quotient starts from that of the polynomial.
    if shape.terms[1] > 0 {
        let polynomial = LawShape { terms: [shape.terms[0], 0], ..shape };
        problem.law.shape = polynomial;
        let denominator = std::mem::take(&mut problem.law.denominator);
        problem = solved(problem);
        problem.law = Law { shape, denominator, ..problem.law };
    }
    let Law { scale: found, numerator, denominator, .. } = solved(problem).law;
    let unscaled = |coefficients: Vec<f64>| {
        let powers = (1..).map(|i| unit[0].powi(shape.power * i));
        coefficients.into_iter().zip(powers).map(|(a, power)| a / power).collect()
    };
    Law {
        shape,
        scale: scale.unwrap_or(found * unit[1] / unit[0]),
        numerator: unscaled(numerator),
        denominator: unscaled(denominator),
    }
}

fn solved(problem: Problem) -> Problem {
    if problem.params().is_empty() {
        return problem;
    }
    LevenbergMarquardt::new().with_patience(400).minimize(problem).0
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        let mut values = x.iter().copied();
        let Law { scale, numerator, denominator, .. } = &mut self.law;
        let scale = self.is_scale_free.then_some(scale).into_iter();
        for (own, value) in scale.chain(numerator).chain(denominator).zip(&mut values) {
            *own = value;
        }
    }

    fn params(&self) -> DVector<f64> {
        let Law { scale, numerator, denominator, .. } = &self.law;
        let scale = self.is_scale_free.then_some(scale);
        let values = scale.into_iter().chain(numerator).chain(denominator);
        DVector::from_iterator(values.clone().count(), values.copied())
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let residual = |point: &Point| point.weight * (self.law.at(point.x) - point.y);
        let all = DVector::from_iterator(self.points.len(), self.points.iter().map(residual));
        all.iter().all(|residual| residual.is_finite()).then_some(all)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let Law { shape, scale, numerator, denominator } = &self.law;
        let mut matrix = DMatrix::zeros(self.points.len(), self.params().len());
        for (row, point) in self.points.iter().enumerate() {
            let z = point.x.powi(shape.power);
            let [n, d] = [numerator, denominator].map(|coefficients| series(coefficients, z)[0]);
            let powers = |count: usize| (1..).take(count).map(move |i| z.powi(i));
            let weight = point.weight * point.x / d;
            let by_scale = self.is_scale_free.then_some(weight * n);
            let by_numerator = powers(numerator.len()).map(|power| weight * scale * power);
            let by_denominator = powers(denominator.len()).map(|power| -weight * scale * n / d * power);
            let slopes = by_scale.into_iter().chain(by_numerator).chain(by_denominator);
            for (column, slope) in slopes.enumerate() {
                matrix[(row, column)] = slope;
            }
        }
        Some(matrix)
    }
}

/// Returns the coefficients of 1 + a₁ z + a₂ z² + … that best match the points (z, value), by singular value
/// decomposition.
pub fn polynomial(points: &[(f64, f64)], count: usize) -> Vec<f64> {
    let powers = DMatrix::from_fn(points.len(), count, |row, column| points[row].0.powi(column as i32 + 1));
    let values = DVector::from_iterator(points.len(), points.iter().map(|(_, value)| value - 1.0));
    powers
        .svd(true, true)
        .solve(&values, 1e-14)
        .map_or_else(|_| vec![0.0; count], |found| found.as_slice().to_vec())
}

#[cfg(test)]
mod tests {
    use super::super::field::{Film, Ring};
    use super::*;

    /// Returns the rays of a camera with this law, which grows up to the angle `reach`.
    fn field(law: &Law, reach: f64) -> ChiefField {
        let film = Film { size: [1920, 1280], diagonal: 35.0, z: -60.0 };
        let ring = |i: u32| {
            let radius = film.corner() * f64::from(i) / 200.0;
            let angle = law.unproject(radius, reach).expect("within");
            Ring { radius, origin: [0.0; 2], direction: [0.0; 2], pupil: 0.0, angle, share: 0.0 }
        };
        let rings = (0..=200).map(ring).collect();
        ChiefField { film, pinhole: 0.0, in_focus: f64::INFINITY, lit: film.corner(), rings }
    }

    #[test]
    fn a_camera_of_the_model_gives_its_coefficients_back() {
        use Quantity::{Angle, Radius, Tangent};
        for (shape, scale, numerator, denominator) in [
            (
                LawShape { from: Tangent, to: Radius, power: 2, terms: [3, 0] },
                1500.0,
                vec![-0.1, 0.03, -0.004],
                vec![],
            ),
            (
                LawShape { from: Angle, to: Radius, power: 2, terms: [4, 0] },
                700.0,
                vec![-0.05, 0.01, -0.002, 1e-4],
                vec![],
            ),
            (
                LawShape { from: Radius, to: Angle, power: 1, terms: [3, 0] },
                1e-3,
                vec![1e-5, 1e-8, -2e-11],
                vec![],
            ),
        ] {
            let law = Law { shape, scale, numerator, denominator };
            let found = fit(shape, &field(&law, if shape.from == Angle { 3.0 } else { 0.9 }), None);
            assert!((found.scale / law.scale - 1.0).abs() < 1e-7, "{found:?}");
            for (a, b) in found.numerator.iter().zip(&law.numerator) {
                assert!((a / b - 1.0).abs() < 1e-4, "{found:?} {law:?}");
            }
        }
        // Numerator and denominator can compensate each other: the fit of a quotient recovers the law, not its
        // coefficients.
        let shape = LawShape { from: Tangent, to: Radius, power: 2, terms: [3, 3] };
        let law =
            Law { shape, scale: 1500.0, numerator: vec![0.2, 0.1, 0.0], denominator: vec![0.4, 0.0, 0.05] };
        let rays = field(&law, 0.9);
        for scale in [None, Some(1500.0)] {
            let found = fit(shape, &rays, scale);
            for ring in &rays.rings {
                let radius = found.project(ring.angle, 2000.0).expect("within");
                assert!((radius - ring.radius).abs() < 1e-3, "{radius} {}", ring.radius);
            }
        }
    }

    #[test]
    fn a_polynomial_comes_back() {
        let points: Vec<(f64, f64)> =
            (0..=20).map(|i| f64::from(i) / 20.0).map(|z| (z, 1.0 - 0.5 * z + 0.1 * z * z * z)).collect();
        let found = polynomial(&points, 3);
        for (a, b) in found.iter().zip([-0.5, 0.0, 0.1]) {
            assert!((a - b).abs() < 1e-12, "{found:?}");
        }
    }
}
