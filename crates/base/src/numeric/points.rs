//! Points at which functions are sampled: the nodes and weights of Gauss-Legendre quadrature (M. Abramowitz and I.
//! Stegun, *Handbook of Mathematical Functions*, §25.4), and the low-discrepancy sequence of an additive recurrence,
//! which needs no table and no seed.

/// Returns the nodes and weights on [0, 1] of the 16-point Gauss-Legendre rule (Abramowitz and Stegun, table 25.4),
/// computed by Newton's iteration on the Legendre recurrence.
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

/// Number of points of the quadrature.
pub const GAUSS_POINTS: usize = 16;

/// Steps of an additive recurrence. The fractional parts of the multiples of these four numbers fill the
/// four-dimensional unit cube evenly. The steps are the powers of 1/g, where g > 1 satisfies g^5 = g + 1 (M. Roberts,
/// "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
pub const STEPS: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_808_7, 0.538_597_257_225_901_9];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quadrature_is_exact_to_degree_31() {
        let rule = gauss_legendre();
        let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(31)).sum();
        assert!((integral - 1.0 / 32.0).abs() < 1e-16);
        assert!((rule.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
