//! Structures in, structures out: samples are put into arrays a block at a time, traced as those, and their rays put
//! back into structures.
//!
//! A block stays in the first cache. Samples and rays change between structures and arrays four at a time, as 4 x 4
//! matrices transposed in registers; nothing is cleared that is not used, so that few samples cost little.

use std::{array, mem::MaybeUninit, slice};

use glam::Mat4;

use crate::abi::types::{realistic_ray, realistic_sample};
use crate::camera::{RayArrays, Sample, SampleArrays, WorldRay};

/// Samples per block: with their rays and differentials half of a first cache of 32 KiB.
pub(super) const BLOCK: usize = 128;
/// Samples that are transposed at once.
const FOUR: usize = 4;

/// The numbers of samples: image x and y, lens u and v, time.
pub(super) type SampleRoom = Room<5>;
/// The numbers of rays: origin, direction, where each begins and ends, time, weight.
pub(super) type RayRoom = Room<10>;

/// Room for the arrays of a block.
pub(super) struct Room<const ARRAYS: usize> {
    arrays: [[MaybeUninit<f32>; BLOCK]; ARRAYS],
    /// Of each array so many are set: a multiple of four.
    set: usize,
}

impl<const ARRAYS: usize> Room<ARRAYS> {
    /// Room of which nothing is set.
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { arrays: [[MaybeUninit::uninit(); BLOCK]; ARRAYS], set: 0 }
    }

    /// Sets `n` numbers of each array to 0, up to [`BLOCK`].
    #[inline(always)]
    pub(super) fn clear(&mut self, n: usize) {
        let set = n.min(BLOCK).next_multiple_of(FOUR);
        // Written out: few numbers are not worth a call for each array.
        for begin in (0..set).step_by(FOUR) {
            for array in 0..ARRAYS {
                self.set_four(array, begin, [0.0; FOUR]);
            }
        }
        self.set = set;
    }

    /// The first `n` numbers of each array; as many as it was made for, at most.
    #[inline(always)]
    pub(super) fn arrays(&self, n: usize) -> [&[f32]; ARRAYS] {
        let n = n.min(self.set);
        // SAFETY: the first `set` numbers are set.
        self.arrays.each_ref().map(|array| unsafe { slice::from_raw_parts(array.as_ptr().cast(), n) })
    }

    /// [`Room::arrays`] to be written.
    #[inline(always)]
    pub(super) fn arrays_mut(&mut self, n: usize) -> [&mut [f32]; ARRAYS] {
        let n = n.min(self.set);
        // SAFETY: as there.
        self.arrays.each_mut().map(|array| unsafe { slice::from_raw_parts_mut(array.as_mut_ptr().cast(), n) })
    }

    /// Four numbers of an array from the place `begin` on, a multiple of four.
    #[inline(always)]
    fn four(&self, array: usize, begin: usize) -> [f32; FOUR] {
        assert!(begin + FOUR <= self.set && begin <= BLOCK - FOUR);
        // SAFETY: the first `set` numbers are set, a multiple of four.
        array::from_fn(|k| unsafe { self.arrays[array][begin + k].assume_init() })
    }

    /// Sets four numbers of an array from the place `begin` on, a multiple of four.
    #[inline(always)]
    fn set_four(&mut self, array: usize, begin: usize, numbers: [f32; FOUR]) {
        self.arrays[array][begin..begin + FOUR].copy_from_slice(&numbers.map(MaybeUninit::new));
    }
}

impl SampleRoom {
    /// The first `n` samples.
    #[inline(always)]
    pub(super) fn samples(&self, n: usize) -> SampleArrays<'_> {
        let [image_x, image_y, lens_u, lens_v, time] = self.arrays(n);
        SampleArrays { image_x, image_y, lens_u, lens_v, time }
    }
}

impl RayRoom {
    /// The first `n` rays.
    #[inline(always)]
    pub(super) fn rays(&mut self, n: usize) -> RayArrays<'_> {
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] = self.arrays_mut(n);
        let [mint, maxt, time] = [mint, maxt, time].map(Some);
        RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
    }
}

/// Samples as a caller's structures: the first, and the bytes from one to the next.
#[derive(Clone, Copy)]
pub(super) struct SampleStructures {
    pub first: *const realistic_sample,
    pub stride: usize,
}

impl SampleStructures {
    /// Where the sample `i` lies.
    ///
    /// # Safety
    /// There is one.
    #[inline(always)]
    pub(super) unsafe fn at(self, i: usize) -> *const Sample {
        // SAFETY: the caller's promise.
        unsafe { self.first.byte_add(i * self.stride).cast() }
    }

    /// Reads `n` samples from `first` on.
    ///
    /// # Safety
    /// There are so many.
    #[inline(always)]
    pub(super) unsafe fn read(self, first: usize, n: usize, room: &mut SampleRoom) {
        for begin in (0..n).step_by(FOUR) {
            // In the place of samples beyond the last, the last.
            // SAFETY: the caller's promise.
            let four = [0, 1, 2, 3].map(|k| unsafe { self.at(first + (begin + k).min(n - 1)) });
            // SAFETY: as above; a sample begins with these four numbers.
            let rows = four.map(|sample| unsafe { sample.cast::<[f32; 4]>().read_unaligned() });
            // SAFETY: as above.
            let times = four.map(|sample| unsafe { (&raw const (*sample).time).read_unaligned() });
            let [image_x, image_y, lens_u, lens_v] = transposed(rows);
            for (array, numbers) in [image_x, image_y, lens_u, lens_v, times].into_iter().enumerate() {
                room.set_four(array, begin, numbers);
            }
        }
    }
}

/// Rays as a caller's structures: the first, and the bytes from one to the next.
#[derive(Clone, Copy)]
pub(super) struct RayStructures {
    pub first: *mut realistic_ray,
    pub stride: usize,
}

impl RayStructures {
    /// Where the ray `i` lies.
    ///
    /// # Safety
    /// There is room for one.
    #[inline(always)]
    pub(super) unsafe fn at(self, i: usize) -> *mut WorldRay {
        // SAFETY: the caller's promise.
        unsafe { self.first.byte_add(i * self.stride).cast() }
    }

    /// Writes those of the first `n` rays of a block that have a weight, from place `first` on.
    ///
    /// # Safety
    /// There is room for so many.
    #[inline(always)]
    pub(super) unsafe fn write(self, first: usize, n: usize, room: &RayRoom) {
        for begin in (0..n).step_by(FOUR) {
            let [head, tail] = [[0, 1, 2, 3], [4, 5, 6, 7]]
                .map(|arrays| transposed(arrays.map(|array| room.four(array, begin))));
            let [time, weight] = [8, 9].map(|array| room.four(array, begin));
            let put = |k: usize| {
                // SAFETY: the caller's promise; a ray is nine numbers one after the other.
                unsafe {
                    let to = self.at(first + begin + k).cast::<f32>();
                    to.cast::<[f32; 4]>().write_unaligned(head[k]);
                    to.add(4).cast::<[f32; 4]>().write_unaligned(tail[k]);
                    to.add(8).write_unaligned(time[k]);
                }
            };
            if begin + FOUR <= n && weight.iter().all(|&weight| weight > 0.0) {
                // Written out, what was transposed stays in registers.
                (put(0), put(1), put(2), put(3));
            } else {
                (0..FOUR.min(n - begin)).filter(|&k| weight[k] > 0.0).for_each(put);
            }
        }
    }
}

/// The rows of a matrix as its columns.
#[inline(always)]
fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}
