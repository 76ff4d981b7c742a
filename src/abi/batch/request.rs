//! What a caller asks of many samples, number by number in columns, and its answer: straight between the caller's arrays
//! where all numbers lie side by side, block by block through rooms of our own where they do not.

use std::array;

use super::{
    super::{
        boundary::{Failure, memory},
        object::Handle,
        types::{realistic_rays_soa, realistic_samples_soa},
    },
    arrays::{ray_columns, sample_columns},
    blocks::{BLOCK, DifferentialRoom, NeighbourRoom, Outcomes, RayRoom, SampleRoom},
    columns::{Column, ColumnMut, Reasons},
};
use crate::camera::{NeighbourArrays, RayArrays, Sample, SampleArrays, WorldRay};

/// Where the weight stands among the numbers of a ray, and of a neighbour.
const WEIGHT: usize = 9;
const NEIGHBOURS_WEIGHT: usize = 6;

/// Samples, and room for what becomes of them.
pub(super) struct Request<'a> {
    pub handle: &'a Handle,
    /// Samples.
    pub n: usize,
    /// Image x and y, lens u and v, time.
    pub samples: [Column; 5],
    /// nm; `None` for the camera's own.
    pub wavelengths: Option<Column>,
    /// Origin, direction, where each begins and ends, time, weight. Range and time may be left out.
    pub rays: [ColumnMut; 10],
    /// Origin, direction and weight of the rays one pixel to the right, and one pixel down, if asked for.
    pub neighbours: Option<[[ColumnMut; 7]; 2]>,
    pub reasons: Reasons,
}

impl<'a> Request<'a> {
    /// Of samples and rays in a caller's arrays.
    pub(super) fn of_arrays(
        handle: &'a Handle,
        n: usize,
        samples: &realistic_samples_soa,
        rays: &realistic_rays_soa,
    ) -> Self {
        Self {
            handle,
            n,
            samples: sample_columns(samples),
            wavelengths: None,
            rays: ray_columns(rays),
            neighbours: None,
            reasons: Reasons::packed(rays.reason),
        }
    }

    /// Answers it.
    ///
    /// # Errors
    /// Memory is out, where a first request for wavelengths builds something.
    ///
    /// # Safety
    /// Each column has `n` numbers, or is room for as many that nothing else refers to; columns that must be there are.
    pub(super) unsafe fn answer(&self) -> Result<(), Failure> {
        if self.n == 0 {
            return Ok(());
        }
        if self.wavelengths.is_some() && !self.handle.camera().is_ready_for_wavelengths() {
            memory::to_build()?;
        }
        // SAFETY: the caller's promise.
        unsafe {
            if self.n == 1 && self.wavelengths.is_none() && self.neighbours.is_none() {
                self.one();
            } else {
                self.many();
            }
        }
        Ok(())
    }

    /// The sample at a place.
    ///
    /// # Safety
    /// As [`Request::answer`].
    unsafe fn sample(&self, i: usize) -> Sample {
        // SAFETY: the caller's promise.
        let [image_x, image_y, lens_u, lens_v, time] = self.samples.map(|column| unsafe { column.number(i) });
        Sample { image_x, image_y, lens_u, lens_v, time }
    }

    /// One sample, as a call of its own.
    ///
    /// # Safety
    /// As [`Request::answer`].
    unsafe fn one(&self) {
        let (mut ray, mut weight) = (WorldRay::default(), 0.0);
        // SAFETY: the caller's promise.
        unsafe {
            let sample = self.sample(0);
            self.handle.camera().trace_one(&sample, &mut ray, &mut weight);
            self.rays[WEIGHT].put(0, weight);
            if weight > 0.0 {
                // Number by number, as they were just written: a wider load would wait for them.
                for axis in 0..3 {
                    self.rays[axis].put(0, (&raw const ray.origin[axis]).read_volatile());
                    self.rays[3 + axis].put(0, (&raw const ray.direction[axis]).read_volatile());
                }
                for (column, number) in self.rays[6..9].iter().zip([ray.mint, ray.maxt, ray.time]) {
                    if column.is_there() {
                        column.put(0, number);
                    }
                }
            }
            self.reasons.give(0, &[weight], |_| self.handle.reason(&sample));
        }
    }

    /// # Safety
    /// As [`Request::answer`].
    unsafe fn many(&self) {
        let camera = self.handle.camera();
        let are_slices = self.samples.iter().chain(&self.wavelengths).all(|column| column.is_slice())
            && self
                .rays
                .iter()
                .chain(self.neighbours.iter().flatten().flatten())
                .all(|column| column.is_slice());
        let (mut samples, mut wavelengths, mut rooms) =
            (SampleRoom::new(), [0.0; BLOCK], DifferentialRoom::new());
        let mut block = self.n;
        if !are_slices {
            block = BLOCK;
            samples.set_all(self.n, [0.0; 5]);
            rooms.rays.clear(camera, self.n);
            if self.neighbours.is_some() {
                rooms.neighbours.iter_mut().for_each(|room| room.set_all(self.n, [0.0; 7]));
            }
        }
        for first in (0..self.n).step_by(block) {
            let count = block.min(self.n - first);
            // SAFETY: the caller's promise.
            unsafe {
                let asked = self.asked(first, count, &mut samples);
                let at = self.wavelengths.map(|column| match column.is_slice() {
                    true => column.slice(first, count),
                    false => {
                        column.read(first, &mut wavelengths[..count]);
                        &wavelengths[..count]
                    }
                });
                let mut rays = self.found(first, count, &mut rooms.rays);
                match (&self.neighbours, at) {
                    (Some([rx, ry]), at) => {
                        let [room_x, room_y] = &mut rooms.neighbours;
                        let (mut rx, mut ry) =
                            (found_beside(rx, first, count, room_x), found_beside(ry, first, count, room_y));
                        match at {
                            Some(at) => {
                                camera.ray_differentials_at(&asked, at, &mut rays, &mut rx, &mut ry);
                            }
                            None => camera.ray_differentials(&asked, &mut rays, &mut rx, &mut ry),
                        }
                    }
                    (None, Some(at)) => camera.rays_at(&asked, at, &mut rays),
                    (None, None) => camera.rays(&asked, &mut rays),
                }
                let weights = self.write(first, count, &rooms);
                self.reasons.give(first, weights, |i| match at {
                    Some(at) => self.handle.reason_at(&asked.get(i), at[i]),
                    None => self.handle.reason(&asked.get(i)),
                });
            }
        }
    }

