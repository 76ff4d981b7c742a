//! Stretches of an outline's arcs: points of the edge about a centre in, 1/distance as a polynomial of the angle out.

use super::{search::Crossing, view::Limit};

/// A point of the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Angle about the centre from the sx axis, in [0, π] (beyond by mirrored points).
    pub angle: f64,
    /// 1/distance from the centre: a straight edge or a conic about its focus is a pure
    /// sinusoid in it.
    pub inverse: f64,
    pub limit: Limit,
}

/// A stretch of an arc: 1/distance as a cubic in the angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub from: f64,
    pub to: f64,
    /// In powers of the angle less `from`.
    pub cubic: [f64; 4],
}

impl Piece {
    /// Distance of the edge from the centre.
    pub fn radius(&self, angle: f64) -> f64 {
        self.inverse(angle).recip()
    }

    pub fn inverse(&self, angle: f64) -> f64 {
        let t = angle - self.from;
        let [a, b, c, d] = self.cubic;
        a + t * (b + t * (c + t * d))
    }
}

/// The end of an arc as it goes on: 1/distance as a polynomial of the angle.
#[derive(Clone, Copy)]
pub(super) struct Parabola {
    /// The angle of its nearest point.
    from: f64,
    /// In powers of the angle less `from`.
    coefficients: [f64; 3],
}

impl Parabola {
    /// Through one to three points, the nearest one first.
    pub fn through(points: &[Point]) -> Self {
        let steepness = |a: &Point, b: &Point| (b.inverse - a.inverse) / (b.angle - a.angle);
        let from = points[0].angle;
        let (linear, square) = match points {
            [_] => (0.0, 0.0),
            [a, b] => (steepness(a, b), 0.0),
            [a, b, c, ..] => {
                let square = (steepness(b, c) - steepness(a, b)) / (c.angle - a.angle);
                (steepness(a, b) - square * (b.angle - from), square)
            }
            [] => unreachable!("an arc has a point"),
        };
        Self { from, coefficients: [points[0].inverse, linear, square] }
    }

    pub fn at(self, angle: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        let t = angle - self.from;
        a + t * (b + t * c)
    }

    /// The angle between `low` and `high` where it meets another one, for two that do just once.
    pub fn meets(self, other: Self, low: f64, high: f64) -> f64 {
        let steepness = |arc: Self| arc.coefficients[1] + 2.0 * (low - arc.from) * arc.coefficients[2];
        let a = self.at(low) - other.at(low);
        let b = steepness(self) - steepness(other);
        let c = self.coefficients[2] - other.coefficients[2];
        let discriminant = (b * b - 4.0 * a * c).max(0.0).sqrt();
        let q = -0.5 * (b + discriminant.copysign(b));
        let width = high - low;
        let off = |x: f64| if x.is_finite() { (x - x.clamp(0.0, width)).abs() } else { f64::INFINITY };
        let [x, y] = [a / q, q / c];
        low + if off(x) <= off(y) { x } else { y }.clamp(0.0, width)
    }
}

impl Point {
    pub fn new(angle: f64, crossing: Crossing) -> Self {
        Self { angle, inverse: crossing.radius.recip(), limit: crossing.limit }
    }
}

/// The arc between the points `i` and `i + 1`, through four of its points or as many as there are.
pub(super) fn piece(points: &[Point], i: usize) -> Piece {
    let (from, to) = (points[i].angle, points[i + 1].angle);
    let ((below, lower), (above, higher)) = (
        beside(points, (0..i).rev(), [from, to], points[i].limit),
        beside(points, i + 2..points.len(), [to, from], points[i].limit),
    );
    // One on each side where the arc goes on to both, else two on the one.
    let (low, high) = (lower.min(2 - higher.min(1)), higher.min(2 - lower.min(1)));
    let stencil =
        [i, i + 1].into_iter().chain(below.into_iter().take(low)).chain(above.into_iter().take(high));
    // Newton's divided differences, then their products multiplied out about `from`.
    let mut node = [0.0; 4];
    let mut difference = [0.0; 4];
    let mut count = 0;
    for point in stencil.map(|k| points[k]) {
        (node[count], difference[count]) = (point.angle - from, point.inverse);
        count += 1;
    }
    for order in 1..count {
        for k in (order..count).rev() {
            difference[k] = (difference[k] - difference[k - 1]) / (node[k] - node[k - order]);
        }
    }
    let mut cubic = [difference[3], 0.0, 0.0, 0.0];
    for k in (0..3).rev() {
        cubic = [
            difference[k] - node[k] * cubic[0],
            cubic[0] - node[k] * cubic[1],
            cubic[1] - node[k] * cubic[2],
            cubic[2] - node[k] * cubic[3],
        ];
    }
    Piece { from, to, cubic }
}

/// Up to two of an arc's points among those of the numbers `others`, from the end `near` of a stretch whose other end is
/// `far`; and how many.
fn beside(
    points: &[Point],
    others: impl Iterator<Item = usize>,
    [near, far]: [f64; 2],
    limit: Limit,
) -> ([usize; 2], usize) {
    // Points much closer to one another than the stretch is long would multiply their errors.
    let apart = 0.25 * (far - near).abs();
    let (mut found, mut count, mut last) = ([0; 2], 0, near);
    for k in others.take_while(|&k| points[k].limit == limit) {
        if (points[k].angle - last).abs() >= apart {
            (found[count], last) = (k, points[k].angle);
            count += 1;
            if count == 2 {
                break;
            }
        }
    }
    (found, count)
}

/// Unit vector of an angle.
pub(crate) fn direction(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}

/// Lagrange's polynomial through the points, for 1/radius.
pub(super) fn extend(points: &[Point], angle: f64) -> f64 {
    let mut sum = 0.0;
    for (i, own) in points.iter().enumerate() {
        let mut term = own.inverse;
        for (j, other) in points.iter().enumerate() {
            if i != j {
                term *= (angle - other.angle) / (own.angle - other.angle);
            }
        }
        sum += term;
    }
    sum
}
