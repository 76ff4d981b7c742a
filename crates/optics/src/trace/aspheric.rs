//! Intersection of a ray with an aspheric surface, and the normal at the intersection, in numbers of any type.
//!
//! Coordinates are in the frame of the vertex, with the axis along the direction of travel. Let u = x² + y², let T(u)
//! be the terms, w = z - T and κ = 1 + k. The surface is G = (c/2)(u + κ w²) - w = 0 with q = 1 - κ c w > 0. The
//! condition q > 0 selects the sheet and the half of the conic that contain the vertex. This form has no root that
//! vanishes at the edge of the conic. G is positive before the surface. N = -∇G = (-m x, -m y, q), with m = c + 2 q
//! dT/du, is normal to the surface and points ahead. With V = n D and g = N·V, Newton's step along the ray is G/g.
//!
//! **Selection of the crossing.** The hit is the first crossing toward the side ahead. The search starts at the point
//! where the ray left the last surface, or at the height of this surface's lowest point if the ray reaches that height
//! later. There the ray counts as before the surface. Newton's iteration may find a later crossing; for each ray it is
//! proven that it did not. Let φ increase along the ray from negative values before the surface to 0 on the surface,
//! with φ'' <= H everywhere. Then φ <= -φ'(t*) (t* - t) + H (t* - t)²/2, which is negative from t* back to t* - 2
//! φ'(t*)/H, so that no crossing lies in between. φ is z minus the surface's height at (x, y), with φ' = g/q and H =
//! -(least curvature) (Vx² + Vy²). Near the edge of a half ellipsoid, where this H grows without bound, φ is -G
//! instead. If the inequality proves nothing, the ray is followed from its start in steps that the same bound allows;
//! such steps cannot skip a crossing.
//!
//! **Cones.** At the tip of a cone, the term of r, φ'' has no bound. Along the ray, however, r(t) is convex. A cone that
//! opens away from the ray only lowers φ''. One that opens toward the ray adds to φ its slope times r(t), which lies between
//! the tangent at t and the chord to another point. With J, the slope times the difference of the two, both statements hold
//! if φ'(t*) is replaced by φ'(t*) - J, and φ' at a step's start by φ' + J. A step's chord ends at the ray's point nearest to
//! the axis, and behind it at the end of the search.
//!
//! **Behind the equator.** Where q < 0, no point belongs to the surface, whatever the sign of G. A ray starts behind
//! the equator, at the height of the surface's edge, if the surface is hollow toward the light and reaches the equator
//! of the conic, q = 0. Such a ray is followed by φ = q, in steps of the same kind, to the equator, and from the
//! equator on by φ = -G. A ray that passes beside a surface that bulges toward the light also gets behind the equator.
//! There q falls, and the same step finds that q does not rise to 0 again.
//!
//! **Scope of the proof.** The crossing found at t is the first crossing ahead of the ray's start: between the start
//! and t the ray is before the surface or behind its equator. The proof does not cover points behind the start or
//! beyond t. Because z increases along the direction of travel, light may pass through the lens in either direction;
//! only the signs of the figure depend on the direction.

use super::{Blocked, State};
use crate::{lens::Figure, prescription::FIRST_POWER};
use realistic_base::numeric::{Real, dot};

/// An aspheric surface of a path, with z along the direction of travel.
#[derive(Clone, Debug)]
pub struct Aspheric<R> {
    /// The curvature of the conic at its vertex; positive if the centre of curvature lies ahead.
    pub curvature: R,
    /// 1 + k.
    pub kappa: R,
    /// The square of a power of two near the clear semi-diameter. With s = u/unit, all values of the terms stay in
    /// range.
    pub unit: R,
    /// Coefficients of the even powers, mm. The sum of the even terms is s times the polynomial in s with these
    /// coefficients.
    pub even: Vec<R>,
    /// Coefficients of the odd powers, mm. The sum of the odd terms is s √s times the polynomial in s with these
    /// coefficients.
    pub odd: Vec<R>,
    /// Coefficient of √s, mm: the cone.
    pub cone: R,
    /// The square of the clear semi-diameter, mm². Beyond it, T continues as a paraboloid.
    pub rim: R,
    /// Bounds for the proof that a crossing is the first.
    pub bend: Bend,
    /// The least and the greatest z inside the clear aperture, with a small margin.
    pub extent: [f64; 2],
    /// Rounding error of G. Values of |G| up to this error count as 0.
    pub tolerance: f64,
    /// The clear semi-diameter, mm.
    pub size: f64,
    /// Refractive index before the surface.
    n: f64,
}

