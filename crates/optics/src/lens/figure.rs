//! The figure of an aspheric surface: its sagitta and slope, and bounds on both over the clear aperture.
//!
//! The input is the conic and terms of a prescription with a clear semi-diameter. First-order optics, tracing and
//! drawings use the results. z is counted from the vertex plane toward the film, r from the axis, and T(r) = Σ `A_i`
//! r^i.
//!
//! **The bounds are proven.** The aperture is divided into annuli. On an annulus of half width h around r, a polynomial
//! p differs from p(r) by at most |p'(r)| h + B h²/2. Here B = Σ i (i - 1) |`a_i`| R^(i - 2), with the outer radius R
//! of the annulus, is an upper bound of |p''| (Taylor's theorem, with the remainder bounded term by term). The
//! magnitudes of the conic's sagitta and slope increase with r, so their values at the edges of an annulus bound them;
//! the conic's curvatures are monotonic. The bounds include a margin for rounding errors, relative to the sum of the
//! terms' magnitudes.
//!
//! The term of r, a cone, has no curvature at the vertex, and bounds on curvatures leave it out. Tracing has a bound of its
//! own for it.

use crate::prescription::{Asphere, FIRST_POWER};

/// An aspheric figure with its rim, the edge of the clear aperture. Beyond the rim, T continues as the paraboloid that
/// is tangent to T at the rim. A ray that passes beside the surface therefore still meets the figure nearby, at a
/// height at which the aperture clips the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// The conic and the terms.
    pub asphere: Asphere,
    /// Radius of the rim, mm: the clear semi-diameter of the prescription.
    pub rim: f64,
    /// Bounds from the axis to the rim.
    pub bounds: Bounds,
}

/// Bounds of an aspheric figure from the axis to its rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Minimum and maximum z, mm.
    pub sagitta: [f64; 2],
    /// Maximum |dz/dr|; infinite at the rim of half an ellipsoid.
    pub slope: f64,
    /// Minimum and maximum of the curvatures d²z/dr² and (dz/dr)/r, 1/mm. These also bound the second derivatives of z
    /// in any direction perpendicular to the axis, but for the cone's.
    pub curvature: [f64; 2],
    /// Maximum |T|, mm.
    pub terms: f64,
    /// Maximum |dT/dr|.
    pub terms_slope: f64,
    /// Minimum and maximum of the curvatures d²T/dr² and (dT/dr)/r of T without the cone, 1/mm.
    pub terms_curvature: [f64; 2],
    /// Maximum Σ |`A_i`| r^i, mm. The rounding error of T is relative to this sum.
    pub terms_size: f64,
}

/// Number of annuli into which the aperture is cut.
const ANNULI: u32 = 64;
/// Rounding error of a polynomial, relative to the sum of its terms' magnitudes: the error of about a hundred
/// operations.
const ROUNDING: f64 = 128.0 * f64::EPSILON;

impl Figure {
    /// Builds the figure with this clear semi-diameter; `None` if the figure is a sphere or a plane.
    pub fn new(asphere: &Asphere, semi_diameter: f64) -> Option<Self> {
        let is_plain = asphere.conic == 0.0 || asphere.radius.is_infinite();
        if is_plain && asphere.terms.iter().all(|term| *term == 0.0) {
            return None;
        }
        let bounds = Bounds::of(asphere, semi_diameter);
        Some(Self { asphere: *asphere, rim: semi_diameter, bounds })
    }

    /// Returns the curvature at the vertex, 1/mm, which first-order optics uses. It leaves out the cone.
    pub fn vertex_curvature(&self) -> f64 {
        self.asphere.radius.recip() + 2.0 * self.asphere.term(2)
    }

    /// Returns the curvature (dT/dr)/r of the paraboloid beyond the rim, 1/mm.
    pub fn rim_curvature(&self) -> f64 {
        terms(&self.asphere, self.rim)[1] / self.rim
    }

    /// Returns z at the distance `height` from the axis, mm. Beyond the edge of the conic, the conic's part of z
    /// continues as c r².
    pub fn sagitta(&self, height: f64) -> f64 {
        let [terms, _] = terms(&self.asphere, height.min(self.rim));
        let beyond = if height > self.rim {
            self.rim_curvature() * (height - self.rim) * (height + self.rim) / 2.0
        } else {
            0.0
        };
        conic_sagitta(&self.asphere, height) + terms + beyond
    }
}

