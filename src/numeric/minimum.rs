//! Where a function of one variable is least, in a bracket (golden section: W. H. Press et al., *Numerical Recipes*,
//! 3rd ed., §10.2).

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

#[cfg(test)]
mod tests {
    use super::*;

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