/// Bounds on how fast the surface bends away from a ray, for the proof of the first crossing.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// Bound from the axis to the edge of the clear aperture.
    pub inside: BendBound,
    /// Bound from the axis to the reach. There an ellipsoid that ends may bend a hundred times as much as inside the
    /// aperture.
    pub beyond: BendBound,
    /// Whether φ is the height above the surface; otherwise φ is -G.
    pub by_height: bool,
    /// Bound on q'' from the axis to the reach, for surfaces where φ is -G.
    pub equator: BendBound,
    /// The squared distance from the axis up to which the bounds hold.
    pub reach: f64,
}

/// A bound on φ'': φ'' is at most `along` + `across` (Vx² + Vy²) + `cone` d²r/dt², where r(t) is the distance from the axis.
#[derive(Clone, Copy, Debug)]
pub struct BendBound {
    /// Part of the bound that is the same for every direction, 1/mm.
    pub along: f64,
    /// Factor of Vx² + Vy², 1/mm.
    pub across: f64,
    /// Factor of d²r/dt²; 0 without a cone that opens toward the ray.
    pub cone: f64,
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

/// Maximum number of steps of Newton's iteration. Double-double numbers take 8 steps on a phone lens.
const NEWTON_STEPS: u32 = 24;
/// Factor by which rounding may move a squared distance beyond the bound on it.
const BESIDE: f64 = 1.0 + 1e-6;
/// Maximum number of steps of a march along a ray.
const MARCH_STEPS: u32 = 256;

impl Bend {
    /// Largest distance from the axis up to which the bounds hold, in clear semi-diameters.
    const REACH: f64 = 3.0;
    /// Least value of 1 - κ c² r² at the clear semi-diameter for which φ is the height. Below this value, near half an
    /// ellipsoid, heights bend too much.
    const STEEP: f64 = 0.05;

    /// Computes the bounds for a figure with curvature `c` and `kappa` = 1 + k in a medium of index `n`, with z along
    /// the travel.
    fn of([c, kappa]: [f64; 2], semi_diameter: f64, bounds: &TravelBounds, n: f64) -> Self {
        let root_squared = |reach: f64| 1.0 - kappa * (c * reach).powi(2);
        let root_squared_at_edge = root_squared(semi_diameter);
        if kappa > 0.0 && root_squared_at_edge < Self::STEEP {
            return Self::of_half([c, kappa], semi_diameter, bounds, n);
        }
        // If the ellipsoid ends before `REACH`, the reach is the radius where √(1 - κ c² r²) is half of its value at
        // the clear semi-diameter.
        let ends = (1.0 - root_squared_at_edge / 4.0) / (kappa * (c * semi_diameter).powi(2));
        let reach = if kappa > 0.0 { ends.sqrt().clamp(1.0, Self::REACH) } else { Self::REACH };
        // Beyond the clear aperture a paraboloid is added to the conic. The curvatures of the conic, c/√… and c/√…³,
        // are monotonic.
        let conic = [semi_diameter, reach * semi_diameter].map(|r| root_squared(r).sqrt());
        let least = conic.iter().flat_map(|root| [c / root, c / root.powi(3)]).fold(f64::INFINITY, f64::min);
        let beyond = if c == 0.0 { 0.0 } else { least } + bounds.edge_curvature;
        let cone = (-bounds.cone).max(0.0);
        let bound = |curvature: f64| BendBound { along: 0.0, across: (-curvature).max(0.0), cone };
        Self {
            inside: bound(bounds.curvature),
            beyond: bound(bounds.curvature.min(beyond)),
            by_height: true,
            equator: BendBound { along: 0.0, across: 0.0, cone: 0.0 },
            reach: (reach * semi_diameter).powi(2),
        }
    }

