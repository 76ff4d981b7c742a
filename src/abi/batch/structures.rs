//! A caller's structures, read into a block's arrays and written from them: four at a time, as 4 x 4 matrices transposed in
//! registers.

use std::{array, mem::offset_of};

use super::{
    super::types::{
        REALISTIC_HAS_RX, REALISTIC_HAS_RY, realistic_ray, realistic_ray_differential, realistic_sample,
    },
    blocks::{DifferentialRoom, FOUR, RayRoom, SampleRoom, transposed},
};
use crate::camera::{Sample, WorldRay};

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
                room.set(array, place, number);
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
