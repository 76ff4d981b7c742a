//! The first crossing of a ray with a surface, by the surface's formula alone. The ray is divided into intervals until
//! the first change of sign of z - h(x, y) is proven. h is c r²/(1 + √(1 - (1 + k) c² r²)) + Σ `A_i` r^i, or the formula
//! of a surface that is not symmetric about its axis (`form`).
//!
//! On an interval, interval arithmetic bounds the height F of the ray above the surface and its derivative. The conic's
//! part and its derivative with respect to u = r² are monotonic in magnitude, so their values at the ends bound them;
//! the mean value theorem bounds the terms (R. E. Moore, *Interval Analysis*, 1966, ch. 2 and 3, except that a generous
//! margin covers the rounding). Surfaces without symmetry are evaluated with intervals that carry derivatives. The scan
//! goes from left to right. It discards an interval on which F is negative, F decreases, or F increases and is still
//! negative at the end. If F increases and is positive at the end, the crossing is bracketed, and bisection and Newton's
//! method find it to all digits. Every other interval is halved.

use realistic_optics::{
    lens::{Figure, Surface, UnsymmetricFigure},
    prescription::{Asphere, Cylinder, Meridian, NO_TERMS, Unsymmetric},
    trace::{Blocked, Real},
};

use super::{
    exact::dot,
    form::{self, Number},
    range::{ROUNDING, Range, Slope},
};

/// A surface by its formula, z along the direction of travel of light.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    form: Form,
    /// Factor from z along the direction of travel to z toward the film.
    sign: f64,
    /// Clear semi-diameter, mm.
    edge_radius: f64,
    /// z of the surface's lowest point, and z at which the search ends.
    lowest: f64,
    highest: f64,
    /// Factors of x² and y² in the sum that must stay below `end` for the surface to exist.
    weights: [f64; 2],
    end: f64,
}

/// The formula of a surface, z toward the film.
#[derive(Clone, Debug)]
enum Form {
    /// A plane or a sphere of this radius.
    Plain(f64),
    /// A surface of revolution.
    Round(Asphere),
    /// A surface without symmetry about its axis.
    Unsymmetric(Unsymmetric),
}

/// The surface near a point.
pub(super) struct Near<R> {
    /// Positive before the surface. Divided by the product of `normal` and a direction, the first-order distance to the
    /// surface along that direction.
    pub residual: R,
    /// The normal, of any length, pointing to the side ahead.
    pub normal: [R; 3],
}

/// The profile at a distance from the axis.
struct Profile<R> {
    height: R,
    /// (dz/dr)/r times `root`.
    slope: R,
    /// √(1 - (1 + k) c² r²), at least 0; on a sphere the cosine of the slope angle.
    root: R,
}

/// Length, relative to the whole search, at which an interval is no longer halved.
const FINEST: f64 = 1e-14;
/// Maximum number of intervals, more than any ray has needed.
const MOST: usize = 1_000_000;
/// Maximum number of iterations, enough to reduce a bracket to the last digit; and the relative step that ends the
/// iterations, in units of the rounding error.
const TURNS: usize = 300;
const EXACT: f64 = 32.0;

impl Scan {
    /// Builds a scan of a surface; `sign` is 1 for light toward the film, -1 for light toward the scene.
    pub fn new(surface: &Surface, sign: f64) -> Self {
        let end_of = |radius: f64, conic: f64| {
            if 1.0 + conic > 0.0 { radius * radius / (1.0 + conic) } else { f64::INFINITY }
        };
        let ([low, high], form, weights, end) = match (&surface.figure, &surface.unsymmetric) {
            (Some(Figure { asphere, bounds, .. }), _) => {
                let end = end_of(asphere.radius, asphere.conic);
                (bounds.sagitta, Form::Round(*asphere), [1.0; 2], end)
            }
            (None, Some(figure)) => {
                let UnsymmetricFigure { inside, beyond, surface, reach, .. } = &**figure;
                let form = Form::Unsymmetric(*surface);
                match surface.cylinder() {
                    Some(Cylinder { meridian, radius, conic }) => {
                        let weights = if meridian == Meridian::X { [1.0, 0.0] } else { [0.0, 1.0] };
                        (inside.sagitta, form, weights, end_of(radius, conic))
                    }
                    None => (beyond.sagitta, form, [1.0; 2], reach * reach),
                }
            }
            (None, None) => {
                let [low, high] = surface.sagitta_range();
                ([-high, -low], Form::Plain(surface.radius), [1.0; 2], f64::INFINITY)
            }
        };
        let [lowest, highest] = if sign > 0.0 { [low, high] } else { [-high, -low] };
        let edge_radius = surface.semi_diameter;
        let size = highest - lowest + edge_radius;
        // Start slightly before the lowest point, so that a ray aimed at that point starts before it.
        let (lowest, highest) = (lowest - 1e-12 * size, highest + size);
        Self { form, sign, edge_radius, lowest, highest, weights, end }
    }

