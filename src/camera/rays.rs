//! Samples and rays: one of them, laid out as a pbrt-v1 host's own, and columns of them.

use std::{
    array,
    marker::PhantomData,
    mem::{offset_of, size_of},
    ptr, slice,
};

use glam::Vec4;

use super::columns::{Columns, Strided, are_positive, read, write};
use crate::{
    numeric::Real,
    trace::{
        Blocked,
        kernel::{Cpu, Lanes},
    },
};

/// A sample of a picture. Laid out as the first members of a pbrt-v1 host's own sample.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Raster x, pixels, growing to the right; may lie outside the raster.
    pub image_x: f32,
    /// Raster y, pixels, growing downward; may lie outside the raster.
    pub image_y: f32,
    /// Lens sample u, in [0, 1].
    pub lens_u: f32,
    /// Lens sample v, in [0, 1].
    pub lens_v: f32,
    /// Time sample, in [0, 1].
    pub time: f32,
}

/// A ray in world space. Laid out as a pbrt-v1 host's own ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldRay {
    /// Origin, world units.
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// Where along the ray it begins.
    pub mint: f32,
    /// Where along the ray it ends.
    pub maxt: f32,
    /// Time.
    pub time: f32,
}

impl WorldRay {
    /// How far from 1 the square of a direction's length may be: lengths are 1 to 1e-6 then, for the square is off by three
    /// roundings.
    pub(crate) const UNIT: f32 = 1.6e-6;

    /// Whether these are a ray's numbers: a finite origin, a unit direction. Those of image points that are none, or far
    /// out of any image, are not.
    pub(crate) fn is_sound(&self) -> bool {
        let [x, y, z] = self.direction;
        (x * x + y * y + z * z - 1.0).abs() < Self::UNIT && self.origin.iter().all(|part| part.is_finite())
    }
}

/// A ray and its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDifferential {
    /// The ray of the sample.
    pub ray: WorldRay,
    /// The ray of image x + 1; `None` where the lens blocks it.
    pub rx: Option<WorldRay>,
    /// The ray of image y + 1; `None` where the lens blocks it.
    pub ry: Option<WorldRay>,
}

/// What becomes of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// A ray and its weight, positive.
    Ray(WorldRay, f32),
    /// The lens blocks it: weight 0.
    Blocked(Blocked),
    /// The lens sample fell outside the disk ([`DiskMapping::Rejection`](crate::sampling::DiskMapping::Rejection)): ask
    /// with a new one.
    Redraw,
    /// The shutter is closed over the film point at this time: weight 0.
    Shut,
    /// The wavelength asked for is none, or one at which the lens has no index: weight 0.
    Wavelength,
}

/// Samples as columns: image x and y, lens u and v, time, each a slice or a member of structures; and, where rays have
/// wavelengths of their own, those: one per sample, or `k` per sample, which then has `k` rays.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    source: SampleSource<'a>,
    /// Rays of each sample.
    per_sample: usize,
    rays: usize,
    /// Whether each column is a slice, with a number per ray.
    are_slices: bool,
    lent: PhantomData<&'a [f32]>,
}

/// One sample, perhaps with its wavelength, or columns of members and wavelengths.
#[derive(Clone, Copy, Debug)]
enum SampleSource<'a> {
    One(&'a Sample, Option<&'a f32>),
    Columns([Strided; 6]),
}

/// The offsets of a sample's members.
const MEMBERS: [usize; 5] = [
    offset_of!(Sample, image_x),
    offset_of!(Sample, image_y),
    offset_of!(Sample, lens_u),
    offset_of!(Sample, lens_v),
    offset_of!(Sample, time),
];
/// The column of wavelengths.
pub(crate) const WAVELENGTH: usize = 5;

impl<'a> Samples<'a> {
    /// One sample.
    #[inline(always)]
    pub fn of(sample: &'a Sample) -> Self {
        Self {
            source: SampleSource::One(sample, None),
            per_sample: 1,
            rays: 1,
            are_slices: true,
            lent: PhantomData,
        }
    }

