//! Samples and rays as structure of arrays: a caller's own, blocks of a fixed size, and one sample's as arrays of one.
//!
//! Lanes load and store all three by [`SampleStore`] and [`RayStore`]; where the number is known when the library is
//! compiled, no length is checked.

use std::{array, slice};

use crate::{
    camera::ray::{Sample, WorldRay},
    trace::{
        Real,
        kernel::{Cpu, Lanes},
    },
};

/// Samples that are copied into arrays at once: few enough for the first cache, and a whole number of groups of four of
/// any vectors.
pub(crate) const BLOCK: usize = 384;

/// Samples that lanes load.
pub(crate) trait SampleStore {
    /// How many there are.
    fn len(&self) -> usize;
    /// Image x and y, lens u and v, time: one of these five.
    fn array(&self, number: usize) -> &[f32];
    /// All of them.
    #[inline(always)]
    fn as_arrays(&self) -> SampleArrays<'_> {
        let [image_x, image_y, lens_u, lens_v, time] = array::from_fn(|number| self.array(number));
        SampleArrays { image_x, image_y, lens_u, lens_v, time }
    }
    /// The sample at an index.
    #[inline(always)]
    fn sample(&self, i: usize) -> Sample {
        let [image_x, image_y, lens_u, lens_v, time] = array::from_fn(|number| self.array(number)[i]);
        Sample { image_x, image_y, lens_u, lens_v, time }
    }
}

/// Room for rays that lanes store.
pub(crate) trait RayStore {
    /// Origin's and direction's x, y and z, weight: one of these seven.
    fn array(&mut self, number: usize) -> &mut [f32];
    /// Where rays begin and end, where that is asked for.
    fn range(&mut self) -> [Option<&mut [f32]>; 2];
    /// All of it, but for times.
    fn as_arrays(&mut self) -> RayArrays<'_>;
    /// Writes a vector of rays from index `at` on: the last step of all lanes, of whatever model. A ray that is none,
    /// by `passed` or by its numbers ([`WorldRay::is_sound`]), has weight 0, and nothing else of it is written. `range`
    /// where each ray has its own.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store<L: Lanes>(
        &mut self,
        cpu: Cpu<L>,
        at: usize,
        [origin, direction]: [[L; 3]; 2],
        range: Option<[L; 2]>,
        weight: L,
        passed: L::Mask,
    ) {
        let most = L::splat(cpu, L::Scalar::from_f64(f32::MAX.into()));
        let [u, v, w] = direction;
        let square = w.mul_add(w, v.mul_add(v, u * u));
        let off = (square - L::splat(cpu, L::Scalar::ONE)).abs();
        let is_unit = off.less(L::splat(cpu, L::Scalar::from_f64(WorldRay::UNIT.into())));
        let [x, y, z] = origin;
        let is_finite = (x.abs() + y.abs() + z.abs()).less_equal(most);
        let mut passed = L::both(passed, L::both(is_unit, is_finite));
        if let Some([first, last]) = range {
            // In this order an end that is no number stays that.
            passed = L::both(passed, first.less_equal(most.smaller(last)));
        }
        weight.or_zero(passed).store_single(&mut self.array(6)[at..]);
        for axis in 0..3 {
            put(origin[axis], passed, &mut self.array(axis)[at..]);
            put(direction[axis], passed, &mut self.array(3 + axis)[at..]);
        }
        if let Some([first, last]) = range {
            let [to_first, to_last] = self.range();
            if let Some(to_first) = to_first {
                put(first, passed, &mut to_first[at..]);
            }
            if let Some(to_last) = to_last {
                put(last, passed, &mut to_last[at..]);
            }
        }
    }
    /// Copies origin, direction and weight of a ray from another store, where it has just been written, number by number
    /// (a wider load would wait for it); of none, the weight 0 alone.
    #[inline(always)]
    fn copy(&mut self, i: usize, from: &mut impl RayStore, k: usize) {
        let weight = from.array(6)[k];
        self.array(6)[i] = weight;
        if weight > 0.0 {
            for number in 0..6 {
                self.array(number)[i] = from.array(number)[k];
            }
        }
    }
    /// Puts origin, direction and weight of a ray at an index; of none, the weight 0 alone.
    fn put(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        if let Some((WorldRay { origin, direction, .. }, _)) = ray {
            for axis in 0..3 {
                self.array(axis)[i] = origin[axis];
                self.array(3 + axis)[i] = direction[axis];
            }
        }
        self.array(6)[i] = ray.map_or(0.0, |(_, weight)| weight);
    }
}

