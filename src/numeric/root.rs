//! Where a function or a condition of one variable changes sign, in a bracket.

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
        }
    }
}
