//! A checked request answered. A single ray without wavelength and neighbours is that of a call of its own.
//! Where the numbers of every array lie side by side, times are given and each sample has one ray, rays go
//! straight between the caller's arrays. Else they go in blocks of 128: what does not lie side by side is
//! copied through arrays of our own, and so are samples of several rays each, and times that are left out,
//! which are 0. [`PerRay`] is what any call may request of each ray, one or many: its wavelength, its weight
//! and why it is blocked.

use std::{array, mem::MaybeUninit, slice};

use super::{
    super::{
        boundary::{self, Failure},
        object::Handle,
        types::{realistic_reason, realistic_request},
    },
    strided::{FOUR, Strided, are_row, numbers, read, room, write},
};
use crate::camera::{RayArrays, Sample, SampleArrays, WorldRay};

/// What any call may ask of its rays, for many samples or one.
#[derive(Clone, Copy)]
pub(in super::super) struct PerRay {
    /// So many are the samples' rays together.
    pub rays: usize,
    pub per_sample: usize,
    pub wavelengths: Strided,
    pub weights: Strided,
    pub reasons: Strided<realistic_reason>,
}

impl PerRay {
    /// That of a request for `n` samples.
    ///
    /// # Errors
    /// An array cannot be, or is missing; there is no memory for what a first wavelength builds.
    #[inline(always)]
    pub fn of(request: &realistic_request, handle: &Handle, n: usize) -> Result<Self, Failure> {
        let per_sample = request.wavelengths_per_sample.max(1) as usize;
        let rays = n
            .checked_mul(per_sample)
            .ok_or_else(|| boundary::too_many(n, size_of::<f32>().saturating_mul(per_sample)))?;
        let wavelengths = numbers("wavelength", rays, &request.wavelength)?;
        if wavelengths.is_there() {
            if !handle.camera().is_ready_for_wavelengths() {
                boundary::memory_to_build()?;
            }
        } else if per_sample > 1 {
            return Err(boundary::null("request.wavelength.x"));
        }
        let reasons = if request.reason.is_null() {
            Strided::NONE
        } else {
            Strided::new(["reason", ""], rays, request.reason, request.reason_stride, false)?
        };
        let weights = room("weight", rays, &request.weight)?;
        Ok(Self { rays, per_sample, wavelengths, weights, reasons })
    }
}

impl Strided<realistic_reason> {
    /// Puts why the samples from number `first` on have these weights, if that is asked for; `reason` says it of one that
    /// has no ray. Found out apart, because it costs more than a ray.
    ///
    /// # Safety
    /// There is room for so many.
    #[inline(always)]
    pub(in super::super) unsafe fn give(
        self,
        first: usize,
        weights: &[f32],
        reason: impl Fn(usize) -> realistic_reason,
    ) {
        if !self.is_there() {
            return;
        }
        for (i, weight) in weights.iter().enumerate() {
            let reason = if *weight > 0.0 { realistic_reason::Ok } else { reason(i) };
            // SAFETY: the caller's promise.
            unsafe { self.put(first + i, reason) };
        }
    }
}

/// Rays that are made at once where something is copied: with samples and neighbours they take half of a first
/// cache of 32 KiB.
const BLOCK: usize = 128;

/// A request whose arrays are checked: samples, and room for what becomes of them.
pub(super) struct CheckedRequest<'a> {
    pub handle: &'a Handle,
    /// Image x and y, lens u and v, time. All but the time are there.
    pub samples: [Strided; 5],
    /// Origin, direction, where each ray begins and ends, time. Range and time may be left out.
    pub numbers: [Strided; 9],
    /// Origin, direction and weight of the rays one pixel to the right, and one pixel down.
    pub neighbours: Option<[[Strided; 7]; 2]>,
    /// With weights.
    pub per_ray: PerRay,
}