    /// Computes the bounds from two equations: -G'' = -c (Vx² + Vy² + κ w'²) + q w'', where w' = Vz - dT/dr dr/dt, and
    /// q'' = -κ c w''. -G'' stays finite at the end of a half ellipsoid.
    fn of_half([c, kappa]: [f64; 2], semi_diameter: f64, bounds: &TravelBounds, n: f64) -> Self {
        let [least, most] = bounds.terms_curvature;
        let cone = bounds.cone.abs();
        // -w'' is the curvature of the terms multiplied by Vx² + Vy², and the cone's slope times d²r/dt².
        let largest = |factor: f64| (factor * least).max(factor * most).max(0.0);
        let bound = |reach: f64| {
            // Out to 3 radii, the paraboloid beyond the clear aperture triples the slope, and adds (3² - 1)/2 times the
            // slope times the radius to the terms.
            let slope = reach * bounds.terms_slope;
            let terms = bounds.terms + (reach * reach - 1.0) / 2.0 * bounds.terms_slope * semi_diameter;
            // Bounds on w, and therefore on q, at the heights of the surface, on either side of the equator.
            let q = [bounds.extent[0] - terms, bounds.extent[1] + terms].map(|w| 1.0 - kappa * c * w);
            BendBound {
                // |w'| <= |Vz| + slope √(Vx² + Vy²) <= n √(1 + slope²).
                along: (-c * kappa).max(0.0) * n * n * (1.0 + slope * slope),
                across: largest(-q[0]).max(largest(-q[1])) - c,
                cone: cone * q[0].abs().max(q[1].abs()),
            }
        };
        Self {
            inside: bound(1.0),
            beyond: bound(Self::REACH),
            by_height: false,
            equator: BendBound { along: 0.0, across: largest(kappa * c), cone: cone * (kappa * c).abs() },
            reach: (Self::REACH * semi_diameter).powi(2),
        }
    }
}

/// The bounds of a figure, with z along the direction of travel.
struct TravelBounds {
    extent: [f64; 2],
    /// The least curvature of the figure.
    curvature: f64,
    /// The curvature of the paraboloid with which the terms continue beyond the clear aperture.
    edge_curvature: f64,
    terms: f64,
    terms_slope: f64,
    terms_curvature: [f64; 2],
    /// Slope of the cone.
    cone: f64,
}

impl<R: Real> Aspheric<R> {
    /// Builds the figure as light meets it in a medium of index `n`. The light travels toward the film if `forward`,
    /// otherwise toward the scene.
    pub fn new(figure: &Figure, forward: bool, n: f64) -> Self {
        let sign = if forward { 1.0 } else { -1.0 };
        let Figure { asphere, rim, bounds } = figure;
        let signed = |[low, high]: [f64; 2]| if forward { [low, high] } else { [-high, -low] };
        let extent = signed(bounds.sagitta);
        let travel_bounds = TravelBounds {
            extent,
            curvature: signed(bounds.curvature)[0],
            edge_curvature: sign * figure.rim_curvature(),
            terms: bounds.terms,
            terms_slope: bounds.terms_slope,
            terms_curvature: signed(bounds.terms_curvature),
            cone: sign * asphere.term(1),
        };
        let c = sign * asphere.radius.recip();
        let length = 2.0_f64.powi(rim.log2().floor() as i32);
        let column = |first: usize| -> Vec<R> {
            let powers = (first as i32..).step_by(2);
            let terms = powers.zip(asphere.terms.iter().skip(first - FIRST_POWER).step_by(2));
            let mut column: Vec<f64> = terms.map(|(power, term)| sign * term * length.powi(power)).collect();
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
            unit: R::from_f64(length * length),
            even: column(2),
            odd: column(3),
            cone: R::from_f64(sign * asphere.term(1) * length),
            rim: R::from_f64(*rim) * R::from_f64(*rim),
            bend: Bend::of([c, 1.0 + asphere.conic], *rim, &travel_bounds, n),
            extent: [extent[0] - margin, extent[1] + margin],
            tolerance: 64.0 * R::EPSILON * size,
            size: *rim,
            n,
        }
    }

    /// Returns whether the figure has no terms.
    pub fn is_conic(&self) -> bool {
        self.even.is_empty() && self.odd.is_empty() && self.cone == R::ZERO
    }