    /// Samples as structures.
    #[inline(always)]
    pub fn structs(samples: &'a [Sample]) -> Self {
        let first = samples.as_ptr();
        let mut columns = [Strided::NONE; 6];
        for (column, offset) in columns.iter_mut().zip(MEMBERS) {
            let member = first.wrapping_byte_add(offset).cast::<f32>().cast_mut();
            *column = Strided::new(member, size_of::<Sample>() as isize);
        }
        let are_slices = samples.len() == 1;
        Self {
            source: SampleSource::Columns(columns),
            per_sample: 1,
            rays: samples.len(),
            are_slices,
            lent: PhantomData,
        }
    }

    /// Samples as slices: image x and y, lens u and v, time.
    ///
    /// # Panics
    /// The slices differ in length.
    #[inline(always)]
    pub fn columns(slices: [&'a [f32]; 5]) -> Self {
        let rays = slices[0].len();
        let mut columns = [Strided::NONE; 6];
        for (column, slice) in columns.iter_mut().zip(slices) {
            assert_eq!(slice.len(), rays, "the columns of samples must have one length");
            *column = Strided::new(slice.as_ptr().cast_mut(), size_of::<f32>() as isize);
        }
        Self {
            source: SampleSource::Columns(columns),
            per_sample: 1,
            rays,
            are_slices: true,
            lent: PhantomData,
        }
    }

    /// The samples at wavelengths, nm: `k` per sample, those of the first sample first.
    ///
    /// # Panics
    /// There are not as many for each sample.
    #[inline(always)]
    pub fn at(self, wavelengths: &'a [f32]) -> Self {
        if let (SampleSource::One(sample, _), [wavelength]) = (self.source, wavelengths) {
            return Self { source: SampleSource::One(sample, Some(wavelength)), ..self };
        }
        let samples = self.rays / self.per_sample;
        let per_sample = wavelengths.len() / samples.max(1);
        assert!(
            per_sample * samples == wavelengths.len() && (per_sample > 0 || samples == 0),
            "as many wavelengths for each sample"
        );
        let mut columns = self.all();
        columns[WAVELENGTH] = Strided::new(wavelengths.as_ptr().cast_mut(), size_of::<f32>() as isize);
        let are_slices = self.are_slices && per_sample == 1;
        let (per_sample, rays) = (per_sample.max(1), wavelengths.len());
        Self { source: SampleSource::Columns(columns), per_sample, rays, are_slices, lent: PhantomData }
    }

    /// The samples at wavelengths, nm, if there are any: `per_sample` of them each.
    ///
    /// # Safety
    /// As many wavelengths can be read for `'a`.
    #[inline(always)]
    pub(crate) unsafe fn raw_at(self, wavelengths: Strided, per_sample: usize) -> Self {
        if let (SampleSource::One(sample, _), 1, true) = (self.source, per_sample, wavelengths.is_slice(1)) {
            // SAFETY: the caller's promise; it is aligned.
            let wavelength = unsafe { wavelengths.at(0).as_ref() };
            return Self { source: SampleSource::One(sample, wavelength), ..self };
        }
        let [x, y, u, v, time, _] = self.all();
        // SAFETY: the columns are these; the caller's promise.
        unsafe { Self::raw([x, y, u, v, time, wavelengths], per_sample, self.rays * per_sample) }
    }

    /// Columns of samples, and of wavelengths, which may be missing, of which each sample has `per_sample`.
    ///
    /// # Safety
    /// `rays / per_sample` numbers of each column, and `rays` wavelengths, can be read for `'a`.
    #[inline(always)]
    pub(crate) unsafe fn raw(columns: [Strided; 6], per_sample: usize, rays: usize) -> Self {
        let mut are_slices = per_sample == 1;
        for column in columns {
            are_slices &= !column.is_there() || column.is_slice(rays);
        }
        Self { source: SampleSource::Columns(columns), per_sample, rays, are_slices, lent: PhantomData }
    }

    /// The number of rays.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.rays
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.rays == 0
    }

