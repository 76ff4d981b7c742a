//! Searches of one variable within a bracket: for a root of a continuous function, in few evaluations; for the point
//! where a condition changes, which has no values to interpolate; and for a minimum.

/// Returns the point of `[inside, outside]` up to which `holds` is true, found by bisection to a width of `width` (0:
/// to the last bit). The caller ensures that `holds` is true at `inside` and false at `outside`. If `holds` changes
/// more than once, the result is one of the changes. If an end is NaN, the result is `inside`.
pub fn edge(mut inside: f64, mut outside: f64, width: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = f64::midpoint(inside, outside);
        let apart = middle > inside.min(outside) && middle < inside.max(outside);
        if !(apart && (outside - inside).abs() > width) {
            return inside;
        }
        if holds(middle) { inside = middle } else { outside = middle }
    }
}

/// Returns a root of the continuous function `f` between `a` and `b`. The values of `f` at `a` and `b` have opposite
/// signs, or one of them is 0. The method is that of Brent and Dekker (R. P. Brent, *Algorithms for Minimization
/// without Derivatives*, 1973, ch. 4, `zero`): inverse quadratic or linear interpolation if that closes the bracket
/// fast enough, otherwise bisection.
///
/// The bracket closes to two units in the last place of the root. The search never leaves `[a, b]`. The number of steps
/// is at most about the square of the number that bisection would need; a smooth function needs about seven
/// evaluations. If the signs are not opposite, or a value is NaN, the result is the best point so far.
pub fn root(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    // The letters are Brent's: b is the best point, c the other end of the bracket, a the previous best point.
    let (mut a, mut b) = (a, b);
    let (mut fa, mut fb) = (f(a), f(b));
    let (mut c, mut fc) = (a, fa);
    // The last step, and the step before it.
    let (mut step, mut before) = (b - a, b - a);
    loop {
        if fc.abs() < fb.abs() {
            (a, b, c) = (b, c, b);
            (fa, fb, fc) = (fb, fc, fb);
        }
        let least = f64::EPSILON * b.abs() + f64::MIN_POSITIVE;
        let half = 0.5 * (c - b);
        // A bracket with NaN at an end, or with the same sign at both ends, cannot be closed.
        if !(half.abs() > least && half.is_finite() && fb != 0.0 && (fb < 0.0) != (fc < 0.0)) {
            return b;
        }
        let mut bisect = true;
        if before.abs() >= least && fa.abs() > fb.abs() {
            let s = fb / fa;
            let (p, q) = if a == c {
                (2.0 * half * s, 1.0 - s)
            } else {
                let (q, r) = (fa / fc, fb / fc);
                (s * (2.0 * half * q * (q - r) - (b - a) * (r - 1.0)), (q - 1.0) * (r - 1.0) * (s - 1.0))
            };
            let (p, q) = if p > 0.0 { (p, -q) } else { (-p, q) };
            if 2.0 * p < 3.0 * half * q - (least * q).abs() && p < (0.5 * before * q).abs() {
                (before, step) = (step, p / q);
                bisect = false;
            }
        }
        if bisect {
            (before, step) = (half, half);
        }
        (a, fa) = (b, fb);
        b += if step.abs() > least { step } else { least.copysign(half) };
        fb = f(b);
        if fb.is_nan() {
            return a;
        }
        if (fb > 0.0) == (fc > 0.0) {
            (c, fc) = (a, fa);
            (step, before) = (b - a, b - a);
        }
    }
}

/// Returns the argument at which a function with one minimum in `[a, b]` is least. The search is by golden section (W.
/// H. Press et al., *Numerical Recipes*, 3rd ed., §10.2), until the bracket has shrunk to `tolerance` of its width.
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

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn an_edge_and_a_root_are_found_to_the_last_bit() {
        let target = 2.0_f64.sqrt();
        assert_eq!(edge(1.0, 2.0, 0.0, |x| x * x < 2.0), target.next_down());
        assert!((root(1.0, 2.0, |x| x * x - 2.0) - target).abs() <= f64::EPSILON);
        assert!((root(0.0, 1e9, |x| x.cbrt() - 1e-3) - 1e-9).abs() < 1e-18);
        assert_eq!(root(3.0, 4.0, |x| x - 3.0), 3.0);
    }

    #[test]
    fn an_edge_is_within_its_width_and_on_the_inside() {
        let found = edge(0.0, 5.0, 1e-3, |x| x < 1.7);
        assert!(found < 1.7 && 1.7 - found <= 1e-3);
    }

    #[test]
    fn a_smooth_root_takes_few_steps_whichever_end_is_named_first() {
        let steps = Cell::new(0);
        let counted = |x: f64| {
            steps.set(steps.get() + 1);
            x.exp() - 2.0
        };
        for (a, b) in [(0.0, 3.0), (3.0, 0.0), (-50.0, 1.0)] {
            steps.set(0);
            assert!((root(a, b, counted) - 2.0_f64.ln()).abs() < 1e-15);
            assert!(steps.get() <= 14, "{} steps", steps.get());
        }
    }

    #[test]
    fn a_function_unlike_a_line_takes_as_many_steps_as_bisection() {
        let steps = Cell::new(0);
        let sign = |x: f64| {
            steps.set(steps.get() + 1);
            if x < 0.7 { -1.0 } else { 1.0 }
        };
        assert!((root(0.0, 1.0, sign) - 0.7).abs() < 1e-15);
        assert!(steps.get() < 120, "{} steps", steps.get());
    }

    #[test]
    fn searches_end_where_there_are_no_numbers() {
        for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::INFINITY), (0.0, f64::INFINITY)] {
            edge(a, b, 0.0, |x| x < 0.5);
            root(a, b, |x| x - 0.5);
            root(a, b, |_| f64::NAN);
        }
        assert_eq!(root(1.0, 2.0, |x| x), 1.0);
    }

    #[test]
    fn a_minimum_is_found() {
        assert!((minimum(-4.0, 10.0, 1e-9, |x| (x - 1.5).powi(2)) - 1.5).abs() < 1e-7);
    }

    #[test]
    fn a_search_ends_where_there_are_no_numbers() {
        for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::INFINITY), (0.0, f64::INFINITY)] {
            minimum(a, b, 1e-8, |x| x * x);
        }
    }
}
