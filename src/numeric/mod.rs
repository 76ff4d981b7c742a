//! The few numerical tools that several modules need: a root in a bracket, an edge, a minimum, a quadrature, the
//! incomplete gamma function, of which the tails of the chi-squared and Poisson's distributions are made, a point
//! set of low discrepancy, and [`Real`], the numbers that rays are traced in.

pub mod quasirandom;
mod real;

pub use real::Real;

/// The point of `[inside, outside]` up to which `holds`, to the last bit; `holds(inside)` is
/// taken for granted and `outside` is where it no longer does. Where it changes more than once,
/// one of the changes.
pub fn edge(mut inside: f64, mut outside: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = f64::midpoint(inside, outside);
        // Negated so that NaN ends the search, too.
        if !(middle > inside.min(outside) && middle < inside.max(outside)) {
            return inside;
        }
        if holds(middle) { inside = middle } else { outside = middle }
    }
}

/// A root of a continuous function in `[a, b]`, where it has opposite signs at the two ends
/// (or is 0 at one), to the last bits: bisection combined with the secant of
/// the Illinois method, so that a bad secant costs one evaluation and never the bracket.
pub fn root(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut fa, mut fb) = (f(a), f(b));
    let mut bisect = false;
    while fa != 0.0 && fb != 0.0 {
        let middle = f64::midpoint(a, b);
        if !(middle > a.min(b) && middle < a.max(b)) {
            break;
        }
        let secant = b - fb * (b - a) / (fb - fa);
        let inside = (secant - a) * (secant - b) < 0.0;
        let x = if bisect || !inside { middle } else { secant };
        let width = (b - a).abs();
        let fx = f(x);
        if (fx < 0.0) == (fb < 0.0) {
            fa /= 2.0;
        } else {
            (a, fa) = (b, fb);
        }
        (b, fb) = (x, fx);
        bisect = (b - a).abs() > width / 2.0;
    }
    if fa == 0.0 { a } else { b }
}

/// Where a function with one minimum in `[a, b]` has it, by golden section, to `tolerance`
/// relative to the bracket.
pub fn minimum(mut a: f64, mut b: f64, tolerance: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let stop = (b - a) * tolerance;
    let (mut left, mut right) = (b - golden * (b - a), a + golden * (b - a));
    let (mut f_left, mut f_right) = (f(left), f(right));
    while b - a > stop {
        if f_left < f_right {
            (b, right, f_right) = (right, left, f_left);
            left = b - golden * (b - a);
            f_left = f(left);
        } else {
            (a, left, f_left) = (left, right, f_right);
            right = a + golden * (b - a);
            f_right = f(right);
        }
    }
    f64::midpoint(a, b)
}

/// The regularised upper incomplete gamma function Q(a, x), a > 0 and x >= 0: by its series below a + 1
/// and its continued fraction beyond (Abramowitz and Stegun, 6.5.29 and 6.5.31; the fraction by
/// Lentz's method). For a up to hundreds the relative error is some 1e-13.
pub fn upper_gamma(a: f64, x: f64) -> f64 {
    const TERMS: u32 = 10_000;
    if x <= 0.0 {
        return 1.0;
    }
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..TERMS {
            term *= x / (a + f64::from(n));
            sum += term;
            if term < sum * f64::EPSILON {
                break;
            }
        }
        return 1.0 - sum * scale;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / f64::MIN_POSITIVE;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for n in 1..TERMS {
        let n = f64::from(n);
        b += 2.0;
        let step = n * (a - n);
        d = 1.0 / (b + step * d);
        c = b + step / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    scale * fraction
}

/// ln Γ(a) for a > 0: Stirling's series (Abramowitz and Stegun, 6.1.41) after stepping up to a >= 20.
fn ln_gamma(mut a: f64) -> f64 {
    let mut steps = 1.0;
    while a < 20.0 {
        steps *= a;
        a += 1.0;
    }
    let square = (a * a).recip();
    let series = [1.0 / 1188.0, -1.0 / 1680.0, 1.0 / 1260.0, -1.0 / 360.0, 1.0 / 12.0];
    let series = series.into_iter().fold(0.0, |sum, term| sum * square + term) / a;
    (a - 0.5) * a.ln() - a + 0.5 * std::f64::consts::TAU.ln() + series - steps.ln()
}

/// Nodes and weights on [0, 1] of the 16-point Gauss-Legendre rule (Abramowitz and Stegun,
/// table 25.4), found by Newton's iteration on the Legendre recurrence.
pub fn gauss_legendre() -> [(f64, f64); GAUSS_POINTS] {
    let n = GAUSS_POINTS as f64;
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut p, mut before) = (1.0, 0.0);
            for j in 0..GAUSS_POINTS {
                let j = j as f64;
                (p, before) = (((2.0 * j + 1.0) * x * p - j * before) / (j + 1.0), p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// Points of the quadrature.
pub const GAUSS_POINTS: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_and_a_root_are_found_to_the_last_bit() {
        let target = 2.0_f64.sqrt();
        assert_eq!(edge(1.0, 2.0, |x| x * x < 2.0), target.next_down());
        assert!((root(1.0, 2.0, |x| x * x - 2.0) - target).abs() <= f64::EPSILON);
        assert!((root(0.0, 1e9, |x| x.cbrt() - 1e-3) - 1e-9).abs() < 1e-18);
        assert_eq!(root(3.0, 4.0, |x| x - 3.0), 3.0);
    }

    #[test]
    fn searches_end_where_there_are_no_numbers() {
        for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::INFINITY), (0.0, f64::INFINITY)] {
            edge(a, b, |x| x < 0.5);
            root(a, b, |x| x - 0.5);
            root(a, b, |_| f64::NAN);
            minimum(a, b, 1e-8, |x| x * x);
        }
    }

    #[test]
    fn a_minimum_is_found() {
        assert!((minimum(-4.0, 10.0, 1e-9, |x| (x - 1.5).powi(2)) - 1.5).abs() < 1e-7);
    }

    #[test]
    fn the_incomplete_gamma_function_has_its_closed_forms() {
        // Q(1, x) = exp(-x), and Q(3, x) = exp(-x) (1 + x + x²/2).
        for x in [0.1, 1.0, 3.0, 20.0] {
            let e = f64::exp(-x);
            assert!((upper_gamma(1.0, x) / e - 1.0).abs() < 1e-12, "{x}");
            assert!((upper_gamma(3.0, x) / (e * (1.0 + x + x * x / 2.0)) - 1.0).abs() < 1e-12, "{x}");
        }
        assert_eq!(upper_gamma(2.0, 0.0), 1.0);
    }

    #[test]
    fn the_quadrature_is_exact_to_degree_31() {
        let rule = gauss_legendre();
        let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(31)).sum();
        assert!((integral - 1.0 / 32.0).abs() < 1e-16);
        assert!((rule.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
