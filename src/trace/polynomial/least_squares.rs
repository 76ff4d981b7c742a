//! Linear least squares by Householder reflections (G. Golub, "Numerical methods for solving linear
//! least squares problems", *Numerische Mathematik* 7, 1965), which lose half the digits that the
//! normal equations lose.

/// A matrix of equations, column by column.
#[derive(Clone, Debug)]
pub(super) struct Equations {
    rows: usize,
    columns: Vec<Vec<f64>>,
}

/// A column whose remaining length is this small against its whole is a combination of others.
const DEPENDENT: f64 = 1e-13;

impl Equations {
    pub fn new(rows: usize, columns: usize) -> Self {
        Self { rows, columns: vec![vec![0.0; rows]; columns] }
    }

    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.columns[column][row] = value;
    }

    /// The solutions that minimise the sum of squares of the residuals, one for each right-hand side;
    /// `None` when the columns are not independent.
    pub fn solve(mut self, mut sides: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
        let unknowns = self.columns.len();
        if self.rows < unknowns {
            return None;
        }
        let mut diagonal = Vec::with_capacity(unknowns);
        for k in 0..unknowns {
            let (done, rest) = self.columns.split_at_mut(k + 1);
            let column = &mut done[k];
            let whole = norm(column);
            let length = norm(&column[k..]);
            if !(length > DEPENDENT * whole) {
                return None;
            }
            let pivot = -length.copysign(column[k]);
            diagonal.push(pivot);
            // The reflector takes the place of what it makes zero.
            column[k] -= pivot;
            let reflector = &column[k..];
            let scale = -1.0 / (pivot * reflector[0]);
            for other in rest.iter_mut().chain(&mut sides) {
                let other = &mut other[k..];
                let along = scale * reflector.iter().zip(&*other).map(|(a, b)| a * b).sum::<f64>();
                other.iter_mut().zip(reflector).for_each(|(b, a)| *b -= along * a);
            }
        }
        Some(sides.into_iter().map(|side| self.substitute(&diagonal, &side)).collect())
    }

    fn substitute(&self, diagonal: &[f64], side: &[f64]) -> Vec<f64> {
        let mut solution = side[..diagonal.len()].to_vec();
        for k in (0..diagonal.len()).rev() {
            solution[k] /= diagonal[k];
            for row in 0..k {
                solution[row] -= self.columns[k][row] * solution[k];
            }
        }
        solution
    }
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn powers(rows: usize, columns: usize) -> Equations {
        let mut equations = Equations::new(rows, columns);
        for row in 0..rows {
            let x = 2.0 * row as f64 / (rows - 1) as f64 - 1.0;
            (0..columns).for_each(|column| equations.set(row, column, x.powi(column as i32)));
        }
        equations
    }

    #[test]
    fn a_polynomial_is_found_again() {
        let known = [0.5, -2.0, 0.0, 3.0, 1.0];
        let equations = powers(40, known.len());
        let side = (0..40).map(|i| (0..5).map(|j| known[j] * equations.columns[j][i]).sum()).collect();
        let found = equations.solve(vec![side]).expect("independent columns");
        for (a, b) in found[0].iter().zip(known) {
            assert!((a - b).abs() < 1e-13, "{a} is not {b}");
        }
    }

    #[test]
    fn the_residual_is_orthogonal_to_every_column() {
        let equations = powers(30, 4);
        let side: Vec<f64> = (0..30).map(|i| f64::from(i * i % 7)).collect();
        let solution = equations.clone().solve(vec![side.clone()]).expect("independent columns");
        let residual: Vec<f64> = (0..30)
            .map(|i| side[i] - (0..4).map(|j| solution[0][j] * equations.columns[j][i]).sum::<f64>())
            .collect();
        for column in &equations.columns {
            let product: f64 = residual.iter().zip(column).map(|(a, b)| a * b).sum();
            assert!(product.abs() < 1e-12, "{product}");
        }
    }

    #[test]
    fn dependent_columns_and_too_few_rows_have_no_solution() {
        let mut twice = powers(10, 2);
        twice.columns[1] = twice.columns[0].clone();
        assert_eq!(twice.solve(vec![vec![1.0; 10]]), None);
        assert_eq!(powers(3, 5).solve(vec![vec![1.0; 3]]), None);
    }
}
