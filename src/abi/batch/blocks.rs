//! Structures in, structures out: samples are put into arrays a block at a time, traced as those, and their rays put
//! back into structures.
//!
//! A block stays in the first cache. Samples and rays change between structures and arrays four at a time, as 4 x 4
//! matrices transposed in registers; nothing is cleared that is not used, so that few samples cost little.

use std::{
    array,
    mem::{MaybeUninit, offset_of},
    slice,
};

use glam::Mat4;

use super::super::{
    object::Handle,
    types::{
        REALISTIC_HAS_RX, REALISTIC_HAS_RY, realistic_ray, realistic_ray_differential, realistic_reason,
        realistic_sample,
    },
};
use crate::camera::{Camera, NeighbourArrays, RayArrays, Sample, SampleArrays, WorldRay};

/// Samples per block: with their rays and differentials half of a first cache of 32 KiB.
pub(super) const BLOCK: usize = 128;
/// Samples that are transposed at once.
const FOUR: usize = 4;

/// The numbers of samples: image x and y, lens u and v, time.
pub(super) type SampleRoom = Room<5>;
/// The numbers of rays: origin, direction, where each begins and ends, time, weight.
pub(super) type RayRoom = Room<10>;
/// The numbers of neighbours: origin, direction, weight.
type NeighbourRoom = Room<7>;

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
    /// Sets the numbers of `n` outcomes to 0, up to [`BLOCK`].
    fn clear(&mut self, n: usize);
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
    fn clear(&mut self, n: usize) {
        Room::clear(self, n);
    }

    #[inline(always)]
    fn trace(&mut self, camera: &Camera, samples: &SampleArrays<'_>) {
        camera.rays(samples, &mut self.rays(samples.image_x.len()));
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
    fn clear(&mut self, n: usize) {
        self.rays.clear(n);
        self.neighbours.iter_mut().for_each(|room| room.clear(n));
    }

    #[inline(always)]
    fn trace(&mut self, camera: &Camera, samples: &SampleArrays<'_>) {
        let n = samples.image_x.len();
        let [mut rx, mut ry] = self.neighbours.each_mut().map(|room| room.neighbours(n));
        camera.ray_differentials(samples, &mut self.rays.rays(n), &mut rx, &mut ry);
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
        // SAFETY: the first `set` numbers are set.
        unsafe { self.arrays[array].as_ptr().add(begin).cast::<[f32; FOUR]>().read_unaligned() }
    }

    /// Four numbers of four arrays each from the place `begin` on, turned: the first of each, the second, and so on.
    #[inline(always)]
    fn rows(&self, [a, b, c, d]: [usize; 4], begin: usize) -> [[f32; 4]; FOUR] {
        transposed([self.four(a, begin), self.four(b, begin), self.four(c, begin), self.four(d, begin)])
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

impl RayRoom {
    /// Whether the four samples from `begin` on all have a ray and lie below `n`.
    #[inline(always)]
    fn are_rays(&self, begin: usize, n: usize) -> bool {
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
    reasons: *mut realistic_reason,
) {
    let (mut samples, mut outcomes) = (SampleRoom::new(), O::new());
    samples.clear(n);
    outcomes.clear(n);
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
            let reasons = if reasons.is_null() { reasons } else { reasons.add(first) };
            give_reasons(handle, reasons, |i| (asked.get(i), weight[i]), count);
        }
    }
}

/// Why samples have the weights that they have, where a caller asks. Found out apart, because it costs more than a ray.
///
/// # Safety
/// `reasons` is NULL or has room for `n` elements.
pub(super) unsafe fn give_reasons(
    handle: &Handle,
    reasons: *mut realistic_reason,
    of: impl Fn(usize) -> (Sample, f32),
    n: usize,
) {
    if reasons.is_null() {
        return;
    }
    for i in 0..n {
        let (sample, weight) = of(i);
        let reason = if weight > 0.0 { realistic_reason::Ok } else { handle.reason(&sample) };
        // SAFETY: the caller's promise.
        unsafe { reasons.add(i).write_unaligned(reason) };
    }
}

/// Copies `count` samples from `first` on out of arrays that nothing aligns.
///
/// # Safety
/// There are so many in each array.
pub(super) unsafe fn read_columns(from: [*const f32; 5], first: usize, count: usize, room: &mut SampleRoom) {
    for (from, to) in from.iter().zip(room.arrays_mut(count)) {
        for (i, number) in to.iter_mut().enumerate() {
            // SAFETY: the caller's promise.
            *number = unsafe { from.add(first + i).read_unaligned() };
        }
    }
}

/// Copies columns to arrays that nothing aligns, from place `first` on, where there is a weight; to none that is NULL.
///
/// # Safety
/// Each array that is not NULL has room for so many.
pub(super) unsafe fn write_columns(to: &[*mut f32], first: usize, columns: &[&[f32]], weight: &[f32]) {
    for (to, from) in to.iter().zip(columns).filter(|(to, _)| !to.is_null()) {
        for (i, number) in from.iter().enumerate().filter(|(i, _)| weight[*i] > 0.0) {
            // SAFETY: the caller's promise.
            unsafe { to.add(first + i).write_unaligned(*number) };
        }
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
        let whole = n - n % FOUR;
        for begin in (0..whole).step_by(FOUR) {
            // SAFETY: the caller's promise; a sample begins with the four numbers that are turned.
            unsafe {
                let a = self.at(first + begin);
                let (b, c, d) =
                    (a.byte_add(self.stride), a.byte_add(2 * self.stride), a.byte_add(3 * self.stride));
                let row = |sample: *const Sample| sample.cast::<[f32; 4]>().read_unaligned();
                let time = |sample: *const Sample| (&raw const (*sample).time).read_unaligned();
                let [image_x, image_y, lens_u, lens_v] = transposed([row(a), row(b), row(c), row(d)]);
                room.set_four(0, begin, image_x);
                room.set_four(1, begin, image_y);
                room.set_four(2, begin, lens_u);
                room.set_four(3, begin, lens_v);
                room.set_four(4, begin, [time(a), time(b), time(c), time(d)]);
            }
        }
        for place in whole..n {
            // SAFETY: the caller's promise.
            let sample = unsafe { self.at(first + place).read_unaligned() };
            let Sample { image_x, image_y, lens_u, lens_v, time } = sample;
            for (array, number) in [image_x, image_y, lens_u, lens_v, time].into_iter().enumerate() {
                room.arrays[array][place] = MaybeUninit::new(number);
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
            if !room.are_rays(begin, n) {
                // SAFETY: the caller's promise.
                unsafe { self.write_some(first, begin, n, room) };
                continue;
            }
            let (head, tail, time) =
                (room.rows([0, 1, 2, 3], begin), room.rows([4, 5, 6, 7], begin), room.four(8, begin));
            let put = |k: usize, [head, tail]: [[f32; 4]; 2], time: f32| {
                // SAFETY: the caller's promise; a ray is nine numbers one after the other.
                unsafe {
                    let to = self.at(first + begin + k).cast::<f32>();
                    to.cast::<[f32; 4]>().write_unaligned(head);
                    to.add(4).cast::<[f32; 4]>().write_unaligned(tail);
                    to.add(8).write_unaligned(time);
                }
            };
            put(0, [head[0], tail[0]], time[0]);
            put(1, [head[1], tail[1]], time[1]);
            put(2, [head[2], tail[2]], time[2]);
            put(3, [head[3], tail[3]], time[3]);
        }
    }

    /// Writes those of four rays that there are. Apart, so that where there are all, what was turned stays in registers.
    ///
    /// # Safety
    /// There is room for them.
    #[inline(never)]
    unsafe fn write_some(self, first: usize, begin: usize, n: usize, room: &RayRoom) {
        let numbers: [[f32; FOUR]; 10] = array::from_fn(|array| room.four(array, begin));
        for k in (0..FOUR.min(n - begin)).filter(|&k| numbers[9][k] > 0.0) {
            let [ray @ .., _] = numbers.map(|numbers| numbers[k]);
            // SAFETY: the caller's promise; a ray is nine numbers one after the other.
            unsafe { self.at(first + begin + k).cast::<[f32; 9]>().write_unaligned(ray) };
        }
    }
}

/// Rays with differentials as a caller's structures: the first, and the bytes from one to the next.
#[derive(Clone, Copy)]
pub(super) struct DifferentialStructures {
    pub first: *mut realistic_ray_differential,
    pub stride: usize,
}

// What is written as rows of four.
const _: () = {
    assert!(offset_of!(realistic_ray_differential, rx_o) == offset_of!(realistic_ray_differential, ray) + 36);
    assert!(
        offset_of!(realistic_ray_differential, rx_d) == offset_of!(realistic_ray_differential, rx_o) + 12
    );
    assert!(
        offset_of!(realistic_ray_differential, ry_o) == offset_of!(realistic_ray_differential, rx_o) + 24
    );
    assert!(
        offset_of!(realistic_ray_differential, ry_d) == offset_of!(realistic_ray_differential, rx_o) + 36
    );
};

impl DifferentialStructures {
    /// The rays, without their neighbours.
    ///
    /// # Safety
    /// There is room for one.
    unsafe fn rays(self) -> RayStructures {
        // SAFETY: the caller's promise.
        RayStructures { first: unsafe { &raw mut (*self.first).ray }, stride: self.stride }
    }

    /// Writes those of the first `n` rays of a block that have a weight with their neighbours, from place `first` on.
    ///
    /// # Safety
    /// There is room for so many.
    #[inline(always)]
    pub(super) unsafe fn write(self, first: usize, n: usize, room: &DifferentialRoom) {
        let DifferentialRoom { rays, neighbours: [rx, ry] } = room;
        // SAFETY: the caller's promise.
        unsafe { self.rays().write(first, n, rays) };
        for begin in (0..n).step_by(FOUR) {
            let head = rx.rows([0, 1, 2, 3], begin);
            let middle =
                transposed([rx.four(4, begin), rx.four(5, begin), ry.four(0, begin), ry.four(1, begin)]);
            let tail = ry.rows([2, 3, 4, 5], begin);
            let (rx, ry, weight) = (rx.four(6, begin), ry.four(6, begin), rays.four(9, begin));
            for k in 0..FOUR {
                if begin + k < n && weight[k] > 0.0 {
                    let has =
                        u32::from(rx[k] > 0.0) * REALISTIC_HAS_RX + u32::from(ry[k] > 0.0) * REALISTIC_HAS_RY;
                    // SAFETY: the caller's promise; the neighbours are twelve numbers one after the other.
                    unsafe {
                        let to = self.first.byte_add((first + begin + k) * self.stride);
                        (&raw mut (*to).has).write_unaligned(has);
                        let to = (&raw mut (*to).rx_o).cast::<f32>();
                        to.cast::<[f32; 4]>().write_unaligned(head[k]);
                        to.add(4).cast::<[f32; 4]>().write_unaligned(middle[k]);
                        to.add(8).cast::<[f32; 4]>().write_unaligned(tail[k]);
                    }
                }
            }
        }
    }
}

/// The rows of a matrix as its columns.
#[inline(always)]
fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}