    /// A block's samples: the caller's slices, or copies in a room.
    ///
    /// # Safety
    /// As [`Request::answer`]; the room is clear unless all columns are slices.
    unsafe fn asked<'s>(&self, first: usize, count: usize, room: &'s mut SampleRoom) -> SampleArrays<'s> {
        let [x, y, u, v, time] = self.samples;
        let [to_x, to_y, to_u, to_v, to_time] = room.arrays_mut(count);
        // SAFETY: the caller's promise.
        unsafe {
            Column::read_two([x, y], first, [to_x, to_y]);
            Column::read_two([u, v], first, [to_u, to_v]);
            if !time.is_slice() {
                time.read(first, to_time);
            }
            let copies = room.arrays(count);
            let [image_x, image_y, lens_u, lens_v, time] = array::from_fn(|k| match self.samples[k] {
                column if column.is_slice() => column.slice(first, count),
                _ => copies[k],
            });
            SampleArrays { image_x, image_y, lens_u, lens_v, time }
        }
    }

    /// Room for a block's rays: the caller's slices, or our own. Without a range where that of all rays stands in our own
    /// already.
    ///
    /// # Safety
    /// As [`Request::asked`].
    unsafe fn found<'s>(&self, first: usize, count: usize, room: &'s mut RayRoom) -> RayArrays<'s> {
        let has_one_range = self.handle.camera().range().is_some();
        let mut own = room.arrays_mut(count).into_iter();
        // SAFETY: the caller's promise.
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] = self.rays.map(|column| {
            let own = own.next().unwrap_or_default();
            if column.is_slice() && column.is_there() { unsafe { column.slice(first, count) } } else { own }
        });
        let [mint, maxt, time] = [(6, mint), (7, maxt), (8, time)].map(|(k, array)| {
            let column = self.rays[k];
            let is_set = k < 8 && has_one_range && !column.is_slice();
            (column.is_there() && !is_set).then_some(array)
        });
        RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
    }

    /// Copies what stands in our own rooms to the caller; the block's weights.
    ///
    /// # Safety
    /// As [`Request::asked`].
    unsafe fn write<'s>(&self, first: usize, count: usize, rooms: &'s DifferentialRoom) -> &'s [f32] {
        let numbers = rooms.rays.arrays(count);
        // SAFETY: the caller's promise.
        unsafe {
            let weights = match self.rays[WEIGHT] {
                column if column.is_slice() => &*column.slice(first, count),
                column => {
                    column.write_all(first, numbers[WEIGHT]);
                    numbers[WEIGHT]
                }
            };
            write_numbers(&self.rays[..WEIGHT], first, &numbers, weights);
            for (columns, room) in self.neighbours.iter().flatten().zip(&rooms.neighbours) {
                let numbers = room.arrays(count);
                write_numbers(&columns[..NEIGHBOURS_WEIGHT], first, &numbers, weights);
                if !columns[NEIGHBOURS_WEIGHT].is_slice() {
                    columns[NEIGHBOURS_WEIGHT].write_all(first, numbers[NEIGHBOURS_WEIGHT]);
                }
            }
            weights
        }
    }
}

/// Room for a block's neighbours: the caller's slices, or our own.
///
/// # Safety
/// As [`Request::asked`].
unsafe fn found_beside<'s>(
    columns: &[ColumnMut; 7],
    first: usize,
    count: usize,
    room: &'s mut NeighbourRoom,
) -> NeighbourArrays<'s> {
    let mut own = room.arrays_mut(count).into_iter();
    // SAFETY: the caller's promise.
    let [ox, oy, oz, dx, dy, dz, weight] = columns.map(|column| {
        let own = own.next().unwrap_or_default();
        if column.is_slice() { unsafe { column.slice(first, count) } } else { own }
    });
    NeighbourArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], weight }
}

/// Copies numbers of our own room to columns that are no slices, of rays with a weight.
///
/// # Safety
/// As [`Request::asked`].
unsafe fn write_numbers(columns: &[ColumnMut], first: usize, numbers: &[&[f32]], weights: &[f32]) {
    for (column, numbers) in columns.iter().zip(numbers) {
        if column.is_there() && !column.is_slice() {
            // SAFETY: the caller's promise.
            unsafe { column.write(first, numbers, weights) };
        }
    }
}