    /// The columns: the members of a sample, and wavelengths, which may be missing.
    #[inline(always)]
    fn all(&self) -> [Strided; 6] {
        match self.source {
            SampleSource::Columns(columns) => columns,
            SampleSource::One(sample, wavelength) => {
                let member = |offset| {
                    Strided::new(ptr::from_ref(sample).wrapping_byte_add(offset).cast::<f32>().cast_mut(), 0)
                };
                let [x, y, u, v, time] = MEMBERS.map(member);
                let first = |number: &f32| ptr::from_ref(number).cast_mut();
                [x, y, u, v, time, Strided::new(wavelength.map_or(ptr::null_mut(), first), 0)]
            }
        }
    }

    /// The sample of a ray.
    ///
    /// # Panics
    /// There is no such ray.
    pub fn get(&self, ray: usize) -> Sample {
        assert!(ray < self.rays, "no such ray");
        let [x, y, u, v, time, _] = self.all();
        // SAFETY: there are so many samples.
        let [image_x, image_y, lens_u, lens_v, time] =
            [x, y, u, v, time].map(|column| unsafe { column.get(ray / self.per_sample) });
        Sample { image_x, image_y, lens_u, lens_v, time }
    }

    /// The wavelength of a ray, nm; `None` where it is the camera's own.
    ///
    /// # Panics
    /// There is no such ray.
    pub fn wavelength(&self, ray: usize) -> Option<f32> {
        assert!(ray < self.rays, "no such ray");
        // SAFETY: there are so many wavelengths.
        self.have_wavelengths().then(|| unsafe { self.all()[WAVELENGTH].get(ray) })
    }

    /// Whether rays have wavelengths of their own.
    #[inline(always)]
    pub(crate) fn have_wavelengths(&self) -> bool {
        match &self.source {
            SampleSource::One(_, wavelength) => wavelength.is_some(),
            SampleSource::Columns(columns) => columns[WAVELENGTH].is_there(),
        }
    }

    /// Whether each column that is there is a slice, with a number per ray.
    #[inline(always)]
    pub(crate) fn are_slices(&self) -> bool {
        self.are_slices
    }

    /// A column that is there: image x and y, lens u and v, time, wavelengths.
    ///
    /// # Panics
    /// It is no slice.
    #[inline(always)]
    pub(crate) fn column(&self, number: usize) -> &[f32] {
        // Not a copy of all columns: their addresses, just stored one by one, would be waited for.
        let first = match &self.source {
            SampleSource::Columns(columns) => columns[number].at(0),
            SampleSource::One(..) => self.all()[number].at(0),
        };
        assert!(self.are_slices && !first.is_null(), "a column that is no slice");
        // SAFETY: a slice of so many numbers, by what made this.
        unsafe { slice::from_raw_parts(first, self.rays) }
    }

    /// A vector of a column's numbers, from ray `at` on.
    ///
    /// # Panics
    /// The columns are no slices, or end before.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn load<L: Lanes>(&self, cpu: Cpu<L>, number: usize, at: usize) -> L {
        // One lane of one sample, of which nothing is to be found out.
        if let (1, SampleSource::One(sample, wavelength)) = (L::WIDTH, self.source) {
            let Sample { image_x, image_y, lens_u, lens_v, time } = sample;
            let wavelength = wavelength.unwrap_or(image_x);
            let numbers = [image_x, image_y, lens_u, lens_v, time, wavelength];
            return L::load_single(cpu, slice::from_ref(numbers[number]));
        }
        L::load_single(cpu, &self.column(number)[at..])
    }

    /// The sample of one ray, with its wavelength.
    #[inline(always)]
    pub(crate) fn part(&self, ray: usize) -> Self {
        assert!(ray < self.rays, "no such ray");
        let all = self.all();
        let mut columns = all.map(|column| column.from(ray / self.per_sample));
        columns[WAVELENGTH] = all[WAVELENGTH].from(ray);
        // SAFETY: as these, of which it is one.
        unsafe { Self::raw(columns, 1, 1) }
    }

    /// The samples with another column in the place of one of the five.
    ///
    /// # Panics
    /// The columns are no slices, or this one has another length.
    #[inline(always)]
    pub(crate) fn with_column<'b>(&self, number: usize, column: &'b [f32]) -> Samples<'b>
    where
        'a: 'b,
    {
        assert!(self.are_slices && column.len() == self.rays, "columns that are slices of one length");
        let mut columns = self.all();
        columns[number] = Strided::new(column.as_ptr().cast_mut(), size_of::<f32>() as isize);
        Samples { source: SampleSource::Columns(columns), lent: PhantomData, ..*self }
    }

    /// Copies what the rays from `first` on need: image x and y, lens u and v, time, wavelength or 0.
    pub(crate) fn copy(&self, first: usize, to: &mut [&mut [f32]; 6]) {
        assert!(first + to[0].len() <= self.rays, "fewer rays than that");
        // SAFETY: there are so many.
        unsafe {
            if self.per_sample == 1 {
                return read(&self.all(), first, to);
            }
            let columns = self.all();
            for (column, to) in columns[..WAVELENGTH].iter().zip(&mut *to) {
                (first..).zip(to.iter_mut()).for_each(|(i, to)| *to = column.get(i / self.per_sample));
            }
            read(&[columns[WAVELENGTH]], first, array::from_mut(&mut to[WAVELENGTH]));
        }
    }
}

