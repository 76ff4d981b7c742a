//! Samples and rays block by block: from whatever a caller has into arrays, traced as those, and back.
//!
//! A block stays in the first cache; nothing of it is cleared that is not used, so that few samples cost little.

use std::{mem::MaybeUninit, slice};

use glam::Mat4;

use super::{super::object::Handle, columns::Reasons};
use crate::camera::{Camera, NeighbourArrays, RayArrays, SampleArrays};

/// Samples per block: with their rays and differentials half of a first cache of 32 KiB.
pub(super) const BLOCK: usize = 128;
/// Samples that are transposed at once.
pub(super) const FOUR: usize = 4;

/// The numbers of samples: image x and y, lens u and v, time.
pub(super) type SampleRoom = Room<5>;
/// The numbers of rays: origin, direction, where each begins and ends, time, weight.
pub(super) type RayRoom = Room<10>;
/// The numbers of neighbours: origin, direction, weight.
pub(super) type NeighbourRoom = Room<7>;

/// Room for rays and their neighbours.
pub(super) struct DifferentialRoom {
    pub rays: RayRoom,
    /// To the right, and below.
    pub neighbours: [NeighbourRoom; 2],
}

/// Room for what becomes of a block's samples.
pub(super) trait Outcomes {
    /// Room of which nothing is set.
    fn new() -> Self;
    /// Sets the numbers of `n` outcomes, up to [`BLOCK`]: the range to the camera's, if all its rays have one; the rest to 0.
    fn clear(&mut self, camera: &Camera, n: usize);
    /// Takes what becomes of samples.
    fn trace(&mut self, camera: &Camera, samples: &SampleArrays<'_>);
    /// The weights of `n` samples.
    fn weights(&self, n: usize) -> &[f32];
}

impl Outcomes for RayRoom {
    #[inline(always)]
    fn new() -> Self {
        Room::new()
    }

    #[inline(always)]
    fn clear(&mut self, camera: &Camera, n: usize) {
        let [mint, maxt] = camera.range().unwrap_or_default();
        self.set_all(n, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mint, maxt, 0.0, 0.0]);
    }

    #[inline(always)]
    fn trace(&mut self, camera: &Camera, samples: &SampleArrays<'_>) {
        camera.rays(samples, &mut self.rays(camera, samples.image_x.len()));
    }

    #[inline(always)]
    fn weights(&self, n: usize) -> &[f32] {
        let [.., weights] = self.arrays(n);
        weights
    }
}

impl Outcomes for DifferentialRoom {
    #[inline(always)]
    fn new() -> Self {
        Self { rays: Room::new(), neighbours: [Room::new(), Room::new()] }
    }

    #[inline(always)]
    fn clear(&mut self, camera: &Camera, n: usize) {
        self.rays.clear(camera, n);
        self.neighbours.iter_mut().for_each(|room| room.set_all(n, [0.0; 7]));
    }

    #[inline(always)]
    fn trace(&mut self, camera: &Camera, samples: &SampleArrays<'_>) {
        let n = samples.image_x.len();
        let [mut rx, mut ry] = self.neighbours.each_mut().map(|room| room.neighbours(n));
        camera.ray_differentials(samples, &mut self.rays.rays(camera, n), &mut rx, &mut ry);
    }

    #[inline(always)]
    fn weights(&self, n: usize) -> &[f32] {
        self.rays.weights(n)
    }
}

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

    /// Sets `n` numbers of each array, up to [`BLOCK`]: to these.
    #[inline(always)]
    pub(super) fn set_all(&mut self, n: usize, numbers: [f32; ARRAYS]) {
        let set = n.min(BLOCK).next_multiple_of(FOUR);
        // Written out: few numbers are not worth a call for each array.
        for begin in (0..set).step_by(FOUR) {
            for (array, number) in numbers.into_iter().enumerate() {
                self.set_four(array, begin, [number; FOUR]);
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
    pub(super) fn four(&self, array: usize, begin: usize) -> [f32; FOUR] {
        assert!(begin + FOUR <= self.set && begin <= BLOCK - FOUR);
        // SAFETY: the first `set` numbers are set.
        unsafe { self.arrays[array].as_ptr().add(begin).cast::<[f32; FOUR]>().read_unaligned() }
    }

    /// Four numbers of four arrays each from the place `begin` on, turned: the first of each, the second, and so on.
    #[inline(always)]
    pub(super) fn rows(&self, [a, b, c, d]: [usize; 4], begin: usize) -> [[f32; 4]; FOUR] {
        transposed([self.four(a, begin), self.four(b, begin), self.four(c, begin), self.four(d, begin)])
    }

    /// Sets one number of an array.
    #[inline(always)]
    pub(super) fn set(&mut self, array: usize, place: usize, number: f32) {
        self.arrays[array][place] = MaybeUninit::new(number);
    }

    /// Sets four numbers of an array from the place `begin` on, a multiple of four.
    #[inline(always)]
    pub(super) fn set_four(&mut self, array: usize, begin: usize, numbers: [f32; FOUR]) {
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
    /// The first `n` rays; without a range where that of all rays stands there already.
    #[inline(always)]
    fn rays(&mut self, camera: &Camera, n: usize) -> RayArrays<'_> {
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] = self.arrays_mut(n);
        let has_one = camera.range().is_some();
        let [mint, maxt] = [mint, maxt].map(|array| (!has_one).then_some(array));
        let time = Some(time);
        RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
    }

    /// Whether the four samples from `begin` on all have a ray and lie below `n`.
    #[inline(always)]
    pub(super) fn are_rays(&self, begin: usize, n: usize) -> bool {
        let [a, b, c, d] = self.four(9, begin).map(|weight| weight > 0.0);
        begin + FOUR <= n && (a & b & c & d)
    }
}

impl NeighbourRoom {
    /// The first `n` neighbours.
    #[inline(always)]
    fn neighbours(&mut self, n: usize) -> NeighbourArrays<'_> {
        let [ox, oy, oz, dx, dy, dz, weight] = self.arrays_mut(n);
        NeighbourArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], weight }
    }
}

/// What becomes of `n` samples, block by block: `read` reads samples, `write` takes what became of them.
///
/// # Safety
/// `weights` has room for `n` elements; `reasons` too, or it is NULL.
#[inline(always)]
pub(super) unsafe fn in_blocks<O: Outcomes>(
    handle: &Handle,
    n: usize,
    read: impl Fn(usize, usize, &mut SampleRoom),
    write: impl Fn(usize, usize, &O),
    weights: *mut f32,
    reasons: Reasons,
) {
    let (mut samples, mut outcomes) = (SampleRoom::new(), O::new());
    samples.set_all(n, [0.0; 5]);
    outcomes.clear(handle.camera(), n);
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        read(first, count, &mut samples);
        let asked = samples.samples(count);
        outcomes.trace(handle.camera(), &asked);
        write(first, count, &outcomes);
        let weight = outcomes.weights(count);
        // SAFETY: the caller's promise; weights need not be aligned.
        unsafe {
            weights.add(first).cast::<u8>().copy_from(weight.as_ptr().cast(), size_of_val(weight));
            reasons.give(first, weight, |i| handle.reason(&asked.get(i)));
        }
    }
}

/// The rows of a matrix as its columns.
#[inline(always)]
pub(super) fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}
