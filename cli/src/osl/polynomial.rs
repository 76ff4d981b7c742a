//! Polynomials of one variable, and their least-squares fit to samples.

/// A polynomial: coefficients by rising power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial<const N: usize>(pub [f64; N]);

impl<const N: usize> Polynomial<N> {
    /// Returns the value, by Horner's rule.
    pub fn at(&self, x: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, term| sum * x + term)
    }
}

/// Fits the polynomial of `N` terms with the least sum of squared errors at `N` or more points (x, y).
pub fn fit<const N: usize>(x: &[f64], y: &[f64]) -> Polynomial<N> {
    let powers: Vec<[f64; N]> = x.iter().map(|&x| std::array::from_fn(|i| x.powi(i as i32))).collect();
    Polynomial(least_squares(&powers, y))
}

/// Returns the weights of `N` basis functions, whose values at each sample are `basis`, that best match `y`, by the QR
/// decomposition of modified Gram-Schmidt (G. H. Golub and C. F. Van Loan, *Matrix Computations*, §5.2.8). A weight
/// that the samples do not determine is 0.
pub fn least_squares<const N: usize>(basis: &[[f64; N]], y: &[f64]) -> [f64; N] {
    let mut columns: Vec<Vec<f64>> = (0..N).map(|i| basis.iter().map(|row| row[i]).collect()).collect();
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut rest = y.to_vec();
    let (mut upper, mut right) = ([[0.0; N]; N], [0.0; N]);
    for i in 0..N {
        let length = dot(&columns[i], &columns[i]).sqrt();
        upper[i][i] = length;
        if length < 1e-12 {
            continue;
        }
        let (done, left) = columns.split_at_mut(i + 1);
        let own = &mut done[i];
        own.iter_mut().for_each(|value| *value /= length);
        for (column, entry) in left.iter_mut().zip(&mut upper[i][i + 1..]) {
            *entry = dot(own, column);
            column.iter_mut().zip(&*own).for_each(|(value, own)| *value -= *entry * own);
        }
        right[i] = dot(own, &rest);
        rest.iter_mut().zip(&*own).for_each(|(value, own)| *value -= right[i] * own);
    }
    let mut weights = [0.0; N];
    for i in (0..N).rev() {
        if upper[i][i] >= 1e-12 {
            let known: f64 = (i + 1..N).map(|j| upper[i][j] * weights[j]).sum();
            weights[i] = (right[i] - known) / upper[i][i];
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_recovers_polynomials_and_the_known_best_line() {
        let expected = Polynomial([1.0, -2.0, 0.5, 3.0]);
        let x: Vec<f64> = (0..9).map(|i| f64::from(i) / 8.0).collect();
        let y: Vec<f64> = x.iter().map(|&x| expected.at(x)).collect();
        let found: Polynomial<4> = fit(&x, &y);
        assert!(found.0.iter().zip(expected.0).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?}");
        let line: Polynomial<2> = fit(&[0.0, 1.0, 2.0], &[0.0, 0.0, 3.0]);
        assert!((line.0[0] + 0.5).abs() < 1e-14 && (line.0[1] - 1.5).abs() < 1e-14, "{line:?}");
        let [mean, unknown] = least_squares(&[[1.0, 0.0], [1.0, 0.0]], &[1.0, 3.0]);
        assert!((mean - 2.0).abs() < 1e-14 && unknown == 0.0, "{mean} {unknown}");
    }
}