/// Writes the numbers of rays.
#[cfg_attr(not(debug_assertions), inline(always))]
fn put<L: Lanes>(numbers: L, passed: L::Mask, to: &mut [f32]) {
    if L::all(passed) {
        numbers.store_single(to);
    } else {
        numbers.store_single_where(passed, to);
    }
}

impl SampleStore for Sample {
    #[inline(always)]
    fn len(&self) -> usize {
        1
    }

    #[inline(always)]
    fn array(&self, number: usize) -> &[f32] {
        let Self { image_x, image_y, lens_u, lens_v, time } = self;
        slice::from_ref([image_x, image_y, lens_u, lens_v, time][number])
    }
}

/// Room for one ray, of which the time is not the lanes' business.
pub(crate) struct OneRay<'a> {
    pub ray: &'a mut WorldRay,
    pub weight: &'a mut f32,
}

impl RayStore for OneRay<'_> {
    #[inline(always)]
    fn array(&mut self, number: usize) -> &mut [f32] {
        slice::from_mut(match number {
            0..3 => &mut self.ray.origin[number],
            3..6 => &mut self.ray.direction[number - 3],
            _ => self.weight,
        })
    }

    #[inline(always)]
    fn range(&mut self) -> [Option<&mut [f32]>; 2] {
        [Some(slice::from_mut(&mut self.ray.mint)), Some(slice::from_mut(&mut self.ray.maxt))]
    }

    #[inline(always)]
    fn as_arrays(&mut self) -> RayArrays<'_> {
        let WorldRay { origin, direction, mint, maxt, .. } = &mut *self.ray;
        let [origin, direction] = [origin, direction].map(|axes| axes.each_mut().map(slice::from_mut));
        let [mint, maxt] = [mint, maxt].map(|end| Some(slice::from_mut(end)));
        RayArrays { origin, direction, mint, maxt, time: None, weight: slice::from_mut(self.weight) }
    }
}

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

impl SampleArrays<'_> {
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

    /// The sample at an index.
    ///
    /// # Panics
    /// There is none.
    #[inline]
    pub fn get(&self, i: usize) -> Sample {
        self.sample(i)
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

impl RayArrays<'_> {
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

    /// Puts a ray, or none, at an index.
    ///
    /// # Panics
    /// There is no such index.
    #[inline]
    pub fn set(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        self.put(i, ray);
        let Some((WorldRay { mint, maxt, time, .. }, _)) = ray else { return };
        for (array, number) in [(&mut self.mint, mint), (&mut self.maxt, maxt), (&mut self.time, time)] {
            if let Some(array) = array {
                array[i] = number;
            }
        }
    }
}

impl SampleStore for SampleArrays<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.image_x.len()
    }

    #[inline(always)]
    fn array(&self, number: usize) -> &[f32] {
        [self.image_x, self.image_y, self.lens_u, self.lens_v, self.time][number]
    }
}