impl Bounds {
    fn of(asphere: &Asphere, semi_diameter: f64) -> Self {
        let weighted = |weight: fn(f64) -> f64, shift: usize| -> Vec<f64> {
            let terms = (FIRST_POWER..).zip(&asphere.terms);
            let weighted = terms.map(|(power, term)| weight(power as f64) * term);
            // Shifted by more than its power, a term is left out: the cone's curvature.
            let left_out = shift.saturating_sub(FIRST_POWER);
            std::iter::repeat_n(0.0, FIRST_POWER.saturating_sub(shift))
                .chain(weighted.skip(left_out))
                .collect()
        };
        let (terms, slope) = (weighted(|_| 1.0, 0), weighted(|i| i, 1));
        let curvatures = [weighted(|i| i, 2), weighted(|i| i * (i - 1.0), 2)];
        let mut bounds = Self {
            sagitta: [0.0; 2],
            slope: 0.0,
            curvature: [f64::INFINITY, f64::NEG_INFINITY],
            terms: 0.0,
            terms_slope: 0.0,
            terms_curvature: [f64::INFINITY, f64::NEG_INFINITY],
            terms_size: terms.iter().rev().fold(0.0, |sum, a| sum * semi_diameter + a.abs()),
        };
        let wider = |[low, high]: [f64; 2], [from, to]: [f64; 2]| [low.min(from), high.max(to)];
        let largest = |[low, high]: [f64; 2]| high.max(-low);
        for annulus in 0..ANNULI {
            let edges = [annulus, annulus + 1].map(|i| semi_diameter * f64::from(i) / f64::from(ANNULI));
            let ordered = |[a, b]: [f64; 2]| [a.min(b), a.max(b)];
            let sum = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a + c, b + d];
            let (term, term_slope) = (range(&terms, edges), range(&slope, edges));
            let conic = ordered(edges.map(|r| conic_sagitta(asphere, r)));
            let conic_slope = ordered(edges.map(|r| conic_slope(asphere, r)));
            let steepest = largest(sum(conic_slope, term_slope));
            bounds.slope = bounds.slope.max(steepest);
            // By the mean value theorem, z differs from its value at the middle by at most the steepest slope times the
            // distance. This bound is tighter where conic and terms cancel.
            let middle = f64::midpoint(edges[0], edges[1]);
            let z = conic_sagitta(asphere, middle) + self::terms(asphere, middle)[0];
            let around = steepest * (edges[1] - middle) + ROUNDING * bounds.terms_size;
            let [low, high] = sum(conic, term);
            bounds.sagitta = wider(bounds.sagitta, [low.max(z - around), high.min(z + around)]);
            bounds.terms = bounds.terms.max(largest(term));
            bounds.terms_slope = bounds.terms_slope.max(largest(term_slope));
            for (curvature, conic) in curvatures.iter().zip(conic_curvatures(asphere, edges)) {
                let terms = range(curvature, edges);
                bounds.terms_curvature = wider(bounds.terms_curvature, terms);
                bounds.curvature = wider(bounds.curvature, sum(ordered(conic), terms));
            }
        }
        bounds
    }
}

/// Returns bounds, on an annulus, of a polynomial that is given by its coefficients of r^0, r^1, ….
fn range(coefficients: &[f64], [from, to]: [f64; 2]) -> [f64; 2] {
    let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
    let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
    // Horner's rule with derivatives gives (p, p') from the coefficients, and p''/2 from the coefficients' magnitudes.
    let (mut size, mut size_slope) = (0.0, 0.0);
    for a in coefficients.iter().rev() {
        slope = slope * middle + value;
        value = value * middle + a;
        bend = bend * to + size_slope;
        size_slope = size_slope * to + size;
        size = size * to + a.abs();
    }
    let spread = slope.abs() * half + bend * half * half + ROUNDING * (size + size_slope * half);
    [value - spread, value + spread]
}

/// Returns T and dT/dr at r.
fn terms(asphere: &Asphere, r: f64) -> [f64; 2] {
    let mut value = 0.0;
    let mut slope = 0.0;
    let powers = std::iter::repeat_n(&0.0, FIRST_POWER).chain(&asphere.terms);
    for term in powers.rev() {
        slope = slope * r + value;
        value = value * r + term;
    }
    [value, slope]
}

fn conic_sagitta(asphere: &Asphere, r: f64) -> f64 {
    let c = asphere.radius.recip();
    c * r * r / (1.0 + conic_root(asphere, r))
}

fn conic_slope(asphere: &Asphere, r: f64) -> f64 {
    let c = asphere.radius.recip();
    if c == 0.0 { 0.0 } else { c * r / conic_root(asphere, r) }
}

/// Returns a conic's (dz/dr)/r and d²z/dr² at two distances from the axis.
fn conic_curvatures(asphere: &Asphere, edges: [f64; 2]) -> [[f64; 2]; 2] {
    let c = asphere.radius.recip();
    [1, 3].map(|power| edges.map(|r| if c == 0.0 { 0.0 } else { c / conic_root(asphere, r).powi(power) }))
}