impl CheckedRequest<'_> {
    /// Writes what becomes of the samples, of which there is one or more.
    ///
    /// # Safety
    /// The numbers that are there are there for each sample, and room for each ray, which nothing else refers to.
    #[inline(always)]
    pub unsafe fn answer(&self) {
        // SAFETY: the caller's promise.
        unsafe {
            if self.per_ray.rays == 1 && !self.per_ray.wavelengths.is_there() && self.neighbours.is_none() {
                self.one();
            } else {
                self.many();
            }
        }
    }

    /// One sample, as a call of its own.
    ///
    /// # Safety
    /// As [`CheckedRequest::answer`].
    #[inline(always)]
    unsafe fn one(&self) {
        let [origin, ..] = self.numbers;
        let mut weight = 0.0;
        // SAFETY: the caller's promise. Rows of numbers are laid out as the structures are.
        unsafe {
            let sample = self.sample(0);
            if are_row(&self.numbers) && origin.is_aligned() {
                let ray = &mut *origin.at(0).cast::<WorldRay>();
                self.handle.camera().trace_one(&sample, ray, &mut weight);
            } else {
                let mut ray = WorldRay::default();
                self.handle.camera().trace_one(&sample, &mut ray, &mut weight);
                if weight > 0.0 {
                    self.put(&ray);
                }
            }
            self.per_ray.weights.put(0, weight);
            self.per_ray.reasons.give(0, &[weight], |_| self.handle.reason(&sample));
        }
    }

    /// Writes the only ray: number by number, as they were just written, for a wider load would wait for them.
    ///
    /// # Safety
    /// As [`CheckedRequest::answer`].
    unsafe fn put(&self, ray: &WorldRay) {
        let WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time } = ray;
        for (to, number) in self.numbers.iter().zip([ox, oy, oz, dx, dy, dz, mint, maxt, time]) {
            if to.is_there() {
                // SAFETY: the caller's promise, and a reference to a number that there is.
                unsafe { to.put(0, (&raw const *number).read_volatile()) };
            }
        }
    }

    /// The sample with this number.
    ///
    /// # Safety
    /// There is one.
    #[inline(always)]
    unsafe fn sample(&self, i: usize) -> Sample {
        let [x, y, u, v, time] = self.samples;
        // SAFETY: the caller's promise.
        unsafe {
            let time = if time.is_there() { time.get(i) } else { 0.0 };
            Sample { image_x: x.get(i), image_y: y.get(i), lens_u: u.get(i), lens_v: v.get(i), time }
        }
    }

    /// # Safety
    /// As [`CheckedRequest::answer`].
    #[inline(always)]
    unsafe fn many(&self) {
        let PerRay { per_sample, wavelengths, weights, .. } = self.per_ray;
        // Loops of their own: chained, they would be a call for each array.
        let are_slices = per_sample == 1
            && self.samples[4].is_there()
            && [wavelengths, weights].iter().all(|numbers| numbers.is_slice_or_none())
            && self.samples.iter().all(|numbers| numbers.is_slice_or_none())
            && self.numbers.iter().all(|numbers| numbers.is_slice_or_none())
            && self.neighbours.iter().flatten().flatten().all(|numbers| numbers.is_slice_or_none());
        // SAFETY: the caller's promise.
        unsafe { if are_slices { self.straight() } else { self.in_blocks() } }
    }

    /// Straight between the caller's arrays, which all are slices.
    ///
    /// # Safety
    /// As [`CheckedRequest::answer`].
    #[inline(never)]
    unsafe fn straight(&self) {
        let PerRay { rays, wavelengths, weights, reasons, .. } = self.per_ray;
        // SAFETY: the caller's promise. Written out: mapped over an array, a lambda is a call for each.
        unsafe {
            let [x, y, u, v, time] = &self.samples;
            let samples = SampleArrays {
                image_x: x.slice(0, rays),
                image_y: y.slice(0, rays),
                lens_u: u.slice(0, rays),
                lens_v: v.slice(0, rays),
                time: time.slice(0, rays),
            };
            let at = if wavelengths.is_there() { Some(wavelengths.slice(0, rays)) } else { None };
            let [ox, oy, oz, dx, dy, dz, mint, maxt, time] = &self.numbers;
            let mut to = RayArrays {
                origin: [ox.slice_mut(0, rays), oy.slice_mut(0, rays), oz.slice_mut(0, rays)],
                direction: [dx.slice_mut(0, rays), dy.slice_mut(0, rays), dz.slice_mut(0, rays)],
                mint: if mint.is_there() { Some(mint.slice_mut(0, rays)) } else { None },
                maxt: if maxt.is_there() { Some(maxt.slice_mut(0, rays)) } else { None },
                time: if time.is_there() { Some(time.slice_mut(0, rays)) } else { None },
                weight: weights.slice_mut(0, rays),
            };
            match &self.neighbours {
                None => self.trace(&samples, at, &mut to, None),
                Some(sides) => {
                    let side = |[ox, oy, oz, dx, dy, dz, weight]: &[Strided; 7]| RayArrays {
                        origin: [ox, oy, oz].map(|numbers| numbers.slice_mut(0, rays)),
                        direction: [dx, dy, dz].map(|numbers| numbers.slice_mut(0, rays)),
                        mint: None,
                        maxt: None,
                        time: None,
                        weight: weight.slice_mut(0, rays),
                    };
                    self.trace(&samples, at, &mut to, Some(&mut sides.each_ref().map(side)));
                }
            }
            self.give_reasons(0, to.weight, &samples, at, reasons);
        }
    }

    /// Block by block through arrays of our own, where what is no slice is copied.
    ///
    /// # Safety
    /// As [`CheckedRequest::answer`].
    #[inline(never)]
    unsafe fn in_blocks(&self) {
        let PerRay { rays, reasons, .. } = self.per_ray;
        let block = BLOCK.min(rays);
        let range = self.handle.camera().range();
        let [mint, maxt] = range.unwrap_or_default();
        let mut asked = [[MaybeUninit::uninit(); BLOCK]; 6];
        let (mut found, mut beside) = (Copies::new(), [Copies::new(), Copies::new()]);
        found.set_all(block, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mint, maxt, 0.0, 0.0]);
        if self.neighbours.is_some() {
            beside.iter_mut().for_each(|copies| copies.set_all(block, [0.0; 7]));
        }
        for first in (0..rays).step_by(block) {
            let count = block.min(rays - first);
            // SAFETY: the caller's promise; copies have as many numbers.
            unsafe {
                let (samples, at) = self.asked(first, count, &mut asked);
                let mut to = self.found(first, count, &mut found, range.is_some());
                match &self.neighbours {
                    None => self.trace(&samples, at, &mut to, None),
                    Some([rx, ry]) => {
                        let [copies_x, copies_y] = &mut beside;
                        let mut sides =
                            [neighbours(rx, first, count, copies_x), neighbours(ry, first, count, copies_y)];
                        self.trace(&samples, at, &mut to, Some(&mut sides));
                    }
                }
                let passed = self.write(first, count, &found, &beside);
                self.give_reasons(first, passed, &samples, at, reasons);
            }
        }
    }

    /// Has the camera make the rays.
    #[inline(always)]
    fn trace(
        &self,
        samples: &SampleArrays<'_>,
        wavelengths: Option<&[f32]>,
        to: &mut RayArrays<'_>,
        sides: Option<&mut [RayArrays<'_>; 2]>,
    ) {
        let camera = self.handle.camera();
        match (sides, wavelengths) {
            (None, None) => camera.rays(samples, to),
            (None, Some(at)) => camera.rays_at(samples, at, to),
            (Some([rx, ry]), None) => camera.ray_differentials(samples, to, rx, ry),
            (Some([rx, ry]), Some(at)) => camera.ray_differentials_at(samples, at, to, rx, ry),
        }
    }

    /// Puts why the samples from number `first` on have these weights, if that is asked for.
    ///
    /// # Safety
    /// There is room for so many.
    #[inline(always)]
    unsafe fn give_reasons(
        &self,
        first: usize,
        weights: &[f32],
        samples: &SampleArrays<'_>,
        wavelengths: Option<&[f32]>,
        reasons: Strided<realistic_reason>,
    ) {
        let reason = |i: usize| match wavelengths {
            Some(at) => self.handle.reason_at(&samples.get(i), at[i]),
            None => self.handle.reason(&samples.get(i)),
        };
        // SAFETY: the caller's promise.
        unsafe { reasons.give(first, weights, reason) };
    }

    /// The samples and wavelengths of `count` rays from number `first` on: the caller's slices, or copies.
    ///
    /// # Safety
    /// As [`CheckedRequest::answer`], and `count` is at most [`BLOCK`] unless all are slices.
    #[inline(always)]
    unsafe fn asked<'s>(
        &self,
        first: usize,
        count: usize,
        copies: &'s mut [Column; 6],
    ) -> (SampleArrays<'s>, Option<&'s [f32]>) {
        let PerRay { per_sample, wavelengths, .. } = self.per_ray;
        let [x, y, u, v, time] = self.samples;
        let [to_x, to_y, to_u, to_v, to_time, to_wavelengths] =
            copies.each_mut().map(|copy| &mut copy[..count.min(BLOCK)]);
        // SAFETY: the caller's promise; a column is lent only where `read` or `fill` has written its first `count` numbers:
        // of what is no slice, or is shared.
        unsafe {
            if time.is_there() {
                read(&self.samples, per_sample, first, [to_x, to_y, to_u, to_v, to_time]);
            } else {
                to_time.fill(MaybeUninit::new(0.0));
                read(&[x, y, u, v], per_sample, first, [to_x, to_y, to_u, to_v]);
            }
            if wavelengths.is_there() {
                read(&[wavelengths], 1, first, [to_wavelengths]);
            }
            let lent = |numbers: Strided, copy: &'s Column, shared_by: usize| {
                if numbers.is_slice() && numbers.is_there() && shared_by == 1 {
                    numbers.slice(first, count)
                } else {
                    slice::from_raw_parts(copy[..count].as_ptr().cast(), count)
                }
            };
            let [image_x, image_y, lens_u, lens_v, time] =
                array::from_fn(|k| lent(self.samples[k], &copies[k], per_sample));
            let at = wavelengths.is_there().then(|| lent(wavelengths, &copies[5], 1));
            (SampleArrays { image_x, image_y, lens_u, lens_v, time }, at)
        }
    }

    /// Room for `count` rays from number `first` on: the caller's slices, or copies, in which the range of all rays stands
    /// already if they have one.
    ///
    /// # Safety
    /// As [`CheckedRequest::asked`].
    #[inline(always)]
    unsafe fn found<'s>(
        &self,
        first: usize,
        count: usize,
        copies: &'s mut Copies<10>,
        has_one_range: bool,
    ) -> RayArrays<'s> {
        let mut copies = copies.arrays_mut(count).into_iter();
        // SAFETY: the caller's promise.
        let mut lent = |numbers: Strided| unsafe { numbers.lent(first, count, copies.next()) };
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time] = self.numbers.map(&mut lent);
        let weight = lent(self.per_ray.weights);
        let [mint, maxt, time] = [(6, mint), (7, maxt), (8, time)].map(|(k, array)| {
            let numbers = self.numbers[k];
            let is_set = k < 8 && has_one_range && !numbers.is_slice();
            (numbers.is_there() && !is_set).then_some(array)
        });
        RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time, weight }
    }

    /// Copies to the caller what is not written there yet; the weights.
    ///
    /// # Safety
    /// As [`CheckedRequest::asked`].
    #[inline(always)]
    unsafe fn write<'s>(
        &self,
        first: usize,
        count: usize,
        found: &'s Copies<10>,
        beside: &[Copies<7>; 2],
    ) -> &'s [f32] {
        let found = found.arrays(count);
        // SAFETY: the caller's promise.
        unsafe {
            let weights = self.per_ray.weights.filled(first, count, found[9]);
            write(&self.numbers, first, &found[..9], weights);
            for (neighbours, found) in self.neighbours.iter().flatten().zip(beside) {
                let found = found.arrays(count);
                write(&neighbours[..6], first, &found[..6], weights);
                neighbours[6].filled(first, count, found[6]);
            }
            weights
        }
    }
}

