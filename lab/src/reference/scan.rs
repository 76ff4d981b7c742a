//! The first crossing of a ray with an asphere, by the profile's formula alone. The ray is divided into intervals until
//! the first change of sign of z - (c r²/(1 + √(1 - (1 + k) c² r²)) + Σ `A_i` r^i) is proven.
//!
//! On an interval, interval arithmetic bounds the height F of the ray above the surface and its derivative. The conic's
//! part and its derivative with respect to u = r² are monotonic in magnitude, so their values at the ends bound them;
//! the mean value theorem bounds the terms (R. E. Moore, *Interval Analysis*, 1966, ch. 2 and 3, except that a generous
//! margin covers the rounding). The scan goes from left to right. It discards an interval on which F is negative, F
//! decreases, or F increases and is still negative at the end. If F increases and is positive at the end, the crossing
//! is bracketed, and bisection and Newton's method find it to all digits. Every other interval is halved.

use realistic_optics::{
    lens::Figure,
    prescription::{Asphere, FIRST_POWER},
    trace::{Blocked, Real},
};

use super::double_double::{DoubleDouble, Vector};

/// An aspheric figure by its formula, z along the direction of travel of light.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    asphere: Asphere,
    /// Factor from z along the direction of travel to z toward the film.
    sign: f64,
    /// Clear semi-diameter, mm.
    edge_radius: f64,
    /// z of the surface's lowest point, and z at which the search ends.
    lowest: f64,
    highest: f64,
}

/// The profile at a distance from the axis.
pub(super) struct Profile<R> {
    pub height: R,
    /// (dz/dr)/r times `root`.
    pub slope: R,
    /// √(1 - (1 + k) c² r²), at least 0; on a sphere the cosine of the slope angle.
    pub root: R,
}

/// A closed interval of numbers.
#[derive(Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

/// Length, relative to the whole search, at which an interval is no longer halved.
const FINEST: f64 = 1e-14;
/// Maximum number of intervals, more than any ray has needed.
const MOST: usize = 1_000_000;
/// Maximum number of iterations, enough to reduce a bracket to the last digit; and the relative step that ends the
/// iterations.
const TURNS: usize = 110;
const EXACT: f64 = 1e-30;
/// Margin for rounding, relative to the operands of a sum.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

impl Scan {
    /// Builds a scan; `sign` is 1 for light toward the film, -1 for light toward the scene.
    pub fn new(figure: &Figure, sign: f64) -> Self {
        let [low, high] = figure.bounds.sagitta;
        let [lowest, highest] = if sign > 0.0 { [low, high] } else { [-high, -low] };
        let size = highest - lowest + figure.rim;
        // Start slightly before the lowest point, so that a ray aimed at that point starts before it.
        let (lowest, highest) = (lowest - 1e-12 * size, highest + size);
        Self { asphere: figure.asphere, sign, edge_radius: figure.rim, lowest, highest }
    }

    /// Finds the distance from `point`, in units of `direction`, at which the ray first crosses the surface toward the
    /// side ahead. `point` and `direction` are in the frame of the vertex, with z along the direction of travel.
    pub fn first_crossing(&self, point: Vector, direction: Vector) -> Result<DoubleDouble, Blocked> {
        let number = DoubleDouble::from_f64;
        let ray = ScannedRay::new(point, direction);
        if !(ray.climb > 0.0) {
            return Err(Blocked::TurnedBack);
        }
        let z = point[2].to_f64();
        // A ray may begin on the surface, up to the rounding of these numbers.
        let behind = -1e-24 * (z.abs() + self.edge_radius);
        let mut from = ((self.lowest - z) / ray.climb).max(behind);
        let mut to = (self.highest - z) / ray.climb;
        if let Some([enters, leaves]) = ray.inside(self.end()) {
            (from, to) = (from.max(enters), to.min(leaves));
        }
        if !(from < to) {
            return Err(Blocked::Missed);
        }
        let above = |t: f64| self.above(&ray, number(t)) > DoubleDouble::ZERO;
        if above(from) {
            return Err(Blocked::TurnedBack);
        }
        let finest = FINEST * (to - from);
        let mut open = vec![[from, to]];
        for _ in 0..MOST {
            let Some([from, to]) = open.pop() else { return Err(Blocked::Missed) };
            let [height, slope] = self.bounds(&ray, [from, to]);
            if height.high < 0.0 || slope.high < 0.0 {
                continue;
            }
            if slope.low > 0.0 || to - from <= finest {
                if above(to) {
                    return Ok(self.between(&ray, [number(from), number(to)]));
                }
                continue;
            }
            let middle = f64::midpoint(from, to);
            open.extend([[middle, to], [from, middle]]);
        }
        panic!("a ray at an asphere takes more than {MOST} intervals: {self:?}")
    }

