//! Rays before and behind a lens as callers hold them: structures of arrays of the caller's, arrays of one's own, and
//! one ray.

pub(super) mod batch;

use std::ops::Range;

use crate::{lens::Ray, numeric::Real};

/// Rays that start on a plane across the axis, as structure of arrays of one length: a film's.
#[derive(Clone, Copy, Debug)]
pub struct PlaneRays<'a, S> {
    /// z of the plane in lens space, mm.
    pub plane: f64,
    /// x of each ray on the plane, mm.
    pub x: &'a [S],
    /// y of each ray on the plane, mm.
    pub y: &'a [S],
    /// dx/dz of each ray.
    pub slope_x: &'a [S],
    /// dy/dz of each ray.
    pub slope_y: &'a [S],
}

/// Rays in lens space, as structure of arrays of one length.
#[derive(Debug)]
pub struct LensRays<'a, S> {
    /// A point on each: x, y and z, mm.
    pub origin: [&'a mut [S]; 3],
    /// Their directions.
    pub direction: [&'a mut [S]; 3],
    /// Written only: cos⁴ of the angle between the axis and the ray before the lens, at least the
    /// smallest normal number, for a ray that gets through; 0 for a blocked one.
    pub weight: &'a mut [S],
}

impl<S> PlaneRays<'_, S> {
    /// The number of rays.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub(in crate::trace) fn checked_len(&self) -> usize {
        let n = self.x.len();
        let same = [self.y, self.slope_x, self.slope_y].iter().all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }
}

impl<S> LensRays<'_, S> {
    /// The number of rays.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub(in crate::trace) fn checked_len(&self) -> usize {
        let n = self.weight.len();
        let same = self.origin.iter().chain(&self.direction).all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }
}

/// A ray that got through a lens, in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced<S> {
    /// The point on the last surface, mm.
    pub origin: [S; 3],
    /// The unit direction behind it.
    pub direction: [S; 3],
    /// cos⁴ of the angle between the axis and the ray before the lens; positive.
    pub weight: S,
}

impl<S: Real> Traced<S> {
    /// Of the numbers of origin, direction and weight; `None` for the weight 0, a blocked ray's.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn of([x, y, z, dx, dy, dz, weight]: [S; 7]) -> Option<Self> {
        (weight > S::ZERO).then_some(Self { origin: [x, y, z], direction: [dx, dy, dz], weight })
    }

    /// In double precision.
    pub fn ray(&self) -> Ray {
        Ray { origin: self.origin.map(S::to_f64), direction: self.direction.map(S::to_f64) }
    }
}

/// Room for rays as structure of arrays: x, y, z of origin and direction, and the weight.
#[derive(Clone, Debug)]
pub struct RayBuffer<S>([Vec<S>; 7]);

impl<S: Real> RayBuffer<S> {
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

    /// Takes in another's rays behind its own.
    pub fn append(&mut self, other: Self) {
        for (column, others) in self.0.iter_mut().zip(other.0) {
            if column.is_empty() {
                *column = others;
            } else {
                column.extend(others);
            }
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
