//! Blocks of scene points, directions toward the lens and importance, as structures of arrays. The steps from
//! a point to its [`Aimed`](super::Aimed) pass these blocks on and process them in lanes.

use std::ops::{Deref, DerefMut};

use super::{FilmWe, Importance};
use crate::vectors::in_vectors;
use realistic_optics::lens::Ray;
use realistic_simd::{Available, Cpu, Lanes};
use realistic_trace::kernel::{Grouping, InVectors, RayBuffer};

/// Number of points or rays per block; their columns fit in the first-level cache.
pub const BLOCK: usize = 128;

/// A step that processes all points of a block, one vector after the other.
pub(super) trait BlockStep {
    /// Number of points.
    fn len(&self) -> usize;
    /// Processes the vector of points from index `at` on.
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize);
    /// Processes all points.
    fn take(&mut self, simd: Available)
    where
        Self: Sized,
    {
        in_vectors(simd, Grouping::Wide, &mut EachVector(self));
    }
}

/// Adapter that presents a step as work in vectors.
struct EachVector<'s, S>(&'s mut S);

impl<S: BlockStep> InVectors<f64> for EachVector<'_, S> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.0.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = f64>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        for u in 0..count {
            self.0.vector::<L>(cpu, first + u * L::WIDTH);
        }
    }
}

/// `N` columns of numbers, one number per point or ray, in one allocation.
pub struct PointColumns<const N: usize> {
    numbers: Vec<f64>,
    count: usize,
}

impl<const N: usize> PointColumns<N> {
    /// Returns columns of zeros.
    pub fn new(count: usize) -> Self {
        Self { numbers: vec![0.0; N * count], count }
    }

    /// Returns all columns for reading.
    pub fn each(&self) -> [&[f64]; N] {
        std::array::from_fn(|k| self.column(k))
    }

    /// Returns one column for reading.
    pub fn column(&self, k: usize) -> &[f64] {
        &self.numbers[k * self.count..(k + 1) * self.count]
    }

    /// Returns all columns for writing.
    pub fn each_mut(&mut self) -> [&mut [f64]; N] {
        let mut rest = self.numbers.as_mut_slice();
        std::array::from_fn(|_| {
            let (column, others) = std::mem::take(&mut rest).split_at_mut(self.count);
            rest = others;
            column
        })
    }

    /// Sets the numbers of point `i`.
    pub fn put(&mut self, i: usize, numbers: [f64; N]) {
        for (k, number) in numbers.into_iter().enumerate() {
            self.numbers[k * self.count + i] = number;
        }
    }
}

/// Loads one vector from each column. Like all code that passes vectors on, this is a loop, not a closure.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn load<L: Lanes<Scalar = f64>, C: Deref<Target = [f64]>, const N: usize>(
    cpu: Cpu<L>,
    columns: &[C; N],
    at: usize,
) -> [L; N] {
    let mut vectors = [L::splat(cpu, 0.0); N];
    let mut k = 0;
    while k < N {
        vectors[k] = L::load(cpu, &columns[k][at..]);
        k += 1;
    }
    vectors
}

/// Stores one vector in each column ([`Lanes::store`]).
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn store<L: Lanes<Scalar = f64>, C: DerefMut<Target = [f64]>, const N: usize>(
    vectors: [L; N],
    columns: &mut [C; N],
    at: usize,
) {
    let mut k = 0;
    while k < N {
        vectors[k].store(&mut columns[k][at..]);
        k += 1;
    }
}

/// Rays toward the lens and their importance; in camera space until the last step transforms them to the
/// world.
pub struct ArrivingRays {
    /// The point where each ray meets the front of the lens, the ray's unit direction, and the density of
    /// that direction per solid angle at the scene point; the density is 0 if there is no direction.
    pub toward_lens: PointColumns<7>,
    /// The traced rays, which are overwritten by their importance: the raster coordinates and the weight
    /// replace the origin, and the density replaces the direction's x. The weight is 0 for a ray without
    /// importance.
    pub traced: RayBuffer<f64>,
}

impl ArrivingRays {
    /// Allocates `count` rays.
    pub fn new(count: usize) -> Self {
        Self { toward_lens: PointColumns::new(count), traced: RayBuffer::new(count) }
    }

    /// Returns the columns of [`Importance`] in the order of its fields, for rays in the world.
    pub fn importance_columns(&self) -> [&[f64]; 6] {
        let [x, y, importance, density, area_density, solid_angle_density, _] = self.traced.columns();
        [x, y, importance, density, area_density, solid_angle_density]
    }

    /// Returns the importance of a ray in the world.
    pub fn importance(&self, i: usize) -> Importance {
        let [x, y, importance, density, area_density, solid_angle_density] =
            self.importance_columns().map(|column| column[i]);
        Importance { raster: [x, y], importance, density, area_density, solid_angle_density }
    }

    /// Sets direction `i` and the importance of its ray. `ray` begins at the front of the lens and has a unit
    /// direction; `density` is per solid angle at the scene point.
    pub fn put(&mut self, i: usize, ray: &Ray, density: f64, we: Option<FilmWe>) {
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        self.toward_lens.put(i, [x, y, z, dx, dy, dz, density]);
        self.put_we(i, we);
    }

    /// Sets the importance of a ray; for `None`, sets it to 0.
    pub(crate) fn put_we(&mut self, i: usize, we: Option<FilmWe>) {
        let FilmWe { raster: [x, y], weight, density } = we.unwrap_or_default();
        self.traced.put(i, [x, y, weight], [density, 0.0, 0.0]);
    }
}