/// Numbers of a ray: origin, direction, range, time, as in a [`WorldRay`], and weight.
const NUMBERS: usize = 10;
/// The first of the columns that may be missing: those of the range, then the time's.
pub(crate) const RANGE: usize = 6;
/// The column of times.
pub(crate) const TIME: usize = 8;
/// The column of weights.
pub(crate) const WEIGHT: usize = 9;

/// Room for rays as columns, each a slice or a member of structures: origins and unit directions in world units, weights;
/// where they are asked for, the range and the time of each, and the rays of the neighbouring pixels.
///
/// Where there is no ray only the weight 0 is written. Where a neighbour is missing its weight is 0, and the ray's own origin and
/// direction are written in its place; where the ray itself is missing, only the neighbour's weight 0.
#[derive(Debug)]
pub struct Rays<'a> {
    room: Room<'a>,
    /// Those of the neighbours, without ranges and times.
    neighbours: Option<[[Strided; NUMBERS]; 2]>,
    count: usize,
    /// Whether each column that is there is a slice.
    are_slices: bool,
    lent: PhantomData<&'a mut [f32]>,
}

/// Room for one ray and its weight, or columns.
#[derive(Debug)]
enum Room<'a> {
    One { ray: &'a mut WorldRay, weight: &'a mut f32 },
    Columns([Strided; NUMBERS]),
}

impl<'a> Rays<'a> {
    /// Room for one ray, of which everything is asked for, and its weight.
    #[inline(always)]
    pub fn of(ray: &'a mut WorldRay, weight: &'a mut f32) -> Self {
        Self {
            room: Room::One { ray, weight },
            neighbours: None,
            count: 1,
            are_slices: true,
            lent: PhantomData,
        }
    }

    /// The columns, of which those from the range on may be missing.
    #[inline(always)]
    fn all(&mut self) -> [Strided; NUMBERS] {
        match &mut self.room {
            Room::Columns(columns) => *columns,
            Room::One { ray, weight } => {
                let WorldRay { origin: [x, y, z], direction: [dx, dy, dz], mint, maxt, time } = &mut **ray;
                [x, y, z, dx, dy, dz, mint, maxt, time, &mut **weight]
                    .map(|number| Strided::new(ptr::from_mut(number), 0))
            }
        }
    }

    /// Room for rays as structures, and their weights.
    ///
    /// # Panics
    /// There are not as many of both.
    pub fn structs(rays: &'a mut [WorldRay], weights: &'a mut [f32]) -> Self {
        assert_eq!(rays.len(), weights.len(), "a weight for each ray");
        let count = rays.len();
        // SAFETY: there are so many of both, lent for as long.
        unsafe { Self::raw_structs(rays.as_mut_ptr(), lent(weights, count), count) }
    }