/// Room for `count` neighbours from number `first` on: the caller's slices, or copies.
///
/// # Safety
/// As [`CheckedRequest::asked`].
#[inline(always)]
unsafe fn neighbours<'s>(
    numbers: &[Strided; 7],
    first: usize,
    count: usize,
    copies: &'s mut Copies<7>,
) -> RayArrays<'s> {
    let mut copies = copies.arrays_mut(count).into_iter();
    // SAFETY: the caller's promise.
    let [ox, oy, oz, dx, dy, dz, weight] =
        numbers.map(|numbers| unsafe { numbers.lent(first, count, copies.next()) });
    RayArrays { origin: [ox, oy, oz], direction: [dx, dy, dz], mint: None, maxt: None, time: None, weight }
}

impl Strided {
    #[inline(always)]
    fn is_aligned(self) -> bool {
        self.at(0).is_aligned()
    }

    /// Room for `count` numbers from number `first` on: the caller's where it is a slice, else the copies.
    ///
    /// # Safety
    /// As [`CheckedRequest::asked`].
    #[inline(always)]
    unsafe fn lent(self, first: usize, count: usize, copies: Option<&mut [f32]>) -> &mut [f32] {
        if self.is_slice() && self.is_there() {
            // SAFETY: the caller's promise.
            unsafe { self.slice_mut(first, count) }
        } else {
            copies.unwrap_or_default()
        }
    }