    /// Evaluates the profile at the squared distance u from the axis. Beyond the edge, the terms continue as the
    /// paraboloid tangent to them at the edge; the conic ends at its own radius.
    pub fn profile<R: Real>(&self, u: R) -> Profile<R> {
        let number = R::from_f64;
        let c = number(self.sign) / number(self.asphere.radius);
        let kappa = R::ONE + number(self.asphere.conic);
        let square = R::ONE - kappa * c * c * u;
        let root = if square > R::ZERO { square.sqrt() } else { R::ZERO };
        let edge_square = number(self.edge_radius) * number(self.edge_radius);
        let inside = if u > edge_square { edge_square } else { u };
        // The sums of A_i r^i and of i A_i r^(i - 2); an odd power is r times a power of u.
        let mut power = inside;
        let (mut value, mut slope) = (R::ZERO, R::ZERO);
        let [odd, even] = [0, 1].map(|first| self.terms().skip(first).step_by(2));
        let mut below = R::ONE;
        for (i, term) in even {
            value = value + number(term) * power;
            slope = slope + number(i) * number(term) * below;
            (below, power) = (power, power * inside);
        }
        // On the axis the odd terms vanish, the tip of a cone has no slope, and the square root has no derivative.
        if inside > R::ZERO && self.terms().step_by(2).any(|(_, term)| term != 0.0) {
            let mut power = inside.sqrt();
            for (i, term) in odd {
                slope = slope + number(i) * number(term) * power / inside;
                value = value + number(term) * power;
                power = power * inside;
            }
        }
        let two = number(2.0);
        Profile {
            height: c * u / (R::ONE + root) + value + slope / two * (u - inside),
            slope: c + root * slope,
            root,
        }
    }

    /// Returns the powers, from the first power on, and their coefficients, z along the direction of travel.
    fn terms(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let powers = (FIRST_POWER as u32..).map(f64::from);
        powers.zip(self.asphere.terms).map(|(power, term)| (power, self.sign * term))
    }

    /// Returns the squared distance from the axis at which the conic ends.
    fn end(&self) -> f64 {
        let kappa = 1.0 + self.asphere.conic;
        if kappa > 0.0 { self.asphere.radius.powi(2) / kappa } else { f64::INFINITY }
    }

    /// Returns z of the ray minus z of the surface.
    fn above(&self, ray: &ScannedRay, t: DoubleDouble) -> DoubleDouble {
        let [x, y, z] = ray.at(t);
        z - self.profile(x * x + y * y).height
    }

    /// Bounds the height above the surface and its derivative on an interval.
    fn bounds(&self, ray: &ScannedRay, [from, to]: [f64; 2]) -> [Range; 2] {
        let middle = f64::midpoint(from, to);
        let half = (to - from) / 2.0;
        let z = ray.start[2] + middle * ray.climb;
        let z = Range::about(z, half * ray.climb + ROUNDING * (ray.start[2].abs() + z.abs()));
        let u = ray.height_squared(middle, half);
        let u_slope = Range::about(
            2.0 * (ray.along + ray.across * middle),
            2.0 * ray.across * half + ROUNDING * (ray.along.abs() + ray.across * middle.abs()),
        );
        let c = self.sign / self.asphere.radius;
        let root = |u: f64| (1.0 - (1.0 + self.asphere.conic) * c * c * u).max(0.0).sqrt();
        // Rounding of 1 - κ c² u is equivalent to rounding of u.
        let ends = [
            (u.low * (1.0 - ROUNDING) - ROUNDING * self.edge_radius.powi(2)).max(0.0),
            u.high * (1.0 + ROUNDING),
        ];
        let conic = Range::of(ends.map(|u| c * u / (1.0 + root(u))));
        let conic_slope =
            if c == 0.0 { Range::of([0.0; 2]) } else { Range::of(ends.map(|u| c / root(u) / 2.0)) };
        let [terms, terms_slope] = self.terms_between(ends);
        [z - (conic + terms), Range::of([ray.climb; 2]) - (conic_slope + terms_slope) * u_slope]
    }

