//! Constants of a conic and of a surface with terms, and the surface's profile in lanes. The [`Aspheric`] of a path is
//! converted to constants in the precision of the lanes, with the number of steps that Newton's iteration takes at the
//! surface.
//!
//! The terms T are evaluated as two polynomials in s = u/unit, u = r², and so is dT/ds, beside a cone ([`FigureTerms`]). The
//! profile z(u) = c u/(1 + √(1 - (1 + k) c² u)) + T(u) is the height above the vertex plane ([`Profile`]).

use super::{
    super::{
        carried::Carried,
        ray_lanes::Crossing,
        surface::{CompiledSurface, Transfer},
    },
    plan::NewtonPlan,
};
use realistic_base::numeric::Real;
use realistic_optics::trace::{Aspheric, BendBound};
use realistic_simd::{Cpu, Lanes, Scalar};

/// A conic section of revolution.
#[derive(Clone, Copy, Debug)]
pub struct Conic<S> {
    pub transfer: Transfer<S>,
    pub c: S,
    /// c n² and c k: the coefficient of t² is `cn2` + `ck` Vz².
    pub cn2: S,
    pub ck: S,
    /// -c (1 + k).
    pub minus_kappa_c: S,
    /// c².
    pub c2: S,
    pub common: Common<S>,
}

/// A surface with terms.
#[derive(Clone, Debug)]
pub struct LaneAsphere<S> {
    pub transfer: Transfer<S>,
    pub c: S,
    /// c/2 times the unit.
    pub half_c_unit: S,
    /// (1 + k) c, and half of it.
    pub kappa_c: S,
    pub half_kappa_c: S,
    pub terms: FigureTerms<S>,
    /// 2/unit: twice ds/du.
    pub two_per_unit: S,
    /// Bounds of φ'', which limit how far the surface bends away from a ray: `inside` within the clear aperture,
    /// `beyond` up to `reach`. φ' is g/q if `by_height`, else g.
    pub inside: LaneBend<S>,
    pub beyond: LaneBend<S>,
    pub by_height: bool,
    /// Bound of q'', by which rays behind the equator are followed if `by_height` is false.
    pub equator: LaneBend<S>,
    /// The square of the clear semi-diameter, or slightly less.
    pub edge_u: S,
    pub reach: S,
    /// The unit, mm².
    pub unit: S,
    pub tolerance: S,
    /// Polynomials that approximate twice the profile, with the coefficient of the highest power first. Every ray takes
    /// one step of Newton's iteration with each polynomial, then `exact_steps` steps with the surface.
    pub approximants: Vec<Box<[S]>>,
    pub exact_steps: usize,
    pub common: Common<S>,
    /// The surface for the rays that these steps leave open.
    pub exact: Box<Aspheric<f64>>,
}

/// A bound of φ'', as in [`BendBound`].
#[derive(Clone, Copy, Debug)]
pub struct LaneBend<S> {
    pub along: S,
    pub across: S,
    pub cone: S,
}

impl<S: Scalar> LaneBend<S> {
    fn new(bound: &BendBound) -> Self {
        let [along, across, cone] = [bound.along, bound.across, bound.cone].map(S::from_f64);
        Self { along, across, cone }
    }

    /// Returns the bound of φ'' along rays with these Vx² + Vy², without the cone's part.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn along_rays<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, across: L) -> L {
        across.mul_add(L::splat(cpu, self.across), L::splat(cpu, self.along))
    }
}

/// Constants common to surfaces that are neither spheres nor planes.
#[derive(Clone, Copy, Debug)]
pub struct Common<S> {
    /// n'² - n².
    pub index_step: S,
    /// Whether n' < n, so that total reflection is possible.
    pub rarer: bool,
    /// Whether the surface reflects rays; then `index_step` is 0.
    pub is_mirror: bool,
    /// a².
    pub aperture: S,
    /// Distance that a hit may lie behind the ray by rounding alone, in units of V.
    pub slack: S,
    /// Whether that distance is measured from the ray's origin, which a leading plane passes on.
    pub is_led: bool,
    /// z of the plane from which rays approach the surface.
    pub start: S,
    /// Lower bound of z inside the clear aperture, measured from `start`.
    pub lowest: S,
}