    /// Room for rays as structures, and for their weights.
    ///
    /// # Safety
    /// `count` of both can be read and written for `'a`, and nothing else refers to them.
    #[inline(always)]
    pub(crate) unsafe fn raw_structs(rays: *mut WorldRay, weights: Strided, count: usize) -> Self {
        let member = |offset: usize| {
            Strided::new(rays.wrapping_byte_add(offset).cast::<f32>(), size_of::<WorldRay>() as isize)
        };
        let number = size_of::<f32>();
        let [o, d] = [offset_of!(WorldRay, origin), offset_of!(WorldRay, direction)];
        let [x, y, z] = [o, o + number, o + 2 * number].map(member);
        let [dx, dy, dz] = [d, d + number, d + 2 * number].map(member);
        let [mint, maxt, time] =
            [offset_of!(WorldRay, mint), offset_of!(WorldRay, maxt), offset_of!(WorldRay, time)].map(member);
        // SAFETY: the caller's promise.
        unsafe { Self::raw([x, y, z, dx, dy, dz, mint, maxt, time, weights], None, count) }
    }

    /// Room for rays as slices.
    ///
    /// # Panics
    /// The slices differ in length.
    #[inline(always)]
    pub fn columns(origin: [&'a mut [f32]; 3], direction: [&'a mut [f32]; 3], weight: &'a mut [f32]) -> Self {
        let count = weight.len();
        let [ox, oy, oz] = origin;
        let [dx, dy, dz] = direction;
        let mut columns = [Strided::NONE; NUMBERS];
        for (to, column) in columns.iter_mut().zip([ox, oy, oz, dx, dy, dz]) {
            *to = lent(column, count);
        }
        columns[WEIGHT] = lent(weight, count);
        let room = Room::Columns(columns);
        Self { room, neighbours: None, count, are_slices: true, lent: PhantomData }
    }