    /// Writes all of `count` numbers from number `first` on, unless they are in their place; they themselves.
    ///
    /// # Safety
    /// As [`CheckedRequest::asked`].
    #[inline(always)]
    unsafe fn filled(self, first: usize, count: usize, copies: &[f32]) -> &[f32] {
        // SAFETY: the caller's promise.
        unsafe {
            if self.is_slice() {
                return self.slice(first, count);
            }
            copies.iter().enumerate().for_each(|(i, number)| self.put(first + i, *number));
        }
        copies
    }
}

/// A copy of a block's numbers of one kind.
type Column = [MaybeUninit<f32>; BLOCK];

/// Copies of a block's numbers, in arrays. Nothing of them is cleared that is not used, so that few samples cost little.
struct Copies<const ARRAYS: usize> {
    arrays: [Column; ARRAYS],
    /// Of each array so many are set.
    set: usize,
}

impl<const ARRAYS: usize> Copies<ARRAYS> {
    /// Arrays of which nothing is set. Not a constant: that would be copied, kilobytes of it.
    #[inline(always)]
    fn new() -> Self {
        // SAFETY: an array of numbers that may be unset needs none set.
        Self { arrays: unsafe { MaybeUninit::uninit().assume_init() }, set: 0 }
    }

    /// Sets `n` numbers of each array, up to [`BLOCK`], to these.
    #[inline(always)]
    fn set_all(&mut self, n: usize, numbers: [f32; ARRAYS]) {
        self.set = n.min(BLOCK);
        // Four at a time, written out: few numbers are not worth a call for each array.
        for begin in (0..self.set).step_by(FOUR) {
            for (array, number) in self.arrays.iter_mut().zip(numbers) {
                array[begin..begin + FOUR].copy_from_slice(&[MaybeUninit::new(number); FOUR]);
            }
        }
    }

    /// The first `n` numbers of each array; as many as are set, at most.
    #[inline(always)]
    fn arrays(&self, n: usize) -> [&[f32]; ARRAYS] {
        let n = n.min(self.set);
        // SAFETY: the first `set` numbers are set.
        self.arrays.each_ref().map(|array| unsafe { slice::from_raw_parts(array.as_ptr().cast(), n) })
    }

    /// [`Copies::arrays`] to be written.
    #[inline(always)]
    fn arrays_mut(&mut self, n: usize) -> [&mut [f32]; ARRAYS] {
        let n = n.min(self.set);
        // SAFETY: as there.
        self.arrays.each_mut().map(|array| unsafe { slice::from_raw_parts_mut(array.as_mut_ptr().cast(), n) })
    }
}
