//! Zernike polynomials on the unit disk: indices, values, and fits by least squares.

/// The order in which the polynomials are counted, and their normalisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ordering {
    /// R. J. Noll, "Zernike polynomials and atmospheric turbulence", 1976: from 1; each has an RMS of 1 over the disk, so
    /// that its coefficient is its share of the RMS.
    Noll,
    /// The University of Arizona's order, called fringe: from 1; each is 1 at the edge, at the angle 0 for cosines.
    Fringe,
}

/// The radial degree n and the azimuthal degree m of a polynomial; m is negative for a sine.
type Degrees = [i32; 2];

impl Ordering {
    /// Returns the degrees of the polynomial with this index, from 1 on.
    pub fn degrees(self, index: usize) -> Degrees {
        match self {
            Self::Noll => noll(index),
            Self::Fringe => fringe(index),
        }
    }

    /// Returns the value of the polynomial with this index at (x, y) = (r cos θ, r sin θ).
    pub fn value(self, index: usize, [x, y]: [f64; 2]) -> f64 {
        let [n, m] = self.degrees(index);
        let (r, angle) = (x.hypot(y), y.atan2(x));
        let turn = f64::from(m.abs()) * angle;
        let value = radial(n, m.abs(), r) * if m < 0 { turn.sin() } else { turn.cos() };
        match self {
            Self::Noll => value * (f64::from(n + 1) * if m == 0 { 1.0 } else { 2.0 }).sqrt(),
            Self::Fringe => value,
        }
    }
}

fn noll(index: usize) -> Degrees {
    let mut n = 0;
    let mut first = 1;
    while index > first + n as usize {
        first += n as usize + 1;
        n += 1;
    }
    // Within a degree |m| grows from n mod 2 in pairs; the even index of a pair is the cosine.
    let place = (index - first) as i32;
    let m = if n % 2 == 0 { 2 * ((place + 1) / 2) } else { 2 * (place / 2) + 1 };
    [n, if index.is_multiple_of(2) { m } else { -m }]
}

fn fringe(index: usize) -> Degrees {
    // Groups of (n + |m|)/2 = k have 2 k + 1 polynomials, from |m| = k down; a cosine comes before its sine.
    let k = ((index - 1) as f64).sqrt() as i32;
    let place = index as i32 - 1 - k * k;
    let m = k - place / 2;
    [2 * k - m, if place % 2 == 0 { m } else { -m }]
}

/// Returns the radial polynomial of degree n, by Kintner's formula of factorials.
fn radial(n: i32, m: i32, r: f64) -> f64 {
    let factorial = |k: i32| (1..=k).map(f64::from).product::<f64>();
    (0..=(n - m) / 2)
        .map(|k| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let below = factorial(k) * factorial((n + m) / 2 - k) * factorial((n - m) / 2 - k);
            sign * factorial(n - k) / below * r.powi(n - 2 * k)
        })
        .sum()
}

/// Returns the coefficients of the first `count` polynomials that fit samples best. A sample is a point, a value and a
/// weight. The normal equations are solved by Cholesky's method; polynomials that the samples cannot distinguish from
/// earlier ones get 0.
pub fn fitted(
    ordering: Ordering,
    count: usize,
    samples: impl Iterator<Item = ([f64; 2], f64, f64)>,
) -> Vec<f64> {
    let mut matrix = vec![vec![0.0; count]; count];
    let mut right = vec![0.0; count];
    for (point, value, weight) in samples {
        let basis: Vec<f64> = (1..=count).map(|index| ordering.value(index, point)).collect();
        for i in 0..count {
            right[i] += weight * basis[i] * value;
            for j in 0..=i {
                matrix[i][j] += weight * basis[i] * basis[j];
            }
        }
    }
    solved(matrix, right)
}

/// Smallest pivot, relative to the diagonal, that is told from 0.
const INDEPENDENT: f64 = 1e-12;

/// Solves linear equations. The matrix is symmetric, and only its lower half is read.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    for i in 0..count {
        for j in 0..=i {
            let inner: f64 = (0..j).map(|k| matrix[i][k] * matrix[j][k]).sum();
            let rest = matrix[i][j] - inner;
            matrix[i][j] = if i == j {
                if rest > INDEPENDENT * matrix[i][i] { rest.sqrt() } else { 0.0 }
            } else if matrix[j][j] > 0.0 {
                rest / matrix[j][j]
            } else {
                0.0
            };
        }
    }
    for i in 0..count {
        let inner: f64 = (0..i).map(|k| matrix[i][k] * right[k]).sum();
        right[i] = if matrix[i][i] > 0.0 { (right[i] - inner) / matrix[i][i] } else { 0.0 };
    }
    for i in (0..count).rev() {
        let inner: f64 = (i + 1..count).map(|k| matrix[k][i] * right[k]).sum();
        right[i] = if matrix[i][i] > 0.0 { (right[i] - inner) / matrix[i][i] } else { 0.0 };
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_those_of_the_tables() {
        // prysm 0.21.1: noll_to_nm and fringe_to_nm of 1 to 16.
        let noll = [
            [0, 0],
            [1, 1],
            [1, -1],
            [2, 0],
            [2, -2],
            [2, 2],
            [3, -1],
            [3, 1],
            [3, -3],
            [3, 3],
            [4, 0],
            [4, 2],
            [4, -2],
            [4, 4],
            [4, -4],
            [5, 1],
        ];
        let fringe = [
            [0, 0],
            [1, 1],
            [1, -1],
            [2, 0],
            [2, 2],
            [2, -2],
            [3, 1],
            [3, -1],
            [4, 0],
            [3, 3],
            [3, -3],
            [4, 2],
            [4, -2],
            [5, 1],
            [5, -1],
            [6, 0],
        ];
        for (index, (noll, fringe)) in (1..).zip(noll.into_iter().zip(fringe)) {
            assert_eq!(Ordering::Noll.degrees(index), noll, "Noll {index}");
            assert_eq!(Ordering::Fringe.degrees(index), fringe, "fringe {index}");
        }
    }

    #[test]
    fn polynomials_are_orthogonal_and_fits_return_their_coefficients() {
        let point = |i: u32| {
            let (r, angle) = (((f64::from(i) + 0.5) / 20_000.0).sqrt(), 2.399_963_229_728_653 * f64::from(i));
            [r * angle.cos(), r * angle.sin()]
        };
        for (a, b) in [(1, 1), (4, 4), (4, 6), (7, 7), (7, 8), (11, 22), (22, 22), (2, 16)] {
            let product = |i: u32| Ordering::Noll.value(a, point(i)) * Ordering::Noll.value(b, point(i));
            let mean = (0..20_000).map(product).sum::<f64>() / 20_000.0;
            assert!((mean - f64::from(u8::from(a == b))).abs() < 2e-3, "{a} {b}: {mean}");
        }
        for ordering in [Ordering::Noll, Ordering::Fringe] {
            let given: Vec<f64> = (0..37).map(|i| (0.5 + 0.618_034 * f64::from(i)).fract() - 0.5).collect();
            let value =
                |at: [f64; 2]| (1..).zip(&given).map(|(index, c)| c * ordering.value(index, at)).sum::<f64>();
            // Over a pupil that is cut off, where the polynomials are not orthogonal.
            let samples = (0..20_000).map(point).filter(|[x, _]| *x < 0.6).map(|at| (at, value(at), 1.0));
            for (own, given) in fitted(ordering, 37, samples).iter().zip(&given) {
                assert!((own - given).abs() < 1e-9, "{ordering:?} {own} {given}");
            }
        }
    }
}
