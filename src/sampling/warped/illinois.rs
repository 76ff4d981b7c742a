//! The Illinois method (M. Dowell and P. Jarratt, "A modified regula falsi method for computing the root of an
//! equation", 1971): a bracket of a root and a function in, a point near the root out, as near as is asked.
//!
//! Not [`crate::numeric::root`], which is exact to the last bits: tables are built with these searches while a host
//! waits, and end as soon as the table needs no more. With `root` in their place, ended by the same tolerances where it
//! can be, building a camera with this pupil took 0 to 5 % longer (dgauss.50mm 4.5, telephoto.250mm 3.3, fisheye.10mm
//! 1.5, wide.22mm 0.3 %), and degenerate pupils got other tables.

/// When a search ends, and with which point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Closing {
    /// When the bracket is this narrow, relative to its end `b`, which it then answers with. Every point is at least a
    /// hundredth of the bracket away from its ends, so that it closes from both sides; where the secants of two have not
    /// halved it, it is halved four times, for the function may jump. For a < b and a function that is negative at a and not at
    /// b; a at once where the function is not negative there.
    Bracket(f64),
    /// When a point is this near to the one before it, which may be from either side, or after so many points; with the
    /// last of them.
    Step { width: f64, most: u32 },
}

/// A point near where `f` changes its sign between `a` and `b`.
pub(crate) fn illinois(a: f64, b: f64, closing: Closing, f: impl Fn(f64) -> f64) -> f64 {
    // The bracket's ends, the one found last and the other, and the function there; the other's is halved whenever that
    // end has stayed.
    let (mut other, mut at_other) = (a, f(a));
    let (mut last, mut at_last) = (b, f(b));
    let two_sided = matches!(closing, Closing::Bracket(_));
    if two_sided && at_other >= 0.0 {
        return a;
    }
    let mut negative = !two_sided && at_last < 0.0;
    // How wide the bracket was at the last secant and the one before, and how often it is still to be halved.
    let (mut widths, mut halvings) = ([f64::INFINITY; 2], 0);
    for points in 0.. {
        // The secant is drawn from `from`.
        let (from, at_from, to, at_to) = if two_sided && negative {
            (other, at_other, last, at_last)
        } else {
            (last, at_last, other, at_other)
        };
        let mut x = from - at_from * (from - to) / (at_from - at_to);
        match closing {
            Closing::Bracket(relative) => {
                let width = from - to;
                if !(width > relative * from) {
                    return from;
                }
                if width > widths[1] / 2.0 {
                    (widths, halvings) = ([width, f64::INFINITY], 4);
                }
                x = if halvings > 0 {
                    halvings -= 1;
                    f64::midpoint(from, to)
                } else {
                    widths = [width, widths[0]];
                    x.clamp(to + 0.01 * width, from - 0.01 * width)
                };
            }
            Closing::Step { most, .. } if points == most => return last,
            Closing::Step { .. } => {}
        }
        let at_x = f(x);
        if (at_x < 0.0) != negative {
            (other, at_other) = (last, at_last);
        } else if points > 0 || !two_sided {
            at_other /= 2.0;
        }
        let step = (x - last).abs();
        (last, at_last, negative) = (x, at_x, at_x < 0.0);
        if let Closing::Step { width, .. } = closing
            && (step < width || at_last == 0.0)
        {
            break;
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_is_found_as_near_as_asked_and_from_the_side_that_is_promised() {
        let f = |x: f64| x.exp() - 2.0;
        let root = 2.0_f64.ln();
        let found = illinois(-3.0, 3.0, Closing::Bracket(1e-9), f);
        assert!(f(found) >= 0.0 && found - root <= 1e-9, "{found}");
        for (a, b) in [(0.0, 3.0), (3.0, 0.0)] {
            let found = illinois(a, b, Closing::Step { width: 1e-6, most: 30 }, f);
            assert!((found - root).abs() < 1e-6, "{found}");
        }
        assert_eq!(illinois(1.0, 3.0, Closing::Bracket(1e-9), f), 1.0);
    }

    #[test]
    fn a_jump_is_closed_in_on_in_less_than_twice_the_steps_of_halving() {
        let count = std::cell::Cell::new(0);
        let jump = |x: f64| {
            count.set(count.get() + 1);
            if x < 0.3 { x - 1.0 } else { 1e-12 }
        };
        let found = illinois(0.1, 1.0, Closing::Bracket(1e-9), jump);
        assert!((0.0..1e-9).contains(&(found - 0.3)), "{found}");
        assert!(count.get() < 56, "{count:?}");
    }

    #[test]
    fn a_search_ends_after_as_many_points_as_it_may_take() {
        let count = std::cell::Cell::new(0);
        let cubic = |x: f64| {
            count.set(count.get() + 1);
            (x - 0.3).powi(9)
        };
        illinois(-1.0, 2.0, Closing::Step { width: 0.0, most: 5 }, cubic);
        assert_eq!(count.get(), 2 + 5);
    }
}