    /// Moves the ray to the surface. The hit may lie up to `slack` (in units of V) before the last point of the ray.
    pub(super) fn meet(&self, state: &mut State<R>, slack: R) -> Result<(), Blocked> {
        let v = state.v;
        let (start, last) = state.at_vertex_plane(slack)?;
        let lowest = R::from_f64(self.extent[0]) / v[2];
        let from = if last > lowest { last } else { lowest };
        let line = RayLine::new(start, v);
        let t = self.crossing(&line, from)?;
        *state = State { p: line.at(t), lead: R::ZERO, ..*state };
        Ok(())
    }

    /// Returns the first crossing of the ray and the surface after `from`, as a distance from `start` in units of V.
    pub fn first_crossing(&self, start: [R; 3], v: [R; 3], from: R) -> Result<R, Blocked> {
        self.crossing(&RayLine::new(start, v), from)
    }

    fn crossing(&self, line: &RayLine<R>, from: R) -> Result<R, Blocked> {
        match self.newton(line, from) {
            Some(t) => Ok(t),
            None => self.march(line, from),
        }
    }

    /// Returns [`Aspheric::first_crossing`] of a ray for which Newton's iteration has proven nothing.
    pub fn followed(&self, start: [R; 3], v: [R; 3], from: R) -> Result<R, Blocked> {
        self.march(&RayLine::new(start, v), from)
    }

    /// Returns G and N·V at a point of a ray, for the steps of Newton's iteration.
    pub fn residual(&self, start: [R; 3], v: [R; 3], t: R) -> [R; 2] {
        let contact = self.contact(&RayLine::new(start, v), t);
        [contact.residual, contact.facing]
    }

    /// Returns z at the squared distance u from the axis; NaN beyond the end of the conic.
    pub fn height(&self, u: R) -> R {
        let [terms, _] = self.terms(u);
        let bent = self.curvature * u;
        bent / (R::ONE + (R::ONE - self.kappa * self.curvature * bent).sqrt()) + terms
    }

    /// Returns the result of Newton's iteration, if it is proven to be the first crossing after `from`.
    fn newton(&self, line: &RayLine<R>, from: R) -> Option<R> {
        let close = 0.01 * R::EPSILON.sqrt() * self.size / self.n;
        let longest = R::from_f64(self.size + self.extent[1] - self.extent[0]) / line.v[2];
        let mut t = R::ZERO;
        let mut is_close = false;
        let mut steps = 0;
        while !is_close {
            let contact = self.contact(line, t);
            if steps == NEWTON_STEPS || !(contact.facing > R::ZERO) {
                return None;
            }
            let step = contact.residual / contact.facing;
            // The first step alone does not show that the iteration converges.
            is_close = steps > 0 && step.to_f64().abs() <= close;
            let step = if step > longest { longest } else { step };
            t = t + if step < -longest { -longest } else { step };
            steps += 1;
        }
        let contact = self.contact(line, t);
        if !(contact.residual.to_f64().abs() <= self.tolerance) {
            return None;
        }
        let t = t + contact.residual / contact.facing;
        let (zero, number) = (R::ZERO, R::from_f64);
        let span = t - from;
        // Along a line, the distance from the axis is largest at one of the two ends.
        let from_squared = line.height_squared(from);
        let reach = number(self.bend.reach);
        let near = contact.height_squared <= reach && from_squared <= reach;
        let is_inside = contact.height_squared <= self.rim && from_squared <= self.rim;
        let bound = if is_inside { &self.bend.inside } else { &self.bend.beyond };
        let bend = self.bend_along(line, bound) * span / number(2.0) + line.chord_excess(bound, t, from);
        let bend = if self.bend.by_height { bend * contact.q } else { bend };
        let first = span >= zero && bend < contact.facing;
        (near && first && contact.q > zero && contact.facing > zero).then_some(t)
    }

