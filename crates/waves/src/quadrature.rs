//! Gauss-Legendre quadrature with any number of points.

use std::f64::consts::PI;

/// Returns the points in (-1, 1), in order, and the weights of the rule with `count` points: the roots of the Legendre
/// polynomial by Newton's iteration (W. H. Press and others, *Numerical Recipes*, §4.6).
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let mut rule: Vec<(f64, f64)> = (1..=count)
        .map(|i| {
            let mut x = (PI * (i as f64 - 0.25) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut before, mut here) = (0.0, 1.0);
                for k in 1..=count {
                    let k = k as f64;
                    (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
                }
                slope = n * (x * here - before) / (x * x - 1.0);
                let step = here / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect();
    rule.reverse();
    rule
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [1, 2, 5, 16, 65, 256] {
            let rule = gauss_legendre(count);
            assert!(rule.windows(2).all(|pair| pair[0].0 < pair[1].0), "{count}");
            for power in
                [0, 1, 2, 2 * count - 1, 2 * count - 2].into_iter().filter(|power| *power < 2 * count)
            {
                let sum: f64 = rule.iter().map(|(x, weight)| weight * x.powi(power as i32)).sum();
                let expected = if power % 2 == 0 { 2.0 / (power as f64 + 1.0) } else { 0.0 };
                assert!((sum - expected).abs() < 1e-13, "{count} {power}: {sum} {expected}");
            }
        }
    }
}