/// Returns √(1 - (1 + k) c² r²): the z component of the conic's normal before normalisation.
fn conic_root(asphere: &Asphere, r: f64) -> f64 {
    let bent = r / asphere.radius;
    (1.0 - (1.0 + asphere.conic) * bent * bent).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::NO_TERMS;

    /// Returns a surface of a phone lens that turns back near its rim (US 2016/0341934 A1, example 11, surface 12), a
    /// surface with odd terms, and conics of every kind.
    fn figures() -> Vec<Figure> {
        let with = |radius, conic, terms: &[(usize, f64)], rim| {
            let mut asphere = Asphere { radius, conic, terms: NO_TERMS };
            for &(power, term) in terms {
                asphere.terms[power - FIRST_POWER] = term;
            }
            Figure::new(&asphere, rim).expect("an asphere")
        };
        let gull = [
            (4, -0.174_274),
            (6, 0.047_487_6),
            (8, -0.008_975_72),
            (10, 0.000_661_592),
            (12, 2.912_23e-5),
            (14, -4.361_44e-6),
        ];
        vec![
            with(1.681, -0.830_780_6, &gull, 2.235),
            with(f64::INFINITY, 0.0, &[(4, 1e-3)], 5.0),
            with(20.0, 0.0, &[(2, 1e-3), (3, -2e-4), (5, 1e-5), (20, 1e-18)], 8.0),
            with(-10.0, -1.0, &[], 9.0),
            with(-10.0, -3.0, &[], 30.0),
            with(10.0, 2.0, &[], 10.0 / 3.0_f64.sqrt()),
        ]
    }

    #[test]
    fn bounds_hold_every_height_and_are_close() {
        for figure in figures() {
            let Figure { asphere, rim, bounds } = figure;
            let mut found = [f64::INFINITY, f64::NEG_INFINITY];
            let mut steepest = 0.0_f64;
            for i in 0..=20_000 {
                let r = rim * f64::from(i) / 20_000.0;
                let z = figure.sagitta(r);
                let [t, slope] = terms(&asphere, r);
                let whole_slope = slope + conic_slope(&asphere, r);
                assert!(bounds.sagitta[0] <= z && z <= bounds.sagitta[1], "{figure:?} at {r}");
                assert!(t.abs() <= bounds.terms && slope.abs() <= bounds.terms_slope);
                assert!(whole_slope.abs() <= bounds.slope);
                let curvature = if r > 0.0 { slope / r } else { 2.0 * asphere.term(2) };
                let [least, most] = bounds.terms_curvature;
                assert!(least <= curvature && curvature <= most, "{figure:?} at {r}");
                let whole = if r > 0.0 { whole_slope / r } else { figure.vertex_curvature() };
                let [least, most] = bounds.curvature;
                // The slope at a vertical rim is infinite.
                let rounding = 1e-12 * whole.abs().min(1e300);
                assert!(least <= whole + rounding && whole - rounding <= most, "{figure:?} at {r}");
                found = [found[0].min(z), found[1].max(z)];
                steepest = steepest.max(whole_slope.abs());
            }
            let depth = found[1] - found[0];
            let [low, high] = bounds.sagitta;
            assert!(high - low < 1.05 * depth, "{figure:?}: {low} {high}, {found:?}");
            assert!(bounds.slope < 1.2 * steepest || steepest > 10.0, "{} {steepest}", bounds.slope);
        }
    }

    #[test]
    fn sagittae_follow_the_formula_and_are_smooth_past_the_edge() {
        for figure in figures() {
            let Figure { asphere, rim, .. } = figure;
            let r = 0.7 * rim;
            let c = asphere.radius.recip();
            let conic = c * r * r / (1.0 + (1.0 - (1.0 + asphere.conic) * c * c * r * r).sqrt());
            let powers = (FIRST_POWER as i32..).zip(&asphere.terms);
            let expected = conic + powers.map(|(power, term)| term * r.powi(power)).sum::<f64>();
            assert!((figure.sagitta(r) - expected).abs() < 1e-14 * rim);
            // The conic is subtracted because it may end at the rim.
            let terms_at = |r: f64| figure.sagitta(r) - conic_sagitta(&asphere, r);
            let h = 1e-6 * rim;
            let [before, after] = [terms_at(rim) - terms_at(rim - h), terms_at(rim + h) - terms_at(rim)];
            assert!((before - after).abs() < 1e-9 * rim, "{before} {after}");
        }
    }

    #[test]
    fn a_sphere_written_as_an_asphere_is_a_sphere() {
        let sphere = Asphere { radius: 12.0, conic: 0.0, terms: NO_TERMS };
        assert_eq!(Figure::new(&sphere, 5.0), None);
        assert_eq!(Figure::new(&Asphere { radius: f64::INFINITY, conic: -1.0, ..sphere }, 5.0), None);
        assert!(Figure::new(&Asphere { conic: -1.0, ..sphere }, 5.0).is_some());
    }
}