    /// Finds the distance from `point`, in units of `direction`, at which the ray first crosses the surface toward the
    /// side ahead. `point` and `direction` are in the frame of the vertex, with z along the direction of travel. A plane
    /// that only limits rays may lie behind the point.
    pub fn first_crossing<R: Real>(
        &self,
        point: [R; 3],
        direction: [R; 3],
        only_limits: bool,
    ) -> Result<R, Blocked> {
        if let Form::Plain(radius) = self.form {
            return self.plain_crossing(point, direction, radius, only_limits);
        }
        let number = R::from_f64;
        let ray = ScannedRay::new(point, direction, self.weights);
        if !(ray.climb > 0.0) {
            return Err(Blocked::TurnedBack);
        }
        let z = point[2].to_f64();
        // A ray may begin on the surface, up to the rounding of these numbers.
        let behind = -1e-24 * (z.abs() + self.edge_radius);
        let mut from = ((self.lowest - z) / ray.climb).max(behind);
        let mut to = (self.highest - z) / ray.climb;
        if let Some([enters, leaves]) = ray.inside(self.end) {
            (from, to) = (from.max(enters), to.min(leaves));
        }
        if !(from < to) {
            return Err(Blocked::Missed);
        }
        let above = |t: f64| self.above(&ray, number(t)) > R::ZERO;
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
        panic!("a ray takes more than {MOST} intervals: {self:?}")
    }

    /// Finds the crossing with a sphere or a plane.
    fn plain_crossing<R: Real>(
        &self,
        mut point: [R; 3],
        direction: [R; 3],
        radius: f64,
        only_limits: bool,
    ) -> Result<R, Blocked> {
        let c = R::from_f64(self.sign) * form::curvature(radius);
        // A ray may begin on the surface, up to the rounding of these numbers.
        let behind = -1e-24 * (point[2].to_f64().abs() + self.edge_radius);
        // Far before the surface the equation below would lose digits.
        let mut moved = R::ZERO;
        if direction[2] > R::ZERO && -point[2].to_f64() * c.to_f64().abs() > 2.0 {
            moved = -point[2] / direction[2];
            point = [point[0] + moved * direction[0], point[1] + moved * direction[1], R::ZERO];
        }
        let f = c * dot(point, point) - point[2] - point[2];
        let g = direction[2] - c * dot(point, direction);
        let square = g * g - c * dot(direction, direction) * f;
        if !(square > R::ZERO) {
            return Err(Blocked::Missed);
        }
        let root = square.sqrt();
        let t = if g > R::ZERO { f / (g + root) } else { (g - root) / (c * dot(direction, direction)) };
        if !only_limits && (moved + t).to_f64() < behind {
            return Err(Blocked::TurnedBack);
        }
        // Beyond the equator, the sphere is not part of the surface.
        if R::ONE - c * (point[2] + t * direction[2]) < R::ZERO {
            return Err(Blocked::Missed);
        }
        Ok(moved + t)
    }

    /// Returns the surface near a point, which is on it but for the rounding of the number type.
    pub fn near<R: Real>(&self, [x, y, z]: [R; 3]) -> Near<R> {
        match &self.form {
            Form::Plain(radius) => {
                let c = R::from_f64(self.sign) * form::curvature(*radius);
                let half = R::from_f64(0.5);
                let residual = half * c * (x * x + y * y + z * z) - z;
                Near { residual, normal: [-(c * x), -(c * y), R::ONE - c * z] }
            }
            Form::Round(asphere) => {
                let Profile { height, slope, root } = self.profile(asphere, x * x + y * y);
                Near { residual: (height - z) * root, normal: [-(slope * x), -(slope * y), root] }
            }
            Form::Unsymmetric(surface) => {
                let [dx, dy] = form::gradient(surface, [x, y]).map(|slope| R::from_f64(self.sign) * slope);
                Near { residual: self.height([x, y]) - z, normal: [-dx, -dy, R::ONE] }
            }
        }
    }