    /// Room for rays as slices of `count` numbers: origin, direction, range, time, weight.
    ///
    /// # Panics
    /// The slices differ in length.
    #[inline(always)]
    pub(crate) fn of_all(slices: [&'a mut [f32]; NUMBERS], count: usize) -> Self {
        let mut columns = [Strided::NONE; NUMBERS];
        for (to, column) in columns.iter_mut().zip(slices) {
            *to = lent(column, count);
        }
        let room = Room::Columns(columns);
        Self { room, neighbours: None, count, are_slices: true, lent: PhantomData }
    }

    /// Puts a column in its place.
    #[inline(always)]
    fn set(&mut self, number: usize, column: Strided) {
        if let Room::One { .. } = self.room {
            self.room = Room::Columns(self.all());
        }
        if let Room::Columns(columns) = &mut self.room {
            columns[number] = column;
        }
    }

    /// Asks for the ranges.
    ///
    /// # Panics
    /// The slices differ in length from the others.
    #[must_use]
    #[inline(always)]
    pub fn with_range(mut self, [mint, maxt]: [&'a mut [f32]; 2]) -> Self {
        self.set(RANGE, lent(mint, self.count));
        self.set(RANGE + 1, lent(maxt, self.count));
        self
    }

    /// Asks for the times.
    ///
    /// # Panics
    /// The slice differs in length from the others.
    #[must_use]
    #[inline(always)]
    pub fn with_time(mut self, time: &'a mut [f32]) -> Self {
        self.set(TIME, lent(time, self.count));
        self
    }

    /// Asks for the rays of the neighbouring pixels: one pixel to the right, and one pixel down. Their ranges and times are those
    /// of the rays.
    ///
    /// # Panics
    /// The columns differ in number from the others.
    #[must_use]
    pub fn with_neighbours(mut self, neighbours: [Rays<'a>; 2]) -> Self {
        for side in &neighbours {
            assert_eq!(side.count, self.count, "the columns of rays must have one length");
            self.are_slices &= side.are_slices;
        }
        self.neighbours = Some(neighbours.map(|mut side| {
            let mut columns = side.all();
            columns[RANGE..WEIGHT].fill(Strided::NONE);
            columns
        }));
        self
    }

    /// Room for rays: origin, direction; range and time, which may be missing; weight; the same of neighbours, if they are asked
    /// for.
    ///
    /// # Safety
    /// `count` numbers of each can be read and written for `'a`, and nothing else refers to them.
    #[inline(always)]
    pub(crate) unsafe fn raw(
        columns: [Strided; NUMBERS],
        neighbours: Option<[[Strided; NUMBERS]; 2]>,
        count: usize,
    ) -> Self {
        let mut are_slices = true;
        for column in columns {
            are_slices &= !column.is_there() || column.is_slice(count);
        }
        if let Some(sides) = &neighbours {
            for column in sides.as_flattened() {
                are_slices &= !column.is_there() || column.is_slice(count);
            }
        }
        Self { room: Room::Columns(columns), neighbours, count, are_slices, lent: PhantomData }
    }

    /// The number of rays.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is room for none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether each column that is there is a slice.
    #[inline(always)]
    pub(crate) fn are_slices(&self) -> bool {
        self.are_slices
    }

    /// Whether neighbours are asked for.
    #[inline(always)]
    pub(crate) fn have_neighbours(&self) -> bool {
        self.neighbours.is_some()
    }

    /// Room for `count` rays from `first` on, without neighbours.
    ///
    /// # Panics
    /// There is not so much.
    #[inline(always)]
    pub(crate) fn part(&mut self, first: usize, count: usize) -> Rays<'_> {
        assert!(first <= self.count && count <= self.count - first, "room for fewer rays");
        // SAFETY: as this, of which it is a part that is lent.
        unsafe { Rays::raw(self.all().map(|column| column.from(first)), None, count) }
    }

    /// Room for `count` rays from `first` on, and for their neighbours, where they are asked for.
    ///
    /// # Panics
    /// There is not so much.
    pub(crate) fn part_with_sides(
        &mut self,
        first: usize,
        count: usize,
    ) -> (Rays<'_>, Option<[Rays<'_>; 2]>) {
        let sides = self.neighbours.map(|sides| {
            // SAFETY: as this, of which it is a part that is lent; `part` checks that there is so much.
            sides.map(|side| unsafe { Rays::raw(side.map(|column| column.from(first)), None, count) })
        });
        (self.part(first, count), sides)
    }

    /// Writes the rays' own origins and directions where neighbours are missing. All columns are slices.
    pub(crate) fn stand_in(&mut self, neighbours: &mut Rays<'_>) {
        if are_positive(neighbours.weights()) {
            return;
        }
        for i in 0..self.count {
            if self.slice(WEIGHT)[i] > 0.0 && neighbours.slice(WEIGHT)[i] == 0.0 {
                for number in 0..RANGE {
                    neighbours.slice(number)[i] = self.slice(number)[i];
                }
            }
        }
    }

    /// Copies rays that there are from columns of our own, of which there are as many, and the weights of all.
    pub(crate) fn copy_from(&mut self, columns: &[&[f32]; NUMBERS], weights: &[f32]) {
        assert!(weights.len() == self.count, "as many rays");
        // SAFETY: there is room for so many.
        unsafe {
            let to = self.all();
            write(&to[..WEIGHT], 0, &columns[..WEIGHT], weights);
            if to[WEIGHT].is_slice(self.count) {
                slice::from_raw_parts_mut(to[WEIGHT].at(0), self.count).copy_from_slice(columns[WEIGHT]);
            } else {
                columns[WEIGHT].iter().enumerate().for_each(|(i, weight)| to[WEIGHT].put(i, *weight));
            }
        }
    }

    /// The weights.
    ///
    /// # Panics
    /// The columns are no slices.
    #[inline(always)]
    pub(crate) fn weights(&mut self) -> &mut [f32] {
        self.slice(WEIGHT)
    }

    /// Gives the rays that there are their range, unless each has its own, and their times, which `time` makes of these
    /// `numbers`; where that is asked for.
    ///
    /// # Panics
    /// The columns are no slices.
    #[inline(always)]
    pub(crate) fn complete(&mut self, range: Option<[f32; 2]>, numbers: &[f32], time: impl Fn(f32) -> f32) {
        if let Room::One { ray, weight } = &mut self.room {
            if **weight > 0.0 {
                if let Some(range) = range {
                    [ray.mint, ray.maxt] = range;
                }
                ray.time = time(numbers[0]);
            }
            return;
        }
        if let Some([first, last]) = range {
            self.fill(RANGE, numbers, |_| first);
            self.fill(RANGE + 1, numbers, |_| last);
        }
        self.fill(TIME, numbers, time);
    }

    /// Writes what `number` makes of each of `of` into a column that is there, where there is a ray.
    #[inline(always)]
    fn fill(&mut self, column: usize, of: &[f32], number: impl Fn(f32) -> f32) {
        let to = self.first(column);
        if to.is_null() {
            return;
        }
        let count = self.count;
        // SAFETY: two slices of so many numbers, by what made this.
        let (to, weight) = unsafe {
            (slice::from_raw_parts_mut(to, count), slice::from_raw_parts(self.first(WEIGHT), count))
        };
        assert!(self.are_slices && of.len() == count, "columns that are no slices of one length");
        if count <= 4 {
            // Done before a loop of vectors has begun.
            for i in (0..count).filter(|&i| weight[i] > 0.0) {
                to[i] = number(of[i]);
            }
            return;
        }
        // Without a branch, so that the compiler makes vectors of it.
        for ((to, weight), of) in to.iter_mut().zip(weight).zip(of) {
            let number = number(*of);
            *to = if *weight > 0.0 { number } else { *to };
        }
    }

    /// Writes a vector of rays from index `at` on: the last step of all lanes, of whatever model. A ray that is none,
    /// by `passed` or by its numbers ([`WorldRay::is_sound`]), has weight 0, and nothing else of it is written. `range`
    /// where each ray has its own.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn store<L: Lanes>(
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
        // One lane of one ray, of which nothing is to be found out.
        if let (1, Room::One { ray, weight: to }) = (L::WIDTH, &mut self.room) {
            weight.or_zero(passed).store_single(slice::from_mut(to));
            let WorldRay { origin: o, direction: d, mint, maxt, .. } = &mut **ray;
            if L::all(passed) {
                for axis in 0..3 {
                    origin[axis].store_single(slice::from_mut(&mut o[axis]));
                    direction[axis].store_single(slice::from_mut(&mut d[axis]));
                }
                if let Some([first, last]) = range {
                    first.store_single(slice::from_mut(mint));
                    last.store_single(slice::from_mut(maxt));
                }
            }
            return;
        }
        weight.or_zero(passed).store_single(&mut self.slice(WEIGHT)[at..]);
        // No loop, for which the compiler would put the vectors into memory.
        put(x, passed, &mut self.slice(0)[at..]);
        put(y, passed, &mut self.slice(1)[at..]);
        put(z, passed, &mut self.slice(2)[at..]);
        put(u, passed, &mut self.slice(3)[at..]);
        put(v, passed, &mut self.slice(4)[at..]);
        put(w, passed, &mut self.slice(5)[at..]);
        if let Some(range) = range {
            for (number, ends) in (RANGE..TIME).zip(range) {
                if !self.first(number).is_null() {
                    put(ends, passed, &mut self.slice(number)[at..]);
                }
            }
        }
    }