impl<S: Scalar> Common<S> {
    /// Takes the data that rays carry across the surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn cross<L: Lanes<Scalar = S>, C: Carried<S>>(
        &self,
        cpu: Cpu<L>,
        carried: &C,
        number: usize,
        state: &mut C::State<L>,
        crossing: &Crossing<L>,
    ) {
        carried.cross(cpu, number, state, crossing);
        if self.is_mirror {
            carried.turn_round(cpu, state);
        }
    }

    /// Builds the constants of a surface that rays approach from the plane z = `start`. `lowest` is the least z, with a
    /// margin for double precision, and `tolerance` is its rounding error there.
    pub fn new(surface: &CompiledSurface<'_>, start: f64, [lowest, tolerance]: [f64; 2]) -> Self {
        let rounding = S::EPSILON / f64::EPSILON;
        let lowest = lowest - (rounding - 1.0) * 16.0 * tolerance;
        Self {
            index_step: S::from_f64(surface.index_step),
            rarer: surface.index_step < 0.0,
            is_mirror: surface.is_mirror,
            aperture: S::from_f64(surface.aperture),
            slack: S::from_f64(surface.slack),
            is_led: surface.is_led,
            start: S::from_f64(start),
            lowest: S::from_f64(lowest - start),
        }
    }
}

impl<S: Scalar> Conic<S> {
    /// Builds the constants of a conic in a medium of index `n`.
    pub fn new(
        aspheric: &Aspheric<f64>,
        surface: &CompiledSurface<'_>,
        n: f64,
        transfer: Transfer<S>,
    ) -> Self {
        let (c, kappa) = (aspheric.curvature, aspheric.kappa);
        Self {
            transfer,
            c: S::from_f64(c),
            cn2: S::from_f64(c * n * n),
            ck: S::from_f64(c * (kappa - 1.0)),
            minus_kappa_c: S::from_f64(-kappa * c),
            c2: S::from_f64(c * c),
            common: Common::new(surface, 0.0, [aspheric.extent[0], aspheric.tolerance]),
        }
    }
}

impl<S: Scalar> LaneAsphere<S> {
    pub fn new(aspheric: &Aspheric<f64>, surface: &CompiledSurface<'_>, transfer: Transfer<S>) -> Self {
        let rounding = S::EPSILON / f64::EPSILON;
        let start = Self::start(aspheric);
        let tolerance = rounding * aspheric.tolerance / 16.0;
        let plan = NewtonPlan::of(aspheric, start, tolerance / 2.0);
        let common = Common::new(surface, start, [aspheric.extent[0], aspheric.tolerance]);
        Self::by_plan(aspheric, common, transfer, tolerance, &plan)
    }

    /// Returns the mean of the least and the greatest z. From a plane there, the first step is half as long, and leaves
    /// a quarter of the error.
    fn start(aspheric: &Aspheric<f64>) -> f64 {
        S::from_f64(f64::midpoint(aspheric.extent[0], aspheric.extent[1])).to_f64()
    }

    /// Builds the constants for a plan that brings |G| to at most `tolerance`.
    fn by_plan(
        aspheric: &Aspheric<f64>,
        common: Common<S>,
        transfer: Transfer<S>,
        tolerance: f64,
        plan: &NewtonPlan,
    ) -> Self {
        let round = S::from_f64;
        let (c, kappa) = (aspheric.curvature, aspheric.kappa);
        let bend = aspheric.bend;
        let reversed = |column: &Vec<f64>| column.iter().rev().map(|&a| round(a)).collect();
        Self {
            transfer,
            c: round(c),
            half_c_unit: round(c / 2.0 * aspheric.unit),
            kappa_c: round(kappa * c),
            half_kappa_c: round(kappa * c / 2.0),
            terms: FigureTerms::new(aspheric),
            two_per_unit: round(2.0 / aspheric.unit),
            inside: LaneBend::new(&bend.inside),
            beyond: LaneBend::new(&bend.beyond),
            by_height: bend.by_height,
            equator: LaneBend::new(&bend.equator),
            edge_u: round(aspheric.rim * (1.0 - 4.0 * S::EPSILON)),
            reach: round(bend.reach),
            unit: round(aspheric.unit),
            tolerance: round(tolerance),
            approximants: plan.approximants.iter().map(reversed).collect(),
            exact_steps: plan.exact,
            common,
            exact: Box::new(aspheric.clone()),
        }
    }
}