    /// Returns z of the surface at (x, y).
    pub fn height<R: Real>(&self, [x, y]: [R; 2]) -> R {
        match &self.form {
            Form::Plain(radius) => {
                let asphere = Asphere { radius: *radius, conic: 0.0, terms: NO_TERMS };
                self.profile(&asphere, x * x + y * y).height
            }
            Form::Round(asphere) => self.profile(asphere, x * x + y * y).height,
            Form::Unsymmetric(surface) => R::from_f64(self.sign) * form::height(surface, [x, y]),
        }
    }

    /// Evaluates the profile at the squared distance u from the axis. Beyond the edge, the terms continue as the
    /// paraboloid tangent to them at the edge; the conic ends at its own radius.
    fn profile<R: Real>(&self, asphere: &Asphere, u: R) -> Profile<R> {
        let number = R::from_f64;
        let c = number(self.sign) * form::curvature(asphere.radius);
        let kappa = R::ONE + number(asphere.conic);
        let square = R::ONE - kappa * c * c * u;
        let root = if square > R::ZERO { square.sqrt() } else { R::ZERO };
        let edge_square = number(self.edge_radius) * number(self.edge_radius);
        let inside = if u > edge_square { edge_square } else { u };
        // The sums of A_i r^i and of i A_i r^(i - 2); an odd power is r times a power of u.
        let mut power = inside;
        let (mut value, mut slope) = (R::ZERO, R::ZERO);
        let [odd, even] = [0, 1].map(|first| self.terms(asphere).skip(first).step_by(2));
        let mut below = R::ONE;
        for (i, term) in even {
            value = value + number(term) * power;
            slope = slope + number(i) * number(term) * below;
            (below, power) = (power, power * inside);
        }
        // On the axis the odd terms vanish, the tip of a cone has no slope, and the square root has no derivative.
        if inside > R::ZERO && self.terms(asphere).step_by(2).any(|(_, term)| term != 0.0) {
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
    fn terms<'a>(&'a self, asphere: &'a Asphere) -> impl Iterator<Item = (f64, f64)> + 'a {
        form::terms(asphere).map(|(power, term)| (f64::from(power), self.sign * term))
    }

    /// Returns z of the ray minus z of the surface.
    fn above<R: Real>(&self, ray: &ScannedRay<R>, t: R) -> R {
        let [x, y, z] = ray.at(t);
        z - self.height([x, y])
    }

    /// Bounds the height above the surface and its derivative on an interval.
    fn bounds<R>(&self, ray: &ScannedRay<R>, span: [f64; 2]) -> [Range; 2] {
        match &self.form {
            Form::Unsymmetric(surface) => {
                let [x, y, z] = ray.between(span);
                let above = z - Slope::constant(self.sign) * form::height(surface, [x, y]);
                [above.value, above.slope]
            }
            Form::Round(asphere) => self.round_bounds(asphere, ray, span),
            Form::Plain(_) => unreachable!("spheres and planes are crossed in closed form"),
        }
    }

    /// Bounds the same for a surface of revolution.
    fn round_bounds<R>(&self, asphere: &Asphere, ray: &ScannedRay<R>, [from, to]: [f64; 2]) -> [Range; 2] {
        let middle = f64::midpoint(from, to);
        let half = (to - from) / 2.0;
        let z = ray.start[2] + middle * ray.climb;
        let z = Range::about(z, half * ray.climb + ROUNDING * (ray.start[2].abs() + z.abs()));
        let u = ray.height_squared(middle, half);
        let u_slope = Range::about(
            2.0 * (ray.along + ray.across * middle),
            2.0 * ray.across * half + ROUNDING * (ray.along.abs() + ray.across * middle.abs()),
        );
        let c = self.sign / asphere.radius;
        let root = |u: f64| (1.0 - (1.0 + asphere.conic) * c * c * u).max(0.0).sqrt();
        // Rounding of 1 - κ c² u is equivalent to rounding of u.
        let ends = [
            (u.low * (1.0 - ROUNDING) - ROUNDING * self.edge_radius.powi(2)).max(0.0),
            u.high * (1.0 + ROUNDING),
        ];
        let conic = Range::of(ends.map(|u| c * u / (1.0 + root(u))));
        let conic_slope =
            if c == 0.0 { Range::of([0.0; 2]) } else { Range::of(ends.map(|u| c / root(u) / 2.0)) };
        let [terms, terms_slope] = self.terms_between(asphere, ends);
        [z - (conic + terms), Range::of([ray.climb; 2]) - (conic_slope + terms_slope) * u_slope]
    }

    /// Bounds the terms and their derivative with respect to u on an annulus.
    fn terms_between(&self, asphere: &Asphere, [u_low, u_high]: [f64; 2]) -> [Range; 2] {
        let [low, high] = [u_low, u_high].map(|u| u.sqrt().min(self.edge_radius));
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0 + ROUNDING * high);
        let [mut value, mut slope, mut steepest, mut bend, mut edge_slope, mut edge_size] = [0.0_f64; 6];
        for (i, term) in self.terms(asphere).filter(|(_, term)| *term != 0.0) {
            let power = i as i32;
            value += term * middle.powi(power);
            slope += i / 2.0 * term * middle.powi(power - 2);
            steepest += i * term.abs() * high.powi(power - 1);
            // The derivative of r² with respect to u is constant; that of r is steepest at the inner edge.
            if power != 2 {
                let worst = if power == 1 { low } else { high };
                bend += i * (i - 2.0).abs() / 2.0 * term.abs() * worst.powi(power - 3);
            }
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
    fn between<R: Real>(&self, ray: &ScannedRay<R>, [mut from, mut to]: [R; 2]) -> R {
        let half = R::from_f64(0.5);
        let narrow = |from: &mut R, to: &mut R, t: R| {
            *if self.above(ray, t) > R::ZERO { to } else { from } = t;
        };
        let mut t = (from + to) * half;
        // Every iteration at least halves the bracket, even if Newton's step is poor.
        for _ in 0..TURNS {
            let middle = (from + to) * half;
            narrow(&mut from, &mut to, middle);
            let Near { residual, normal } = self.near(ray.at(t));
            let step = residual / dot(normal, ray.direction);
            let next = t + step;
            let size = t.to_f64().abs() + self.edge_radius / ray.climb;
            if step.to_f64().abs() <= EXACT * R::EPSILON * size {
                return next;
            }
            t = if next > from && to > next { next } else { (from + to) * half };
            narrow(&mut from, &mut to, t);
        }
        t
    }
}

/// A ray, with double-precision copies of the quantities that need no more digits.
struct ScannedRay<R> {
    point: [R; 3],
    direction: [R; 3],
    start: [f64; 3],
    slopes: [f64; 3],
    climb: f64,
    /// The weighted sum of x² and y² is u + 2 `along` t + `across` t².
    u: f64,
    along: f64,
    across: f64,
}

impl<R: Real> ScannedRay<R> {
    fn new(point: [R; 3], direction: [R; 3], weights: [f64; 2]) -> Self {
        let (start, slopes) = (point.map(R::to_f64), direction.map(R::to_f64));
        let sum = |a: [f64; 3], b: [f64; 3]| weights[0] * a[0] * b[0] + weights[1] * a[1] * b[1];
        let (u, along, across) = (sum(start, start), sum(start, slopes), sum(slopes, slopes));
        Self { point, direction, start, slopes, climb: slopes[2], u, along, across }
    }

    fn at(&self, t: R) -> [R; 3] {
        std::array::from_fn(|i| self.point[i] + t * self.direction[i])
    }
}

impl<R> ScannedRay<R> {
    /// Bounds the coordinates of the ray and their derivatives on an interval.
    fn between(&self, [from, to]: [f64; 2]) -> [Slope; 3] {
        let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
        std::array::from_fn(|i| {
            let (start, slope) = (self.start[i], self.slopes[i]);
            let at = start + middle * slope;
            let rounding = ROUNDING * (start.abs() + at.abs());
            Slope { value: Range::about(at, half * slope.abs() + rounding), slope: Range::of([slope; 2]) }
        })
    }

    /// Returns the interval in which the weighted sum of x² and y² is below `end`: `None` if it always is, and an
    /// empty interval if it never is.
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
