//! The Illinois method (M. Dowell and P. Jarratt, "A modified regula falsi method for computing the root of an
//! equation", 1971): a bracket of a root and a function in, a point near the root out, as near as is asked.
//!
//! Not [`crate::numeric::root`], which is exact to the last bits: tables are built with these searches while a host
//! waits, and end as soon as the table needs no more.

/// A point near where `f` changes its sign between `a` and `b`, for a < b and a function that is negative at a and not at b:
/// the end `b` of a bracket as narrow as `relative` of it; `a` at once where the function is not negative there.
///
/// Every point is at least a hundredth of the bracket away from its ends, so that it closes from both sides; where the
/// secants of two have not halved it, it is halved four times, for the function may jump.
pub(crate) fn illinois(a: f64, b: f64, relative: f64, f: impl Fn(f64) -> f64) -> f64 {
    // The bracket's ends and the function there; that of the end which stays is halved.
    let (mut low, mut at_low) = (a, f(a));
    if at_low >= 0.0 {
        return a;
    }
    let (mut high, mut at_high) = (b, f(b));
    // Which end was found last.
    let mut last_negative = None;
    // How wide the bracket was at the last secant and the one before, and how often it is still to be halved.
    let (mut widths, mut halvings) = ([f64::INFINITY; 2], 0);
    loop {
        let width = high - low;
        if !(width > relative * high) {
            return high;
        }
        if width > widths[1] / 2.0 {
            (widths, halvings) = ([width, f64::INFINITY], 4);
        }
        let x = if halvings > 0 {
            halvings -= 1;
            f64::midpoint(high, low)
        } else {
            widths = [width, widths[0]];
            let secant = high - at_high * width / (at_high - at_low);
            secant.clamp(low + 0.01 * width, high - 0.01 * width)
        };
        let at_x = f(x);
        let negative = at_x < 0.0;
        let stayed = last_negative == Some(negative);
        if negative {
            (low, at_low) = (x, at_x);
            if stayed {
                at_high /= 2.0;
            }
        } else {
            (high, at_high) = (x, at_x);
            if stayed {
                at_low /= 2.0;
            }
        }
        last_negative = Some(negative);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_is_found_as_near_as_asked_and_from_the_side_that_is_promised() {
        let f = |x: f64| x.exp() - 2.0;
        let root = 2.0_f64.ln();
        let found = illinois(-3.0, 3.0, 1e-9, f);
        assert!(f(found) >= 0.0 && found - root <= 1e-9, "{found}");
        assert_eq!(illinois(1.0, 3.0, 1e-9, f), 1.0);
    }

    #[test]
    fn a_jump_is_closed_in_on_in_less_than_twice_the_steps_of_halving() {
        let count = std::cell::Cell::new(0);
        let jump = |x: f64| {
            count.set(count.get() + 1);
            if x < 0.3 { x - 1.0 } else { 1e-12 }
        };
        let found = illinois(0.1, 1.0, 1e-9, jump);
        assert!((0.0..1e-9).contains(&(found - 0.3)), "{found}");
        assert!(count.get() < 56, "{count:?}");
    }
}
