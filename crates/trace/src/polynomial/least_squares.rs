//! Linear least squares by Householder reflections (G. Golub, "Numerical methods for solving linear least squares
//! problems", *Numerische Mathematik* 7, 1965), which lose half as many digits as the normal equations. Columns are
//! added one after another, and a solution for the first columns is available at any time: each order of polynomials
//! continues from the next lower order.

use realistic_simd::{Compiled, Simd};

/// Equations in a triangular form that grows with every column.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    /// The right-hand sides, transformed by every reflection.
    sides: Vec<Vec<f64>>,
    columns: Vec<Column>,
}

/// A column after the reflections of the columns before it. Above the row of the diagonal, it contains entries of the
/// triangle; from that row on, it contains its own reflector.
#[derive(Clone, Debug)]
struct Column {
    numbers: Vec<f64>,
    /// The diagonal entry of the triangle.
    pivot: f64,
    /// Scale of the reflection, which maps x to x - `scale` (v·x) v, where v is the reflector.
    scale: f64,
}

/// Error returned if the columns do not determine the unknowns: a column is a linear combination of others, or there
/// are more columns than equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dependent;

/// Ratio of the remaining length of a column to its original length below which the column counts as a linear
/// combination of others.
const DEPENDENT: f64 = 1e-13;

impl LeastSquares {
    /// Creates equations without columns. All right-hand sides have the same length, the number of equations.
    pub fn new(sides: Vec<Vec<f64>>) -> Self {
        Self { sides, columns: Vec::new() }
    }

    /// Adds a column, with one number for each equation.
    ///
    /// # Errors
    /// Returns an error if the column is a linear combination of the columns before it, or if there are already as many
    /// columns as equations.
    pub fn add(&mut self, mut numbers: Vec<f64>) -> Result<(), Dependent> {
        let row = self.columns.len();
        if row >= numbers.len() {
            return Err(Dependent);
        }
        let whole = dot(&numbers, &numbers).sqrt();
        Simd::best().run(Reflections { columns: &self.columns, first: 0, side: &mut numbers });
        let length = dot(&numbers[row..], &numbers[row..]).sqrt();
        if !(length > DEPENDENT * whole) {
            return Err(Dependent);
        }
        let pivot = -length.copysign(numbers[row]);
        // The reflector overwrites the numbers that its reflection makes zero.
        numbers[row] -= pivot;
        let scale = -1.0 / (pivot * numbers[row]);
        self.columns.push(Column { numbers, pivot, scale });
        for side in &mut self.sides {
            Simd::best().run(Reflections { columns: &self.columns[row..], first: row, side });
        }
        Ok(())
    }

    /// Returns, for each right-hand side, the solution with the first `unknowns` columns that minimises the sum of the
    /// squared residuals.
    ///
    /// # Panics
    /// If there are fewer columns than `unknowns`.
    pub fn solve(&self, unknowns: usize) -> Vec<Vec<f64>> {
        let columns = &self.columns[..unknowns];
        let substitute = |side: &Vec<f64>| {
            let mut solution = side[..unknowns].to_vec();
            for (k, column) in columns.iter().enumerate().rev() {
                solution[k] /= column.pivot;
                let known = solution[k];
                for (other, number) in solution.iter_mut().zip(&column.numbers[..k]) {
                    *other -= number * known;
                }
            }
            solution
        };
        self.sides.iter().map(substitute).collect()
    }
}

/// The reflections of `columns`, the first of which belongs to the row `first`, applied to a right-hand side or to a
/// new column, `side`.
struct Reflections<'a> {
    columns: &'a [Column],
    first: usize,
    side: &'a mut [f64],
}

impl Compiled for Reflections<'_> {
    #[inline(always)]
    fn run(self) {
        for (row, column) in (self.first..).zip(self.columns) {
            let (reflector, side) = (&column.numbers[row..], &mut self.side[row..]);
            let along = column.scale * dot(reflector, side);
            for (number, part) in side.iter_mut().zip(reflector) {
                *number -= along * part;
            }
        }
    }
}

/// Returns the scalar product, summed in a fixed number of parts, so that the compiler can vectorise it.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const PARTS: usize = 16;
    let mut sums = [0.0; PARTS];
    let (whole_a, rest_a) = a.as_chunks::<PARTS>();
    let (whole_b, rest_b) = b.as_chunks::<PARTS>();
    for (a, b) in whole_a.iter().zip(whole_b) {
        for i in 0..PARTS {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns columns with the powers of numbers that are spread over [-1, 1].
    fn powers(rows: usize, columns: i32) -> Vec<Vec<f64>> {
        let at = |row: usize| 2.0 * row as f64 / (rows - 1) as f64 - 1.0;
        (0..columns).map(|column| (0..rows).map(|row| at(row).powi(column)).collect()).collect()
    }

    fn solved(columns: &[Vec<f64>], side: &[f64]) -> Result<LeastSquares, Dependent> {
        let mut equations = LeastSquares::new(vec![side.to_vec()]);
        columns.iter().try_for_each(|column| equations.add(column.clone()))?;
        Ok(equations)
    }

    #[test]
    fn a_polynomial_is_found_again() {
        let known = [0.5, -2.0, 0.0, 3.0, 1.0];
        let columns = powers(40, 5);
        let side: Vec<f64> = (0..40).map(|i| (0..5).map(|j| known[j] * columns[j][i]).sum()).collect();
        let found = solved(&columns, &side).expect("independent columns").solve(5);
        for (a, b) in found[0].iter().zip(known) {
            assert!((a - b).abs() < 1e-13, "{a} is not {b}");
        }
    }

    #[test]
    fn the_residual_is_orthogonal_to_every_column() {
        let columns = powers(30, 6);
        let side: Vec<f64> = (0..30).map(|i| f64::from(i * i % 7)).collect();
        let equations = solved(&columns, &side).expect("independent columns");
        for unknowns in [1, 4, 6] {
            let [solution] = &equations.solve(unknowns)[..] else { panic!("one side") };
            assert_eq!(solution.len(), unknowns);
            let residual: Vec<f64> = (0..30)
                .map(|i| side[i] - (0..unknowns).map(|j| solution[j] * columns[j][i]).sum::<f64>())
                .collect();
            for column in &columns[..unknowns] {
                let product: f64 = residual.iter().zip(column).map(|(a, b)| a * b).sum();
                assert!(product.abs() < 1e-12, "{unknowns} columns: {product}");
            }
        }
    }

    #[test]
    fn dependent_columns_and_too_few_rows_have_no_solution() {
        let mut twice = powers(10, 2);
        twice[1] = twice[0].clone();
        assert_eq!(solved(&twice, &[1.0; 10]).err(), Some(Dependent));
        assert_eq!(solved(&powers(3, 5), &[1.0; 3]).err(), Some(Dependent));
    }
}