/// T as two polynomials in s: one for the even powers, and one for the odd powers over s √s; and the cone, a multiple of √s.
#[derive(Clone, Debug)]
pub struct FigureTerms<S> {
    even: FigureSplit<S>,
    odd: Option<FigureSplit<S>>,
    cone: S,
    /// s at the edge of the clear aperture.
    pub edge_s: S,
    /// 1/unit, a power of two.
    pub per_unit: S,
}

/// Least √s at which a cone is divided by it.
const LEAST_ROOT: f64 = 1e-15;

impl<S: Scalar> FigureTerms<S> {
    /// Builds the terms of a surface.
    pub fn new(aspheric: &Aspheric<f64>) -> Self {
        // s times a polynomial is a polynomial without a constant.
        let even: Vec<f64> = [0.0].iter().chain(&aspheric.even).copied().collect();
        Self {
            even: FigureSplit::new(&even),
            odd: (!aspheric.odd.is_empty()).then(|| FigureSplit::new(&aspheric.odd)),
            cone: S::from_f64(aspheric.cone),
            edge_s: S::from_f64(aspheric.rim / aspheric.unit),
            per_unit: S::from_f64(aspheric.unit.recip()),
        }
    }

    /// Returns T and dT/ds at each s; beyond the clear aperture, the values are those of the paraboloid that continues
    /// T.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn at<L: Lanes<Scalar = S>, const U: usize>(&self, cpu: Cpu<L>, s: &[L; U]) -> [[L; U]; 2] {
        let edge = L::splat(cpu, self.edge_s);
        let mut inside = *s;
        for i in 0..U {
            inside[i] = s[i].smaller(edge);
        }
        let [mut value, mut slope] = self.even.at(cpu, &inside);
        if let Some(odd) = &self.odd {
            // d(s √s O)/ds = √s (3 O/2 + s O').
            let [odd, odd_slope] = odd.at(cpu, &inside);
            let three_halves = L::splat(cpu, S::from_f64(1.5));
            for i in 0..U {
                let root = inside[i].sqrt();
                value[i] = (root * inside[i]).mul_add(odd[i], value[i]);
                let by_root = inside[i].mul_add(odd_slope[i], three_halves * odd[i]);
                slope[i] = root.mul_add(by_root, slope[i]);
            }
        }
        if self.cone != S::ZERO {
            let (cone, half) = (L::splat(cpu, self.cone), L::splat(cpu, S::from_f64(0.5)));
            // On the axis, x and y make its slope count nothing.
            let least = L::splat(cpu, S::from_f64(LEAST_ROOT));
            for i in 0..U {
                let root = inside[i].sqrt();
                value[i] = root.mul_add(cone, value[i]);
                slope[i] = slope[i] + half * cone / root.larger(least);
            }
        }
        for i in 0..U {
            value[i] = (s[i] - inside[i]).mul_add(slope[i], value[i]);
        }
        [value, slope]
    }
}

/// A polynomial p and its derivative, each as two polynomials in s²: p = E(s²) + s O(s²). By Horner's rule, the four
/// polynomials need as many operations as p and its derivative, but take half the time, because they do not wait for
/// each other. This matters for a single ray, which has no other work to overlap.
#[derive(Clone, Debug)]
struct FigureSplit<S> {
    /// Coefficients of E and O, then those of the two polynomials of the derivative, for each power of s², the highest
    /// power first.
    coefficients: Box<[[S; 4]]>,
}

