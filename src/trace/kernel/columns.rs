//! Rays behind a lens in arrays of their own.

use std::ops::Range;

use super::{LensRays, Traced};
use crate::trace::Real;

/// Room for rays as structure of arrays: x, y, z of origin and direction, and the weight.
#[derive(Clone, Debug)]
pub struct Columns<S>([Vec<S>; 7]);

impl<S: Real> Columns<S> {
    /// Room for so many rays, all 0.
    pub fn new(count: usize) -> Self {
        Self(std::array::from_fn(|_| vec![S::ZERO; count]))
    }

    /// How many rays.
    pub fn len(&self) -> usize {
        self.0[0].len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sets a ray to be traced in place.
    pub fn put(&mut self, i: usize, origin: [f64; 3], direction: [f64; 3]) {
        for (column, number) in self.0.iter_mut().zip(origin.into_iter().chain(direction)) {
            column[i] = S::from_f64(number);
        }
    }

    /// All of them.
    pub fn rays(&mut self) -> LensRays<'_, S> {
        self.part(0..self.len())
    }

    /// Some of them.
    pub fn part(&mut self, part: Range<usize>) -> LensRays<'_, S> {
        let [x, y, z, dx, dy, dz, weight] = self.0.each_mut().map(|column| &mut column[part.clone()]);
        LensRays { origin: [x, y, z], direction: [dx, dy, dz], weight }
    }

    /// A ray that got through; `None` for a blocked one.
    pub fn get(&self, i: usize) -> Option<Traced<S>> {
        Traced::of(self.0.each_ref().map(|column| column[i]))
    }
}