    /// The address of a column; null where it is missing.
    #[inline(always)]
    fn first(&mut self, number: usize) -> *mut f32 {
        // Not a copy of all columns: their addresses, just stored one by one, would be waited for.
        match &self.room {
            Room::Columns(columns) => columns[number].at(0),
            Room::One { .. } => self.all()[number].at(0),
        }
    }

    /// A column that is there.
    #[inline(always)]
    fn slice(&mut self, number: usize) -> &mut [f32] {
        assert!(self.are_slices, "columns that are no slices");
        // SAFETY: a slice of so many numbers, by what made this.
        unsafe { slice::from_raw_parts_mut(self.first(number), self.count) }
    }

    /// Writes origin, direction and weight of a ray at an index; of none, the weight 0 alone.
    ///
    /// # Panics
    /// There is no such index.
    pub(crate) fn put(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        assert!(i < self.count, "room for fewer rays");
        // SAFETY: there is room.
        unsafe {
            let columns = self.all();
            if let Some((WorldRay { origin, direction, .. }, _)) = ray {
                for axis in 0..3 {
                    columns[axis].put(i, origin[axis]);
                    columns[3 + axis].put(i, direction[axis]);
                }
            }
            columns[WEIGHT].put(i, ray.map_or(0.0, |(_, weight)| weight));
        }
    }
}

