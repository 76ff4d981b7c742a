//! Samples and rays as structure of arrays: a caller's own, one sample's as arrays of one, and blocks of a fixed size.

use std::{array, slice};

use crate::camera::ray::{Sample, WorldRay};

/// Samples that are copied into arrays at once: few enough for the first cache, and a whole number of times three of
/// any vectors.
pub(crate) const BLOCK: usize = 384;

/// Samples, as structure of arrays of one length.
#[derive(Clone, Copy, Debug)]
pub struct SampleArrays<'a> {
    /// Raster x.
    pub image_x: &'a [f32],
    /// Raster y.
    pub image_y: &'a [f32],
    /// Lens samples u.
    pub lens_u: &'a [f32],
    /// Lens samples v.
    pub lens_v: &'a [f32],
    /// Time samples.
    pub time: &'a [f32],
}

impl<'a> SampleArrays<'a> {
    /// Arrays of one.
    #[inline(always)]
    pub(crate) fn of_one(sample: &'a Sample) -> Self {
        let Sample { image_x, image_y, lens_u, lens_v, time } = sample;
        let [image_x, image_y, lens_u, lens_v, time] =
            [image_x, image_y, lens_u, lens_v, time].map(slice::from_ref);
        Self { image_x, image_y, lens_u, lens_v, time }
    }

    /// The number of samples.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub(crate) fn checked_len(&self) -> usize {
        let n = self.image_x.len();
        let same = [self.image_y, self.lens_u, self.lens_v, self.time].iter().all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }

    /// The sample at a place.
    ///
    /// # Panics
    /// There is none.
    #[inline]
    pub fn get(&self, i: usize) -> Sample {
        Sample {
            image_x: self.image_x[i],
            image_y: self.image_y[i],
            lens_u: self.lens_u[i],
            lens_v: self.lens_v[i],
            time: self.time[i],
        }
    }

    /// Those from `first` on, `count` of them.
    ///
    /// # Panics
    /// There are not so many.
    pub fn part(&self, first: usize, count: usize) -> Self {
        let Self { image_x, image_y, lens_u, lens_v, time } = *self;
        let [image_x, image_y, lens_u, lens_v, time] =
            [image_x, image_y, lens_u, lens_v, time].map(|array| &array[first..first + count]);
        Self { image_x, image_y, lens_u, lens_v, time }
    }
}

/// What becomes of samples, as structure of arrays of one length. Where there is no ray only the weight is written.
#[derive(Debug)]
pub struct RayArrays<'a> {
    /// Origins, world units: x, y and z.
    pub origin: [&'a mut [f32]; 3],
    /// Unit directions.
    pub direction: [&'a mut [f32]; 3],
    /// Where each begins, if asked for.
    pub mint: Option<&'a mut [f32]>,
    /// Where each ends, if asked for.
    pub maxt: Option<&'a mut [f32]>,
    /// When each is, if asked for.
    pub time: Option<&'a mut [f32]>,
    /// Weights: positive, or 0 where there is no ray.
    pub weight: &'a mut [f32],
}

impl<'a> RayArrays<'a> {
    /// Arrays of one, for all but its range and time.
    #[inline(always)]
    pub(crate) fn of_one(ray: &'a mut WorldRay, weight: &'a mut f32) -> Self {
        let WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], .. } = ray;
        let [ox, oy, oz, dx, dy, dz, weight] = [ox, oy, oz, dx, dy, dz, weight].map(slice::from_mut);
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        Self { origin, direction, mint: None, maxt: None, time: None, weight }
    }

    /// The number of rays.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub(crate) fn checked_len(&self) -> usize {
        let n = self.weight.len();
        let given = [&self.mint, &self.maxt, &self.time];
        let same = self.origin.iter().chain(&self.direction).all(|array| array.len() == n)
            && given.into_iter().flatten().all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }

    /// One place of all but range and time.
    pub(crate) fn place(&mut self, i: usize) -> RayArrays<'_> {
        RayArrays {
            origin: self.origin.each_mut().map(|array| slice::from_mut(&mut array[i])),
            direction: self.direction.each_mut().map(|array| slice::from_mut(&mut array[i])),
            mint: None,
            maxt: None,
            time: None,
            weight: slice::from_mut(&mut self.weight[i]),
        }
    }

    /// Puts a ray, or none, at a place.
    ///
    /// # Panics
    /// There is no such place.
    #[inline]
    pub fn set(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        let Some((WorldRay { origin, direction, mint, maxt, time }, weight)) = ray else {
            self.weight[i] = 0.0;
            return;
        };
        for axis in 0..3 {
            self.origin[axis][i] = origin[axis];
            self.direction[axis][i] = direction[axis];
        }
        for (array, number) in [(&mut self.mint, mint), (&mut self.maxt, maxt), (&mut self.time, time)] {
            if let Some(array) = array {
                array[i] = number;
            }
        }
        self.weight[i] = weight;
    }
}