    /// Follows the ray in steps from `from` to the first crossing.
    fn march(&self, line: &RayLine<R>, from: R) -> Result<R, Blocked> {
        let number = R::from_f64;
        let Bend { inside, beyond, equator, .. } = &self.bend;
        let [inside, beyond, equator] = [inside, beyond, equator].map(|bound| {
            let bend = self.bend_along(line, bound);
            (bound, if bend > R::ZERO { bend } else { R::ZERO })
        });
        let end = (number(self.extent[1]) - line.start[2]) / line.v[2];
        let outside = |contact: &Contact<R>| !(contact.height_squared <= self.rim);
        let mut t = self.entry(line, from)?;
        for _ in 0..MARCH_STEPS {
            let contact = self.contact(line, t);
            // The point lies beyond the surface's extent in z, or outside the reach of the bounds.
            if !(t <= end && contact.height_squared <= number(self.bend.reach * BESIDE)) {
                return Err(if outside(&contact) { Blocked::Clipped } else { Blocked::Missed });
            }
            let behind = self.behind_equator(line, t, &contact);
            let (before, facing) = behind.unwrap_or_else(|| self.measure(line, t, &contact));
            let bends = if behind.is_some() { [equator; 2] } else { [inside, beyond] };
            if behind.is_none() && before.to_f64().abs() <= self.tolerance && facing > R::ZERO {
                return self.refine(line, t);
            }
            if !(before > R::ZERO) {
                return Err(if outside(&contact) { Blocked::Clipped } else { Blocked::TurnedBack });
            }
            // The step is the distance to the point where a parabola with this bend reaches 0, if it does.
            let two = number(2.0);
            let nearest = line.nearest_to_axis();
            let chord_end = if t < nearest && nearest < end { nearest } else { end };
            let step_for = |(bound, bend): (&BendBound, R)| {
                let facing = facing + line.chord_excess(bound, t, chord_end);
                let root = (facing * facing + two * bend * before).sqrt();
                let step = two * before / (facing + root);
                let reaches = facing + root > R::ZERO && step > R::ZERO;
                // The chord's bound holds to its end.
                let longest = chord_end - t;
                let is_cut = bound.cone > 0.0 && chord_end < end && !(reaches && step < longest);
                let step = if is_cut { longest } else { step };
                (is_cut || reaches).then_some(step)
            };
            let stays_inside = |step: &R| !outside(&contact) && line.height_squared(t + *step) <= self.rim;
            let Some(step) = step_for(bends[0]).filter(stays_inside).or_else(|| step_for(bends[1])) else {
                return Err(if outside(&contact) { Blocked::Clipped } else { Blocked::Missed });
            };
            t = t + step;
        }
        Err(Blocked::Missed)
    }

    /// Returns the upper bound of φ'' along a ray, without the cone's part.
    fn bend_along(&self, line: &RayLine<R>, bound: &BendBound) -> R {
        let [vx, vy, _] = line.v;
        R::from_f64(bound.along) + R::from_f64(bound.across) * (vx * vx + vy * vy)
    }

    /// Returns the exact crossing near a point that lies within rounding error of it.
    fn refine(&self, line: &RayLine<R>, mut t: R) -> Result<R, Blocked> {
        for _ in 0..2 {
            let contact = self.contact(line, t);
            t = t + contact.residual / contact.facing;
        }
        // The other half or sheet of the conic is not part of the surface. If a ray barely dips below the surface, the
        // steps may end where the ray comes back up, which is not a crossing toward the side ahead.
        let Contact { q, facing, .. } = self.contact(line, t);
        if q > R::ZERO && facing > R::ZERO { Ok(t) } else { Err(Blocked::Missed) }
    }

    /// Returns the first point of the ray, from `from` on, that lies within the reach of the bounds.
    fn entry(&self, line: &RayLine<R>, from: R) -> Result<R, Blocked> {
        let reach = R::from_f64(self.bend.reach);
        let [x, y, _] = line.at(from);
        if x * x + y * y <= reach {
            return Ok(from);
        }
        let ([x, y, _], [vx, vy, _]) = (line.start, line.v);
        let (across, along) = (vx * vx + vy * vy, x * vx + y * vy);
        let entry = -(along + (along * along - across * (x * x + y * y - reach)).sqrt()) / across;
        // The condition is negated so that a ray that never comes within reach is also blocked.
        if !(entry > from) { Err(Blocked::Clipped) } else { Ok(entry) }
    }

    /// Returns -q and q' if the ray is behind the equator and φ is -G. If φ is the height, no equator lies within
    /// reach. Where q is within √ε of 0, the conic is as wide as at the equator, up to rounding, and -G is used as φ.
    fn behind_equator(&self, line: &RayLine<R>, t: R, contact: &Contact<R>) -> Option<(R, R)> {
        if self.bend.by_height || !(contact.q < R::from_f64(-R::EPSILON.sqrt())) {
            return None;
        }
        let ([x, y, _], [vx, vy, _]) = (line.at(t), line.v);
        // q' = -κ c w', and N·V = q w' - c (x Vx + y Vy).
        let rise = (contact.facing + self.curvature * (x * vx + y * vy)) / contact.q;
        Some((-contact.q, -(self.kappa * self.curvature * rise)))
    }

