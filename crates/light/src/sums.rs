//! Weighted sums of columns of numbers.

use realistic_simd::{Compiled, Simd};

/// Writes the sum of the columns, each multiplied by its share, to `into`.
pub fn mix<'a>(into: &mut Vec<f64>, shares: &[f64], columns: impl Iterator<Item = &'a [f64]>) {
    into.clear();
    for (share, column) in shares.iter().zip(columns) {
        add(into, *share, column);
    }
}

/// Adds a column, multiplied by its share, to a sum; an empty sum counts as 0.
fn add(into: &mut Vec<f64>, share: f64, column: &[f64]) {
    into.resize(column.len(), 0.0);
    Simd::best().run(Add { into, share, column });
}

/// Arguments of [`add`], for the vectorised loop.
struct Add<'a> {
    into: &'a mut [f64],
    share: f64,
    column: &'a [f64],
}

impl Compiled for Add<'_> {
    #[inline(always)]
    fn run(self) {
        for (sum, number) in self.into.iter_mut().zip(self.column) {
            *sum += self.share * number;
        }
    }
}
