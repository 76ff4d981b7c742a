//! The incomplete gamma function, of which the tails of the chi-squared and Poisson's distributions are made
//! (M. Abramowitz and I. Stegun, *Handbook of Mathematical Functions*, ch. 6).

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
