//! Where a ray meets an aspheric surface, and the normal there, in numbers of any type.
//!
//! In the frame of the vertex, axis along the travel, with u = x² + y², T(u) the terms, w = z - T and κ = 1 + k, the surface
//! is G = (c/2)(u + κ w²) - w = 0 with q = 1 - κ c w > 0: the sheet and the half of the conic that hold the vertex, without a
//! root that vanishes at its edge. G is positive before the surface. N = -∇G = (-m x, -m y, q), m = c + 2 q dT/du, is normal
//! to it and points ahead. With V = n D and g = N·V, Newton's step along the ray is G/g.
//!
//! **Which of several crossings.** A ray meets the surface where it first crosses it toward the side ahead, having been
//! before it where it left the last surface, or at the height of this one's lowest point if that comes later. Newton's
//! iteration may find a later crossing; that it did not is proven for each ray. Let φ grow along the ray from negative
//! before the surface to 0 on it, with φ'' <= H all the way: then φ <= -φ'(t*) (t* - t) + H (t* - t)²/2 is negative from
//! t* back to t* - 2 φ'(t*)/H, and no crossing lies there. φ is -G, or for an open conic (κ <= 0) w minus the conic's
//! sagitta, whose φ' is g/q. Where that proves nothing, the ray is followed from its start in steps that the same bound
//! allows, which cannot leap over a crossing.

use super::state::{Blocked, State};
use crate::{
    lens::{Bounds, Figure},
    numeric::{Real, dot},
    prescription::FIRST_POWER,
};

/// An aspheric surface as a path has it, z along the travel.
#[derive(Clone, Debug)]
pub struct Aspheric<R> {
    /// The conic's curvature at its vertex, positive when its centre lies ahead.
    pub curvature: R,
    /// 1 + k.
    pub kappa: R,
    /// A2, A4, …, as far as there are any.
    pub even: Vec<R>,
    /// A3, A5, …, as far as there are any.
    pub odd: Vec<R>,
    /// The square of the rim's radius: beyond it T goes on as a paraboloid.
    pub rim: R,
    pub bend: Bend,
    /// The least and the greatest z inside the rim, and a little more than that.
    pub extent: [f64; 2],
    /// |G| up to this is rounding.
    pub tolerance: f64,
    /// The rim's radius.
    pub size: f64,
    /// Refractive index before.
    n: f64,
}

/// Bounds of how the surface bends away from a ray, as the proof of the first crossing needs them, out to [`Bend::REACH`]
/// times the rim's radius.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// φ'' <= `along` + `across` (Vx² + Vy²) for the φ whose φ' is g, or g/q times something that is at most q.
    pub along: f64,
    pub across: f64,
}

/// The surface near a point of a ray.
#[derive(Clone, Copy, Debug)]
struct Contact<R> {
    /// G.
    residual: R,
    /// N·V.
    facing: R,
    q: R,
    /// x² + y².
    height_squared: R,
}

/// Steps of Newton's iteration at most: double-double numbers take 8 on a telephone's lens.
const STEPS: u32 = 24;
/// Steps at most where a ray is followed.
const FOLLOWED: u32 = 256;

impl Bend {
    /// How far out the bounds hold, in radii of the rim.
    const REACH: f64 = 3.0;

    /// For the conic of curvature `c` and `kappa` = 1 + k with terms of these bounds, z along the travel, in a medium of
    /// index `n`; the terms' curvature is at least `least`, and `low` is the surface's least z.
    fn of(c: f64, kappa: f64, rim: f64, bounds: &Bounds, [least, low]: [f64; 2], n: f64) -> Self {
        // Out to 3 radii the paraboloid beyond the rim triples the slope and adds (3² - 1)/2 of slope times radius.
        let slope = Self::REACH * bounds.terms_slope;
        let terms = bounds.terms + (Self::REACH * Self::REACH - 1.0) / 2.0 * bounds.terms_slope * rim;
        let reach = Self::REACH * rim;
        let root = 1.0 - kappa * (c * reach).powi(2);
        // The surface's own w, of which a point before it has less.
        let most = match c > 0.0 {
            true if root >= 0.0 => c * reach * reach / (1.0 + root.sqrt()),
            true => (kappa * c).recip(),
            false => 0.0,
        };
        let q = (1.0 - kappa * c * most).abs().max((1.0 - kappa * c * (low - terms)).abs());
        let hollow = (-least).max(0.0);
        if kappa <= 0.0 {
            // The conic's second derivatives lie between 0 and c; times q, for the test has g and not g/q.
            return Self { along: 0.0, across: q * ((-c).max(0.0) + hollow) };
        }
        // -G'' = -c (Vx² + Vy² + κ w'²) + q w'', |w'| <= |Vz| + slope √(Vx² + Vy²) <= n √(1 + slope²).
        Self { along: (-c * kappa).max(0.0) * n * n * (1.0 + slope * slope), across: q * hollow - c }
    }
}