    /// Bounds the terms and their derivative with respect to u on an annulus.
    fn terms_between(&self, [u_low, u_high]: [f64; 2]) -> [Range; 2] {
        let [low, high] = [u_low, u_high].map(|u| u.sqrt().min(self.edge_radius));
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0 + ROUNDING * high);
        let [mut value, mut slope, mut steepest, mut bend, mut edge_slope, mut edge_size] = [0.0_f64; 6];
        for (i, term) in self.terms().filter(|(_, term)| *term != 0.0) {
            let power = i as i32;
            value += term * middle.powi(power);
            slope += i / 2.0 * term * middle.powi(power - 2);
            steepest += i * term.abs() * high.powi(power - 1);
            // The derivative of r with respect to u is steepest at the inner edge; that of r² is constant.
            let steepest = if power == 1 { low } else { high };
            bend += i * (i - 2.0).abs() / 2.0 * term.abs() * steepest.powi(power - 3);
            edge_slope += i / 2.0 * term * self.edge_radius.powi(power - 2);
            edge_size += i / 2.0 * term.abs() * self.edge_radius.powi(power - 2);
        }
        let beyond = [u_low, u_high].map(|u| (u - self.edge_radius.powi(2)).max(0.0));
        let sizes = steepest * high + bend * high * high + edge_size * beyond[1];
        let beyond = Range::of(beyond.map(|u| edge_slope * u));
        let value = Range::about(value, steepest * half + ROUNDING * sizes) + beyond;
        [value, Range::about(slope, bend * half + ROUNDING * (edge_size + bend * high))]
    }

    /// Finds the crossing between a point before it and a point behind it, to all digits.
    fn between(&self, ray: &ScannedRay, [mut from, mut to]: [DoubleDouble; 2]) -> DoubleDouble {
        let half = DoubleDouble::from_f64(0.5);
        let narrow = |from: &mut DoubleDouble, to: &mut DoubleDouble, t: DoubleDouble| {
            *if self.above(ray, t) > DoubleDouble::ZERO { to } else { from } = t;
        };
        let mut t = (from + to) * half;
        // Every iteration at least halves the bracket, even if Newton's step is poor.
        for _ in 0..TURNS {
            let middle = (from + to) * half;
            narrow(&mut from, &mut to, middle);
            let [x, y, z] = ray.at(t);
            let Profile { height, slope, root } = self.profile(x * x + y * y);
            let facing = root * ray.direction[2] - slope * (x * ray.direction[0] + y * ray.direction[1]);
            let next = t + (height - z) * root / facing;
            if (next - t).to_f64().abs() <= EXACT * (t.to_f64().abs() + self.edge_radius / ray.climb) {
                return next;
            }
            t = if next > from && to > next { next } else { (from + to) * half };
            narrow(&mut from, &mut to, t);
        }
        t
    }
}

/// A ray, with double-precision copies of the quantities that need no more digits.
struct ScannedRay {
    point: Vector,
    direction: Vector,
    start: [f64; 3],
    climb: f64,
    /// x² + y² = u + 2 `along` t + `across` t².
    u: f64,
    along: f64,
    across: f64,
}

impl ScannedRay {
    fn new(point: Vector, direction: Vector) -> Self {
        let [x, y, z] = point.map(Real::to_f64);
        let [dx, dy, climb] = direction.map(Real::to_f64);
        let (u, along, across) = (x * x + y * y, x * dx + y * dy, dx * dx + dy * dy);
        Self { point, direction, start: [x, y, z], climb, u, along, across }
    }

    fn at(&self, t: DoubleDouble) -> Vector {
        std::array::from_fn(|i| self.point[i] + t * self.direction[i])
    }

    /// Returns the interval in which the squared distance from the axis is below `end`: `None` if the distance is
    /// always below, and an empty interval if it never is.
    fn inside(&self, end: f64) -> Option<[f64; 2]> {
        if end.is_infinite() || (self.across == 0.0 && self.u <= end) {
            return None;
        }
        let square = self.along * self.along - self.across * (self.u - end);
        if !(square > 0.0) {
            return Some([f64::INFINITY, f64::NEG_INFINITY]);
        }
        Some([-1.0, 1.0].map(|side| (-self.along + side * square.sqrt()) / self.across))
    }

    /// Bounds x² + y² within `half` of `t`.
    fn height_squared(&self, t: f64, half: f64) -> Range {
        let middle = self.u + t * (2.0 * self.along + t * self.across);
        let slope = 2.0 * (self.along + t * self.across).abs() * half;
        let rounding = ROUNDING * (self.u + t.abs() * (2.0 * self.along.abs() + t.abs() * self.across));
        let high = middle + slope + self.across * half * half + rounding;
        Range { low: (middle - slope - rounding).max(0.0), high: high.max(0.0) }
    }
}

impl Range {
    /// Returns the interval between two numbers in either order, widened by the rounding margin; all numbers if one of
    /// them is NaN.
    fn of([a, b]: [f64; 2]) -> Self {
        if a.is_nan() || b.is_nan() {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let widened = |x: f64, side: f64| if x.is_finite() { x + side * ROUNDING * x.abs() } else { x };
        Self { low: widened(a.min(b), -1.0), high: widened(a.max(b), 1.0) }
    }

    fn about(middle: f64, half: f64) -> Self {
        Self::of([middle - half, middle + half])
    }
}

impl std::ops::Add for Range {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::of([self.low + other.low, self.high + other.high])
    }
}

impl std::ops::Sub for Range {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::of([self.low - other.high, self.high - other.low])
    }
}

impl std::ops::Mul for Range {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let products = [self.low, self.high].map(|a| [a * other.low, a * other.high]);
        let all = products.iter().flatten();
        // 0 times infinity, at the conic's end, gives no bound.
        if all.clone().any(|product| product.is_nan()) {
            return Self::of([f64::NAN; 2]);
        }
        let low = all.clone().fold(f64::INFINITY, |least, product| least.min(*product));
        let high = all.fold(f64::NEG_INFINITY, |most, product| most.max(*product));
        Self::of([low, high])
    }
}