/// A column that is a slice of `count` numbers.
#[inline(always)]
fn lent(column: &mut [f32], count: usize) -> Strided {
    assert_eq!(column.len(), count, "the columns of rays must have one length");
    Strided::new(column.as_mut_ptr(), size_of::<f32>() as isize)
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

/// Room for a block of rays as columns of our own.
impl Columns<NUMBERS> {
    pub(crate) fn rays(&mut self, count: usize) -> Rays<'_> {
        Rays::of_all(self.first_mut(count), count)
    }

    /// The same for neighbours.
    pub(crate) fn neighbours(&mut self, count: usize) -> Rays<'_> {
        let [ox, oy, oz, dx, dy, dz, .., weight] = self.first_mut(count);
        Rays::columns([ox, oy, oz], [dx, dy, dz], weight)
    }
}

/// A block of samples as columns of our own, with a sample per ray.
impl Columns<6> {
    pub(crate) fn samples(&self, count: usize, have_wavelengths: bool) -> Samples<'_> {
        let [x, y, u, v, time, wavelengths] = self.first(count);
        let samples = Samples::columns([x, y, u, v, time]);
        if have_wavelengths { samples.at(wavelengths) } else { samples }
    }
}

/// A lens and time sample at four image points, stored as the vectors that lanes will load: loads of what was just stored
/// number by number would have to wait.
#[inline(always)]
pub(crate) fn at_points(sample: &Sample, image_x: [f32; 4], image_y: [f32; 4]) -> [[f32; 4]; 5] {
    let vectors = [
        Vec4::from_array(image_x),
        Vec4::from_array(image_y),
        Vec4::splat(sample.lens_u),
        Vec4::splat(sample.lens_v),
        Vec4::splat(sample.time),
    ];
    vectors.map(|vector| vector.to_array())
}

/// Room for the rays of three samples side by side, such as a ray and its neighbours, and one more.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourRays([[f32; 4]; NUMBERS]);

impl FourRays {
    /// No rays.
    pub const NONE: Self = Self([[0.0; 4]; NUMBERS]);

    /// Room for the first `count` rays.
    #[inline(always)]
    pub fn first(&mut self, count: usize) -> Rays<'_> {
        Rays::of_all(self.0.each_mut().map(|column| &mut column[..count]), count)
    }

    /// Origin, direction, range, time, weight.
    #[inline(always)]
    pub fn columns(&self) -> [&[f32; 4]; NUMBERS] {
        self.0.each_ref()
    }

    /// The weight of a ray; 0 where there is none.
    #[inline(always)]
    pub fn weight(&self, i: usize) -> f32 {
        self.0[WEIGHT][i]
    }

    /// The weight, to be written.
    #[inline(always)]
    pub fn weight_mut(&mut self, i: usize) -> &mut f32 {
        &mut self.0[WEIGHT][i]
    }

    /// A ray with its weight, if there is one.
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let mut ray = WorldRay::default();
        let weight = self.copy_to(i, &mut ray);
        (weight > 0.0).then_some((ray, weight))
    }

    /// Copies a ray, if there is one, straight to its place: numbers put down on the way would be waited for. Returns its weight.
    ///
    /// # Panics
    /// `i` is not below 4.
    #[inline(always)]
    pub fn copy_to(&self, i: usize, ray: &mut WorldRay) -> f32 {
        assert!(i < 4, "no such ray");
        let weight = self.weight(i);
        if weight > 0.0 {
            for axis in 0..3 {
                ray.origin[axis] = self.0[axis][i];
                ray.direction[axis] = self.0[3 + axis][i];
            }
            (ray.mint, ray.maxt, ray.time) = (self.0[RANGE][i], self.0[RANGE + 1][i], self.0[TIME][i]);
        }
        weight
    }
}