impl<S: Scalar> FigureSplit<S> {
    /// Splits a polynomial, given by its coefficients from the lowest power up.
    fn new(coefficients: &[f64]) -> Self {
        let at = |power: usize| coefficients.get(power).copied().unwrap_or(0.0);
        let slope = |power: usize| (power + 1) as f64 * at(power + 1);
        let powers = (0..coefficients.len().div_ceil(2)).rev().map(|half| 2 * half);
        let of = |power: usize| [at(power), at(power + 1), slope(power), slope(power + 1)].map(S::from_f64);
        Self { coefficients: powers.map(of).collect() }
    }

    /// Returns p and p' at each s, two vectors at a time: eight sums keep the multipliers busy, and the sums
    /// and their operands fill sixteen registers.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at<L: Lanes<Scalar = S>, const U: usize>(&self, cpu: Cpu<L>, s: &[L; U]) -> [[L; U]; 2] {
        let (mut value, mut slope) = (*s, *s);
        let mut i = 0;
        while i + 1 < U {
            let [values, slopes] = self.side_by_side(cpu, &[s[i], s[i + 1]]);
            [value[i], value[i + 1]] = values;
            [slope[i], slope[i + 1]] = slopes;
            i += 2;
        }
        if i < U {
            let [[last], [last_slope]] = self.side_by_side(cpu, &[s[i]]);
            (value[i], slope[i]) = (last, last_slope);
        }
        [value, slope]
    }

    /// Returns p and p' at each s.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn side_by_side<L: Lanes<Scalar = S>, const U: usize>(&self, cpu: Cpu<L>, s: &[L; U]) -> [[L; U]; 2] {
        let mut square = *s;
        for i in 0..U {
            square[i] = s[i] * s[i];
        }
        let mut sums = [*s; 4];
        for (sum, &coefficient) in sums.iter_mut().zip(&self.coefficients[0]) {
            *sum = [L::splat(cpu, coefficient); U];
        }
        for coefficients in &self.coefficients[1..] {
            for (sum, &coefficient) in sums.iter_mut().zip(coefficients) {
                let coefficient = L::splat(cpu, coefficient);
                for i in 0..U {
                    sum[i] = sum[i].mul_add(square[i], coefficient);
                }
            }
        }
        let [mut value, odd, mut slope, odd_slope] = sums;
        for i in 0..U {
            value[i] = odd[i].mul_add(s[i], value[i]);
            slope[i] = odd_slope[i].mul_add(s[i], slope[i]);
        }
        [value, slope]
    }
}

/// Evaluates a polynomial and its derivative by Horner's rule.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn nested<L: Lanes, const U: usize>(cpu: Cpu<L>, coefficients: &[L::Scalar], at: &[L; U]) -> [[L; U]; 2] {
    let first = L::splat(cpu, coefficients[0]);
    let (mut value, mut slope) = ([first; U], [L::splat(cpu, L::Scalar::ZERO); U]);
    for &coefficient in &coefficients[1..] {
        let coefficient = L::splat(cpu, coefficient);
        for i in 0..U {
            slope[i] = slope[i].mul_add(at[i], value[i]);
            value[i] = value[i].mul_add(at[i], coefficient);
        }
    }
    [value, slope]
}

/// The profile of an aspheric surface.
#[derive(Clone, Debug)]
pub struct Profile<S> {
    c: S,
    /// (1 + k) c².
    bend: S,
    terms: FigureTerms<S>,
}

impl<S: Scalar> Profile<S> {
    pub fn new(aspheric: &Aspheric<f64>) -> Self {
        let c = aspheric.curvature;
        Self {
            c: S::from_f64(c),
            bend: S::from_f64(aspheric.kappa * c * c),
            terms: FigureTerms::new(aspheric),
        }
    }

    /// Returns z along the direction of travel at the squared distance u from the axis; NaN beyond the end of the
    /// conic.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn height<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, u: L) -> L {
        let one = L::splat(cpu, S::ONE);
        let [[terms], _] = self.terms.at(cpu, &[u * L::splat(cpu, self.terms.per_unit)]);
        let root = L::splat(cpu, self.bend).neg_mul_add(u, one).sqrt();
        L::splat(cpu, self.c) * u / (one + root) + terms
    }
}
