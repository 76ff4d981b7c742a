//! Curves through tabulated points: a smooth curve that rises and falls only where the points do ([`Monotone`]), and a
//! polyline ([`on_broken_line`]).
//!
//! [`Monotone`] is piecewise cubic Hermite interpolation (F. N. Fritsch and R. E. Carlson, *SIAM J. Numer. Anal.* 17
//! (1980), 238-246). The slopes at inner points are those of F. N. Fritsch and J. Butland, *SIAM J. Sci. Stat. Comput.*
//! 5 (1984), 300-304. The slopes at the ends follow the three-point formula of C. Moler, *Numerical Computing with
//! MATLAB* (2004), §3.6.

/// A smooth curve through points. Its derivative is continuous everywhere; beyond its ends it continues as a straight
/// line.
#[derive(Clone, Debug)]
pub struct Monotone {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

impl Monotone {
    /// Builds the curve through the points (`x`, `y`). There must be at least one point, the coordinates must be
    /// finite, and `x` must be strictly ascending. Both vectors have the same length.
    pub fn new(x: Vec<f64>, y: Vec<f64>) -> Self {
        let steps: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let secants: Vec<f64> =
            y.windows(2).zip(&steps).map(|(pair, step)| (pair[1] - pair[0]) / step).collect();
        let slopes = match secants[..] {
            [] => vec![0.0],
            [only] => vec![only; 2],
            _ => {
                let last = secants.len() - 1;
                let inner = (0..last).map(|i| inner([steps[i], steps[i + 1]], [secants[i], secants[i + 1]]));
                std::iter::once(end([steps[0], steps[1]], [secants[0], secants[1]]))
                    .chain(inner)
                    .chain([end([steps[last], steps[last - 1]], [secants[last], secants[last - 1]])])
                    .collect()
            }
        };
        Self { x, y, slopes }
    }

    /// Returns the least value at the points, which is also the minimum of the curve between its ends.
    pub fn least(&self) -> f64 {
        self.y.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Returns the value at `x`. At a tabulated point the value is exact to the last bit.
    pub fn at(&self, x: f64) -> f64 {
        // The last point that lies at or before `x`.
        let before = self.x.partition_point(|point| *point <= x).saturating_sub(1);
        let (t, y, slope) = (x - self.x[before], self.y[before], self.slopes[before]);
        let Some(&next) = self.x.get(before + 1).filter(|_| t > 0.0) else {
            return y + t * slope;
        };
        let step = next - self.x[before];
        let secant = (self.y[before + 1] - y) / step;
        let square = (3.0 * secant - 2.0 * slope - self.slopes[before + 1]) / step;
        let cube = (slope - 2.0 * secant + self.slopes[before + 1]) / (step * step);
        y + t * (slope + t * (square + t * cube))
    }
}

/// Returns the slope at an inner point: the harmonic mean of the two secants, weighted by the steps, or 0 at an
/// extremum.
fn inner([before, after]: [f64; 2], [left, right]: [f64; 2]) -> f64 {
    if left * right <= 0.0 {
        return 0.0;
    }
    let (a, b) = (2.0 * after + before, after + 2.0 * before);
    (a + b) / (a / left + b / right)
}

/// Returns the slope at an end from the two nearest steps and secants: that of a parabola, limited so that the curve
/// stays monotone.
fn end([first, second]: [f64; 2], [near, far]: [f64; 2]) -> f64 {
    let slope = ((2.0 * first + second) * near - first * far) / (first + second);
    if slope * near <= 0.0 {
        0.0
    } else if near * far <= 0.0 && slope.abs() > 3.0 * near.abs() {
        3.0 * near
    } else {
        slope
    }
}

/// Returns y at `x` on the polyline through `points`, which are one or more pairs (x, y) with ascending x. The first
/// and the last segment extend beyond the ends.
pub fn on_broken_line(points: &[[f64; 2]], x: f64) -> f64 {
    let next = points.partition_point(|[point_x, _]| *point_x <= x).clamp(1, points.len().max(2) - 1);
    let [from, first] = points[next - 1];
    let Some([to, second]) = points.get(next) else { return first };
    let part = if *to > from { (x - from) / (to - from) } else { 1.0 };
    first + part * (second - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_that_of_another_program() {
        // Reference values from SciPy 1.17, PchipInterpolator([0, 1, 3, 4], [0, 2, 2.5, 7]).
        let curve = Monotone::new(vec![0.0, 1.0, 3.0, 4.0], vec![0.0, 2.0, 2.5, 7.0]);
        for (x, y) in SCIPY {
            assert!((curve.at(x) - y).abs() < 1e-14, "{x}: {} is not {y}", curve.at(x));
        }
    }

    const SCIPY: [(f64, f64); 4] = [
        (0.25, 0.652_977_195_945_945_9),
        (0.5, 1.262_105_855_855_856),
        (2.0, 2.240_128_115_128_115),
        (3.7, 5.191_386_363_636_365),
    ];

    #[test]
    fn points_are_met_to_the_bit_and_the_ends_go_on_straight() {
        let (x, y) = ([0.1, 0.3, 0.7, 1.9], [3.0, 0.1, 0.2, 0.2]);
        let curve = Monotone::new(x.to_vec(), y.to_vec());
        assert_eq!(x.map(|x| curve.at(x)), y);
        let slope = (curve.at(0.1) - curve.at(-0.9)) / 1.0;
        assert!((curve.at(0.1 + 1e-7) - curve.at(0.1) - 1e-7 * slope).abs() < 1e-12);
        // A curve that ends with slope 0 continues with slope 0.
        assert_eq!(curve.at(7.0), 0.2);
        assert_eq!(Monotone::new(vec![2.0], vec![5.0]).at(-3.0), 5.0);
        let line = Monotone::new(vec![1.0, 3.0], vec![5.0, 9.0]);
        assert_eq!([0.0, 2.0, 4.0].map(|x| line.at(x)), [3.0, 7.0, 11.0]);
    }

    #[test]
    fn a_monotone_cubic_stays_between_and_its_slope_is_continuous() {
        let (x, y) = ([0.0, 0.4, 0.5, 2.0, 2.2], [0.0, 10.0, 10.0, 9.9, 40.0]);
        let curve = Monotone::new(x.to_vec(), y.to_vec());
        for (x, y) in x.windows(2).zip(y.windows(2)) {
            let mut last = y[0];
            for i in 0..=200 {
                let value = curve.at(x[0] + (x[1] - x[0]) * f64::from(i) / 200.0);
                assert!(
                    (value - last) * (y[1] - y[0]) >= -1e-12
                        && (y[0].min(y[1]) - 1e-12..=y[0].max(y[1]) + 1e-12).contains(&value)
                );
                last = value;
            }
        }
        for x in x {
            let slope = |from: f64, to: f64| (curve.at(to) - curve.at(from)) / (to - from);
            let (left, right) = (slope(x - 1e-6, x), slope(x, x + 1e-6));
            assert!((left - right).abs() < 1e-2, "{x}: {left} {right}");
        }
    }

    #[test]
    fn it_goes_through_the_points_and_on_beyond_them() {
        let points = [[0.0, 1.0], [2.0, 5.0], [2.0, 7.0], [3.0, 6.0]];
        for (x, y) in [(-1.0, -1.0), (0.0, 1.0), (1.0, 3.0), (2.0, 7.0), (2.5, 6.5), (3.0, 6.0), (4.0, 5.0)] {
            assert_eq!(on_broken_line(&points, x), y, "{x}");
        }
        assert_eq!(on_broken_line(&points[..1], 3.0), 1.0);
    }
}