impl<R: Real> Aspheric<R> {
    /// The figure as light in a medium of index `n` meets it that travels toward the film (`forward`) or the scene.
    pub fn new(figure: &Figure, forward: bool, n: f64) -> Self {
        let sign = if forward { 1.0 } else { -1.0 };
        let Figure { asphere, rim, bounds } = figure;
        let signed = |[low, high]: [f64; 2]| if forward { [low, high] } else { [-high, -low] };
        let (extent, [least, _]) = (signed(bounds.sagitta), signed(bounds.terms_curvature));
        let c = sign * asphere.radius.recip();
        let column = |first: usize| -> Vec<R> {
            let mut column: Vec<f64> =
                asphere.terms.iter().skip(first - FIRST_POWER).step_by(2).map(|term| sign * term).collect();
            while column.last() == Some(&0.0) || column.last() == Some(&-0.0) {
                column.pop();
            }
            column.into_iter().map(R::from_f64).collect()
        };
        let one = R::from_f64(sign);
        let curvature =
            if asphere.radius.is_infinite() { R::ZERO } else { one / R::from_f64(asphere.radius) };
        let size = bounds.terms_size + rim + extent[1] - extent[0];
        let margin = 1024.0 * R::EPSILON * size;
        Self {
            curvature,
            kappa: R::ONE + R::from_f64(asphere.conic),
            even: column(FIRST_POWER),
            odd: column(FIRST_POWER + 1),
            rim: R::from_f64(*rim) * R::from_f64(*rim),
            bend: Bend::of(c, 1.0 + asphere.conic, *rim, bounds, [least, extent[0]], n),
            extent: [extent[0] - margin, extent[1] + margin],
            tolerance: 64.0 * R::EPSILON * size,
            size: *rim,
            n,
        }
    }

    /// Whether there are no terms.
    pub fn is_conic(&self) -> bool {
        self.even.is_empty() && self.odd.is_empty()
    }

    /// Moves the ray to the surface; it may meet it `slack` (in units of V) before where it last was.
    pub fn meet(&self, state: &mut State<R>, slack: R) -> Result<(), Blocked> {
        let State { p, v, lead } = *state;
        if !(v[2] > R::ZERO) {
            return Err(Blocked::TurnedBack);
        }
        // From the vertex plane, where lengths are the surface's own.
        let to_plane = -p[2] / v[2];
        let start = [p[0] + to_plane * v[0], p[1] + to_plane * v[1], R::ZERO];
        let (last, lowest) = (-(lead + to_plane) - slack, R::from_f64(self.extent[0]) / v[2]);
        // Where a range leaves it open, the earlier is the safe one.
        let from = if last > lowest { last } else { lowest };
        let t = self.first_crossing(start, v, from)?;
        *state = State { p: Line { start, v }.at(t), v, lead: R::ZERO };
        Ok(())
    }

    /// How far from `start` on the vertex plane, in units of V, the ray first crosses the surface after `from`.
    pub fn first_crossing(&self, start: [R; 3], v: [R; 3], from: R) -> Result<R, Blocked> {
        let line = Line { start, v };
        match self.newton(&line, from) {
            Some(t) => Ok(t),
            None => self.follow(&line, from),
        }
    }

    /// Where Newton's iteration leads, if that is proven to be the first crossing after `from`.
    fn newton(&self, line: &Line<R>, from: R) -> Option<R> {
        let close = 0.01 * R::EPSILON.sqrt() * self.size / self.n;
        let longest = R::from_f64(self.size + self.extent[1] - self.extent[0]) / line.v[2];
        let mut t = R::ZERO;
        let mut is_close = false;
        let mut steps = 0;
        while !is_close {
            let contact = self.contact(line, t);
            if steps == STEPS || !(contact.facing > R::ZERO) {
                return None;
            }
            let step = contact.residual / contact.facing;
            // Twice near, so that derivatives carried along are near, too.
            is_close = steps > 0 && step.magnitude() <= close;
            let step = if step > longest { longest } else { step };
            t = (t + if step < -longest { -longest } else { step }).estimate();
            steps += 1;
        }
        let contact = self.contact(line, t);
        let mut step = contact.residual / contact.facing;
        if R::IS_RANGE {
            // By the mean value theorem the crossing lies G/g away with g from between: within `far`, if G/g is with
            // every g there (R. E. Moore, *Interval Analysis*, 1966, ch. 7).
            let far = 2.0 * step.magnitude();
            step = contact.residual / self.contact(line, t.within(far)).facing;
            if !(step.magnitude() <= far) {
                return None;
            }
        } else if !(contact.residual.magnitude() <= self.tolerance) {
            return None;
        }
        let t = t + step;
        let (zero, number) = (R::ZERO, R::from_f64);
        let [vx, vy, _] = line.v;
        let across = vx * vx + vy * vy;
        let bend = number(self.bend.along) + number(self.bend.across) * across;
        let way = t - from;
        // Where the ray moves by no more than the rim's radius the bounds hold.
        let near = contact.height_squared <= number(4.0) * self.rim && way * way * across <= self.rim;
        let first = way >= zero && bend * way < contact.facing + contact.facing;
        (near && first && contact.q > zero && contact.facing > zero).then_some(t)
    }