    /// Returns -φ and φ', for the φ whose bounds inside and beyond the clear aperture are in [`Bend`].
    fn measure(&self, line: &RayLine<R>, t: R, contact: &Contact<R>) -> (R, R) {
        if !self.bend.by_height {
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

    fn contact(&self, line: &RayLine<R>, t: R) -> Contact<R> {
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

    /// Returns T and dT/du at u = r².
    fn terms(&self, u: R) -> [R; 2] {
        // The comparison keeps NaN as NaN.
        let inside = if u > self.rim { self.rim } else { u };
        let [value, slope] = self.terms_inside(inside);
        [value + slope * (u - inside), slope]
    }

    /// Returns T and dT/du at u inside the clear aperture.
    fn terms_inside(&self, inside: R) -> [R; 2] {
        let part = inside / self.unit;
        let [even, even_slope] = nested(&self.even, part);
        let mut value = part * even;
        let mut slope = even + part * even_slope;
        if !self.odd.is_empty() {
            // d(s √s O)/ds = √s (3 O/2 + s O').
            let (root, [odd, odd_slope]) = (part.sqrt(), nested(&self.odd, part));
            value = value + root * part * odd;
            slope = slope + root * (R::from_f64(1.5) * odd + part * odd_slope);
        }
        if self.cone != R::ZERO {
            let root = part.sqrt();
            value = value + self.cone * root;
            // The tip has no normal; the axis stands in for it.
            if root > R::ZERO {
                slope = slope + self.cone / (root + root);
            }
        }
        [value, slope / self.unit]
    }

    /// Returns the unit normal at a point of the surface, pointing to the side ahead.
    pub fn normal(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let [terms, slope] = self.terms(x * x + y * y);
        let q = R::ONE - self.kappa * self.curvature * (z - terms);
        let m = self.curvature + R::from_f64(2.0) * q * slope;
        let normal = [-(m * x), -(m * y), q];
        let length = dot(normal, normal).sqrt();
        normal.map(|component| component / length)
    }
}

/// Evaluates a polynomial and its derivative by Horner's rule.
fn nested<R: Real>(coefficients: &[R], u: R) -> [R; 2] {
    coefficients
        .iter()
        .rev()
        .fold([R::ZERO; 2], |[value, slope], &coefficient| [value * u + coefficient, slope * u + value])
}

/// A ray, parametrised by t in units of V.
struct RayLine<R> {
    start: [R; 3],
    v: [R; 3],
}

impl<R: Real> RayLine<R> {
    fn new(start: [R; 3], v: [R; 3]) -> Self {
        Self { start, v }
    }

    fn at(&self, t: R) -> [R; 3] {
        std::array::from_fn(|i| self.start[i] + t * self.v[i])
    }

    /// Returns x² + y² at t.
    fn height_squared(&self, t: R) -> R {
        let [x, y, _] = self.at(t);
        x * x + y * y
    }

    /// Returns the t at which the ray is nearest to the axis; NaN for a ray parallel to it.
    fn nearest_to_axis(&self) -> R {
        let ([x, y, _], [vx, vy, _]) = (self.start, self.v);
        -(x * vx + y * vy) / (vx * vx + vy * vy)
    }

    /// Returns J: the cone's part of a bound times the difference in slope between the chord of r(t) from t to `other` and the
    /// tangent at t, 0 or more.
    fn chord_excess(&self, bound: &BendBound, t: R, other: R) -> R {
        let span = if other > t { other - t } else { t - other };
        if bound.cone == 0.0 || !(span > R::ZERO) {
            return R::ZERO;
        }
        let [here, there] = [t, other].map(|t| self.height_squared(t).sqrt());
        let ([x, y, _], [vx, vy, _]) = (self.at(t), self.v);
        // The tip has all slopes between that of the ray toward it and that of the ray away from it: 0 is one of them.
        let slope = if here > R::ZERO { (x * vx + y * vy) / here } else { R::ZERO };
        let tangent = here + slope * (other - t);
        R::from_f64(bound.cone) * (there - tangent) / span
    }
}