impl RayStore for RayArrays<'_> {
    #[inline(always)]
    fn array(&mut self, number: usize) -> &mut [f32] {
        match number {
            0..3 => self.origin[number],
            3..6 => self.direction[number - 3],
            _ => self.weight,
        }
    }

    #[inline(always)]
    fn range(&mut self) -> [Option<&mut [f32]>; 2] {
        [self.mint.as_deref_mut(), self.maxt.as_deref_mut()]
    }

    #[inline(always)]
    fn as_arrays(&mut self) -> RayArrays<'_> {
        let Self { origin, direction, mint, maxt, weight, .. } = self;
        RayArrays {
            origin: origin.each_mut().map(|axis| &mut **axis),
            direction: direction.each_mut().map(|axis| &mut **axis),
            mint: mint.as_deref_mut(),
            maxt: maxt.as_deref_mut(),
            time: None,
            weight,
        }
    }
}

/// The first `N` numbers of one or more; beyond the last number, the last.
#[inline(always)]
pub(super) fn padded<const N: usize>(numbers: &[f32]) -> [f32; N] {
    array::from_fn(|i| numbers[i.min(numbers.len() - 1)])
}

/// Up to `N` samples, as structure of arrays.
#[derive(Clone, Debug)]
pub struct SampleBlock<const N: usize>([[f32; N]; 5]);

impl<const N: usize> SampleBlock<N> {
    /// A block of zeros.
    pub const fn new() -> Self {
        Self([[0.0; N]; 5])
    }

    /// As many of these samples as there is room for, one or more; beyond them the last.
    pub(crate) fn first_of(samples: &SampleArrays<'_>) -> Self {
        Self(array::from_fn(|number| padded(samples.array(number))))
    }

    /// Puts a sample at an index.
    ///
    /// # Panics
    /// The index is not below `N`.
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

impl<const N: usize> From<[[f32; N]; 5]> for SampleBlock<N> {
    /// Image x and y, lens u and v, time.
    #[inline(always)]
    fn from(arrays: [[f32; N]; 5]) -> Self {
        Self(arrays)
    }
}

impl<const N: usize> SampleStore for SampleBlock<N> {
    #[inline(always)]
    fn len(&self) -> usize {
        N
    }

    #[inline(always)]
    fn array(&self, number: usize) -> &[f32] {
        &self.0[number]
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
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] =
            self.0.each_mut().map(|array| &mut array[..n]);
        let [mint, maxt, time] = [mint, maxt, time].map(Some);
        RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
    }

    /// Gives every ray this range.
    #[inline(always)]
    pub(crate) fn set_range(&mut self, range: [f32; 2]) {
        for (array, number) in self.0[7..9].iter_mut().zip(range) {
            *array = [number; N];
        }
    }

    /// Gives every ray this time.
    #[inline(always)]
    pub(crate) fn set_time(&mut self, time: f32) {
        self.0[9] = [time; N];
    }

    /// The weight at an index: 0 where there is no ray.
    ///
    /// # Panics
    /// The index is not below `N`.
    #[inline(always)]
    pub fn weight(&self, i: usize) -> f32 {
        self.0[6][i]
    }

    /// The ray at an index, with its weight.
    ///
    /// # Panics
    /// The index is not below `N`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let weight = self.weight(i);
        let [origin, direction, [mint, maxt, time]] =
            [0, 3, 7].map(|first: usize| array::from_fn(|k| self.0[first + k][i]));
        (weight > 0.0).then_some((WorldRay { origin, direction, mint, maxt, time }, weight))
    }
}

impl<const N: usize> RayStore for RayBlock<N> {
    #[inline(always)]
    fn array(&mut self, number: usize) -> &mut [f32] {
        &mut self.0[number]
    }

    #[inline(always)]
    fn range(&mut self) -> [Option<&mut [f32]>; 2] {
        let [.., mint, maxt, _] = &mut self.0;
        [Some(mint), Some(maxt)]
    }

    #[inline(always)]
    fn as_arrays(&mut self) -> RayArrays<'_> {
        self.arrays(N)
    }
}

impl<const N: usize> Default for RayBlock<N> {
    fn default() -> Self {
        Self::new()
    }
}