    /// Follows the ray from `from` to the first crossing.
    fn follow(&self, line: &Line<R>, from: R) -> Result<R, Blocked> {
        let number = R::from_f64;
        let [vx, vy, vz] = line.v;
        let across = vx * vx + vy * vy;
        let bend = number(self.bend.along) + number(self.bend.across) * across;
        let bend = if bend > R::ZERO { bend } else { R::ZERO };
        let end = number(self.extent[1]) / vz;
        let outside = |contact: &Contact<R>| !(contact.height_squared <= self.rim);
        let mut t = from;
        for step in 0..FOLLOWED {
            let contact = self.contact(line, t);
            let beyond = number(Bend::REACH * Bend::REACH) * self.rim;
            // Out of the surface's height, or beside its half of the conic.
            if !(t <= end && contact.height_squared <= beyond) {
                return Err(if outside(&contact) { Blocked::Clipped } else { Blocked::Missed });
            }
            if !(contact.q > R::ZERO) {
                return Err(Blocked::Missed);
            }
            let before = contact.residual;
            if before.magnitude() <= self.tolerance && contact.facing > R::ZERO {
                let t = t + before / contact.facing;
                let contact = self.contact(line, t);
                return Ok(t + contact.residual / contact.facing);
            }
            if step == 0 && !(before > R::ZERO) {
                return Err(if outside(&contact) { Blocked::Clipped } else { Blocked::TurnedBack });
            }
            // The way to where a parabola of this bend meets 0.
            let (before, facing) = self.measure(line, t, &contact);
            let two = number(2.0);
            let root = (facing * facing + two * bend * before).sqrt();
            let way = two * before / (facing + root);
            if !(facing + root > R::ZERO && way > R::ZERO) {
                return Err(if outside(&contact) { Blocked::Clipped } else { Blocked::Missed });
            }
            t = t + way;
        }
        Err(Blocked::Missed)
    }

    /// -φ and φ' of the φ that [`Bend`] bounds.
    fn measure(&self, line: &Line<R>, t: R, contact: &Contact<R>) -> (R, R) {
        if self.kappa > R::ZERO {
            return (contact.residual, contact.facing);
        }
        let [x, y, z] = line.at(t);
        let u = contact.height_squared;
        let root = (R::ONE - self.kappa * self.curvature * self.curvature * u).sqrt();
        let [terms, slope] = self.terms(u);
        let along = x * line.v[0] + y * line.v[1];
        let two = R::from_f64(2.0);
        let before = self.curvature * u / (R::ONE + root) + terms - z;
        (before, line.v[2] - (self.curvature / root + two * slope) * along)
    }

    fn contact(&self, line: &Line<R>, t: R) -> Contact<R> {
        let p = line.at(t);
        let [x, y, z] = p;
        let height_squared = x * x + y * y;
        let [terms, slope] = self.terms(height_squared);
        let (one, two) = (R::ONE, R::from_f64(2.0));
        let w = z - terms;
        let q = one - self.kappa * self.curvature * w;
        let residual = self.curvature / two * height_squared - w * (one + q) / two;
        let m = self.curvature + two * q * slope;
        let facing = q * line.v[2] - m * (x * line.v[0] + y * line.v[1]);
        Contact { residual, facing, q, height_squared }
    }

    /// T and dT/du at u = r².
    fn terms(&self, u: R) -> [R; 2] {
        let inside = if u <= self.rim {
            u
        } else if u > self.rim {
            self.rim
        } else {
            // On both sides of the rim, or not a number.
            u / R::ZERO
        };
        let [even, even_slope] = nested(&self.even, inside);
        let mut value = inside * even;
        let mut slope = even + inside * even_slope;
        if !self.odd.is_empty() {
            // r u O(u), and d(r u)/du = 3 r/2.
            let (r, [odd, odd_slope]) = (inside.sqrt(), nested(&self.odd, inside));
            value = value + r * inside * odd;
            slope = slope + r * (R::from_f64(1.5) * odd + inside * odd_slope);
        }
        [value + slope * (u - inside), slope]
    }

    /// The unit normal at a point of the surface, on the side ahead.
    pub fn normal(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let [terms, slope] = self.terms(x * x + y * y);
        let q = R::ONE - self.kappa * self.curvature * (z - terms);
        let m = self.curvature + R::from_f64(2.0) * q * slope;
        let normal = [-(m * x), -(m * y), q];
        let length = dot(normal, normal).sqrt();
        normal.map(|component| component / length)
    }
}

/// A polynomial and its derivative, by Horner's rule.
fn nested<R: Real>(coefficients: &[R], u: R) -> [R; 2] {
    coefficients
        .iter()
        .rev()
        .fold([R::ZERO; 2], |[value, slope], &coefficient| [value * u + coefficient, slope * u + value])
}

/// A ray by its parameter.
struct Line<R> {
    start: [R; 3],
    v: [R; 3],
}

impl<R: Real> Line<R> {
    fn at(&self, t: R) -> [R; 3] {
        std::array::from_fn(|i| self.start[i] + t * self.v[i])
    }
}