/// Up to `N` samples, as structure of arrays.
#[derive(Clone, Debug)]
pub struct SampleBlock<const N: usize>([[f32; N]; 5]);

impl<const N: usize> SampleBlock<N> {
    /// A block of zeros.
    pub const fn new() -> Self {
        Self([[0.0; N]; 5])
    }

    /// Puts a sample at a place.
    ///
    /// # Panics
    /// The place is not below `N`.
    #[inline]
    pub fn set(&mut self, i: usize, sample: &Sample) {
        let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        for (array, number) in self.0.iter_mut().zip([image_x, image_y, lens_u, lens_v, time]) {
            array[i] = number;
        }
    }

    /// The first `n` samples.
    ///
    /// # Panics
    /// `n` is more than `N`.
    pub fn arrays(&self, n: usize) -> SampleArrays<'_> {
        let [image_x, image_y, lens_u, lens_v, time] = self.0.each_ref().map(|array| &array[..n]);
        SampleArrays { image_x, image_y, lens_u, lens_v, time }
    }
}

impl<const N: usize> Default for SampleBlock<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// What becomes of up to `N` samples, as structure of arrays.
#[derive(Clone, Debug)]
pub struct RayBlock<const N: usize>([[f32; N]; 10]);

impl<const N: usize> RayBlock<N> {
    /// A block without rays.
    pub const fn new() -> Self {
        Self([[0.0; N]; 10])
    }

    /// Room for `n` rays.
    ///
    /// # Panics
    /// `n` is more than `N`.
    #[inline(always)]
    pub fn arrays(&mut self, n: usize) -> RayArrays<'_> {
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] =
            self.0.each_mut().map(|array| &mut array[..n]);
        let [mint, maxt, time] = [mint, maxt, time].map(Some);
        RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
    }

    /// Gives every ray this range and time.
    #[inline(always)]
    pub(crate) fn set_range_and_time(&mut self, [mint, maxt]: [f32; 2], time: f32) {
        for (array, number) in self.0[6..9].iter_mut().zip([mint, maxt, time]) {
            *array = [number; N];
        }
    }

    /// The weight at a place: 0 where there is no ray.
    ///
    /// # Panics
    /// The place is not below `N`.
    #[inline(always)]
    pub fn weight(&self, i: usize) -> f32 {
        self.0[9][i]
    }

    /// The ray at a place, with its weight.
    ///
    /// # Panics
    /// The place is not below `N`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let weight = self.weight(i);
        let [origin, direction, [mint, maxt, time]] =
            array::from_fn(|k| [self.0[3 * k][i], self.0[3 * k + 1][i], self.0[3 * k + 2][i]]);
        (weight > 0.0).then_some((WorldRay { origin, direction, mint, maxt, time }, weight))
    }
}

impl<const N: usize> Default for RayBlock<N> {
    fn default() -> Self {
        Self::new()
    }
}
