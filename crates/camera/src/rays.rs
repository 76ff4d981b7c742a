//! Rays in world space: a single ray with the layout of pbrt-v1's `Ray`, and output columns for many rays
//! with weights.

use std::{
    marker::PhantomData,
    mem::{MaybeUninit, offset_of, size_of},
    ptr, slice,
};

use super::columns::{Columns, Strided, are_positive, write};
use realistic_base::numeric::Real;
use realistic_optics::trace::Blocked;
use realistic_simd::{Cpu, Lanes};

pub use super::samples::{Sample, Samples, at_points};

/// A ray in world space, with the layout of pbrt-v1's `Ray`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldRay {
    /// Origin, world units.
    pub origin: [f32; 3],
    /// Unit direction.
    pub direction: [f32; 3],
    /// Distance from the origin at which the ray begins.
    pub mint: f32,
    /// Distance from the origin at which the ray ends.
    pub maxt: f32,
    /// Time.
    pub time: f32,
}

impl WorldRay {
    /// Largest deviation of a direction's squared length from 1. Within it, the length is 1 to within 1e-6,
    /// because computing the square involves three roundings.
    pub const UNIT: f32 = 1.6e-6;

    /// Whether the origin is finite and the direction is a unit vector. Image points that are NaN or far
    /// outside any image lead to rays that fail this test.
    pub fn is_sound(&self) -> bool {
        let [x, y, z] = self.direction;
        (x * x + y * y + z * z - 1.0).abs() < Self::UNIT && self.origin.iter().all(|part| part.is_finite())
    }
}

/// A ray and its neighbours for ray differentials (H. Igehy, "Tracing Ray Differentials", SIGGRAPH 1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDifferential {
    /// The ray of the sample.
    pub ray: WorldRay,
    /// The ray at image x + 1; `None` if the lens blocks it.
    pub rx: Option<WorldRay>,
    /// The ray at image y + 1; `None` if the lens blocks it.
    pub ry: Option<WorldRay>,
}

/// Outcome of tracing a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// A ray and its weight, which is positive.
    Ray(WorldRay, f32),
    /// The lens blocks the ray: weight 0.
    Blocked(Blocked),
    /// The lens sample lies outside the disk
    /// ([`DiskMapping::Rejection`](crate::sampling::DiskMapping::Rejection)); the caller has to retry with a
    /// new lens sample.
    Redraw,
    /// The shutter is closed at this film point and time: weight 0.
    Shut,
    /// The wavelength is not a number, is out of range, or is one at which a glass has no refractive index:
    /// weight 0.
    Wavelength,
}

/// Number of columns: origin, direction, range and time as in a [`WorldRay`], and the weight.
const NUMBERS: usize = 10;
/// Index of the first of the two columns of the range; the columns of range and time may be missing.
pub(crate) const RANGE: usize = 6;
/// Index of the column of times.
pub(crate) const TIME: usize = 8;
/// Index of the column of weights.
pub(crate) const WEIGHT: usize = 9;

/// Output columns for rays; each column is a slice or a member of an array of structures. The columns are
/// origins in world units, unit directions and weights, and optionally ranges, times and the rays of the
/// neighbouring pixels.
///
/// A blocked sample gets the weight 0, and its other numbers are not changed. A blocked neighbour gets the
/// weight 0 and the origin and direction of the sample's ray; if that ray is blocked, too, only the weight 0
/// is written.
#[derive(Debug)]
pub struct Rays<'a> {
    target: RayTarget<'a>,
    /// Columns of the two neighbours, without ranges and times.
    neighbours: Option<[[Strided; NUMBERS]; 2]>,
    count: usize,
    /// Whether every column that is present is a slice.
    are_slices: bool,
    borrow: PhantomData<&'a mut [f32]>,
}

/// One ray and its weight, or columns.
#[derive(Debug)]
enum RayTarget<'a> {
    One { ray: &'a mut WorldRay, weight: &'a mut f32 },
    Columns([Strided; NUMBERS]),
}

impl<'a> Rays<'a> {
    /// Wraps one ray, including its range and time, and the ray's weight.
    #[inline(always)]
    pub fn of(ray: &'a mut WorldRay, weight: &'a mut f32) -> Self {
        Self {
            target: RayTarget::One { ray, weight },
            neighbours: None,
            count: 1,
            are_slices: true,
            borrow: PhantomData,
        }
    }

    /// Returns all columns; the columns of range and time may be missing.
    #[inline(always)]
    fn all(&mut self) -> [Strided; NUMBERS] {
        match &mut self.target {
            RayTarget::Columns(columns) => *columns,
            RayTarget::One { ray, weight } => {
                let [x, y, z, dx, dy, dz, mint, maxt, time] = members(ptr::from_mut(&mut **ray));
                [x, y, z, dx, dy, dz, mint, maxt, time, Strided::new(ptr::from_mut(&mut **weight), 0)]
            }
        }
    }

    /// Wraps an array of ray structures and the slice of their weights.
    ///
    /// # Panics
    /// The two slices differ in length.
    pub fn structs(rays: &'a mut [WorldRay], weights: &'a mut [f32]) -> Self {
        assert_eq!(rays.len(), weights.len(), "a weight for each ray");
        let count = rays.len();
        // SAFETY: both are borrowed for `'a` and have `count` elements.
        unsafe { Self::raw_structs(rays.as_mut_ptr(), strided(weights, count), count) }
    }

    /// Wraps an array of ray structures and a column of weights.
    ///
    /// # Safety
    /// `count` elements of both can be read and written for `'a`, and nothing else refers to them.
    #[inline(always)]
    pub unsafe fn raw_structs(rays: *mut WorldRay, weights: Strided, count: usize) -> Self {
        let [x, y, z, dx, dy, dz, mint, maxt, time] = members(rays);
        // SAFETY: promised by the caller.
        unsafe { Self::raw([x, y, z, dx, dy, dz, mint, maxt, time, weights], None, count) }
    }

    /// Wraps slices.
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
            *to = strided(column, count);
        }
        columns[WEIGHT] = strided(weight, count);
        let target = RayTarget::Columns(columns);
        Self { target, neighbours: None, count, are_slices: true, borrow: PhantomData }
    }

    /// Wraps slices of `count` numbers, in the order origin, direction, range, time, weight.
    ///
    /// # Panics
    /// The slices differ in length.
    #[inline(always)]
    pub fn of_all(slices: [&'a mut [f32]; NUMBERS], count: usize) -> Self {
        let mut columns = [Strided::NONE; NUMBERS];
        for (to, column) in columns.iter_mut().zip(slices) {
            *to = strided(column, count);
        }
        let target = RayTarget::Columns(columns);
        Self { target, neighbours: None, count, are_slices: true, borrow: PhantomData }
    }

    /// Sets a column.
    #[inline(always)]
    fn set(&mut self, number: usize, column: Strided) {
        if let RayTarget::One { .. } = self.target {
            self.target = RayTarget::Columns(self.all());
        }
        if let RayTarget::Columns(columns) = &mut self.target {
            columns[number] = column;
        }
    }

    /// Adds columns for the ranges.
    ///
    /// # Panics
    /// The new slices differ in length from the columns.
    #[must_use]
    #[inline(always)]
    pub fn with_range(mut self, [mint, maxt]: [&'a mut [f32]; 2]) -> Self {
        self.set(RANGE, strided(mint, self.count));
        self.set(RANGE + 1, strided(maxt, self.count));
        self
    }

    /// Adds a column for the times.
    ///
    /// # Panics
    /// The new slice differs in length from the columns.
    #[must_use]
    #[inline(always)]
    pub fn with_time(mut self, time: &'a mut [f32]) -> Self {
        self.set(TIME, strided(time, self.count));
        self
    }

    /// Adds columns for the rays one pixel to the right and one pixel down. Only the origins, directions and
    /// weights of these rays are written; their columns of ranges and times are ignored.
    ///
    /// # Panics
    /// The new columns differ in length from the present ones.
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

    /// Wraps columns of origin, direction, range, time and weight (range and time may be missing), and
    /// optionally the columns of the neighbours.
    ///
    /// # Safety
    /// `count` numbers of each column can be read and written for `'a`, and nothing else refers to them.
    #[inline(always)]
    pub unsafe fn raw(
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
        Self { target: RayTarget::Columns(columns), neighbours, count, are_slices, borrow: PhantomData }
    }

    /// Returns the number of rays.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether the number of rays is 0.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether every column that is present is a slice.
    #[inline(always)]
    pub(crate) fn are_slices(&self) -> bool {
        self.are_slices
    }

    /// Whether there are columns for neighbours.
    #[inline(always)]
    pub(crate) fn have_neighbours(&self) -> bool {
        self.neighbours.is_some()
    }

    /// Returns the part of the columns for `count` rays from `first` on, without neighbours.
    ///
    /// # Panics
    /// The columns end before the last of these rays.
    #[inline(always)]
    pub fn part(&mut self, first: usize, count: usize) -> Rays<'_> {
        assert!(first <= self.count && count <= self.count - first, "room for fewer rays");
        // SAFETY: the part lies within these columns and borrows from them.
        unsafe { Rays::raw(self.all().map(|column| column.from(first)), None, count) }
    }

    /// Returns the part of the columns for `count` rays from `first` on, and the part for their neighbours.
    ///
    /// # Panics
    /// The columns end before the last of these rays.
    pub(crate) fn part_with_sides(
        &mut self,
        first: usize,
        count: usize,
    ) -> (Rays<'_>, Option<[Rays<'_>; 2]>) {
        let sides = self.neighbours.map(|sides| {
            // SAFETY: the part lies within these columns and borrows from them; `part` checks the length.
            sides.map(|side| unsafe { Rays::raw(side.map(|column| column.from(first)), None, count) })
        });
        (self.part(first, count), sides)
    }

    /// Copies the origin and direction of each ray to its neighbour if the neighbour is blocked. All columns
    /// are slices.
    pub fn stand_in(&mut self, neighbours: &mut Rays<'_>) {
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

    /// Copies from buffers of the same length the rays with a positive weight, and all weights.
    pub(crate) fn copy_from(&mut self, columns: &[&[f32]; NUMBERS], weights: &[f32]) {
        assert!(weights.len() == self.count, "a weight for each ray");
        // SAFETY: the columns have `count` numbers.
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

    /// Returns the weights.
    ///
    /// # Panics
    /// The columns are not slices.
    #[inline(always)]
    pub fn weights(&mut self) -> &mut [f32] {
        self.slice(WEIGHT)
    }

    /// Writes the range common to all rays, if there is one, and the times that `time` computes from the time
    /// samples `numbers`. Writes only for rays with a positive weight, and only into columns that are
    /// present.
    ///
    /// # Panics
    /// The columns are not slices.
    #[inline(always)]
    pub(crate) fn complete(&mut self, range: Option<[f32; 2]>, numbers: &[f32], time: impl Fn(f32) -> f32) {
        if let RayTarget::One { ray, weight } = &mut self.target {
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

    /// Writes into a column, if it is present, `number` of each element of `of`, for the rays with a positive
    /// weight.
    #[inline(always)]
    fn fill(&mut self, column: usize, of: &[f32], number: impl Fn(f32) -> f32) {
        let to = self.first(column);
        if to.is_null() {
            return;
        }
        let count = self.count;
        assert!(self.are_slices && of.len() == count, "columns that are no slices of one length");
        // SAFETY: the constructors guarantee two distinct slices of `count` numbers. The caller need not have
        // initialized the column that is written; the weights have been stored.
        let (to, weight) = unsafe {
            let to = slice::from_raw_parts_mut(to.cast::<MaybeUninit<f32>>(), count);
            (to, slice::from_raw_parts(self.first(WEIGHT), count))
        };
        if count <= 4 {
            // For so few rays, a scalar loop ends before a vectorized loop would have started.
            for i in (0..count).filter(|&i| weight[i] > 0.0) {
                to[i].write(number(of[i]));
            }
            return;
        }
        // The loop is branch-free, so that the compiler vectorizes it.
        for ((to, weight), of) in to.iter_mut().zip(weight).zip(of) {
            let number = MaybeUninit::new(number(*of));
            *to = if *weight > 0.0 { number } else { *to };
        }
    }

    /// Stores a vector of rays from index `at` on; this is the last step of every model. A lane is blocked if
    /// `passed` says so or if its numbers are not sound ([`WorldRay::is_sound`]); it gets the weight 0, and
    /// its other numbers are not written. `range` is the range of each ray, for models in which ranges differ
    /// between rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn store<L: Lanes>(
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
            // With this order of operands, NaN stays NaN.
            passed = L::both(passed, first.less_equal(most.smaller(last)));
        }
        // A single ray needs no address arithmetic.
        if let (1, RayTarget::One { ray, weight: to }) = (L::WIDTH, &mut self.target) {
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
        // Written out instead of a loop, because the compiler would spill the vectors to memory.
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

    /// Returns the address of a column; null if it is missing.
    #[inline(always)]
    fn first(&mut self, number: usize) -> *mut f32 {
        // Does not use `all`: a wide copy of addresses that were just stored one by one stalls on store
        // forwarding.
        match &self.target {
            RayTarget::Columns(columns) => columns[number].at(0),
            RayTarget::One { .. } => self.all()[number].at(0),
        }
    }

    /// Returns a column that is present.
    #[inline(always)]
    fn slice(&mut self, number: usize) -> &mut [f32] {
        assert!(self.are_slices, "columns that are no slices");
        // SAFETY: the constructors guarantee a slice of `count` numbers.
        unsafe { slice::from_raw_parts_mut(self.first(number), self.count) }
    }

    /// Writes the origin, direction and weight of a ray at index `i`; for `None`, writes only the weight 0.
    ///
    /// # Panics
    /// `i` is not less than [`Rays::len`].
    pub fn put(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        assert!(i < self.count, "room for fewer rays");
        // SAFETY: by the assertion, the columns have an element `i`.
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

/// Returns columns for the members of the rays in an array: origin, direction, range, time.
#[inline(always)]
fn members(rays: *mut WorldRay) -> [Strided; 9] {
    let member = |offset: usize| {
        Strided::new(rays.wrapping_byte_add(offset).cast::<f32>(), size_of::<WorldRay>() as isize)
    };
    let number = size_of::<f32>();
    let [o, d] = [offset_of!(WorldRay, origin), offset_of!(WorldRay, direction)];
    let [mint, maxt] = [offset_of!(WorldRay, mint), offset_of!(WorldRay, maxt)];
    let time = offset_of!(WorldRay, time);
    [o, o + number, o + 2 * number, d, d + number, d + 2 * number, mint, maxt, time].map(member)
}

/// Describes a slice of `count` numbers.
#[inline(always)]
fn strided(column: &mut [f32], count: usize) -> Strided {
    assert_eq!(column.len(), count, "the columns of rays must have one length");
    Strided::new(column.as_mut_ptr(), size_of::<f32>() as isize)
}

/// Stores the lanes that passed.
#[cfg_attr(not(debug_assertions), inline(always))]
fn put<L: Lanes>(numbers: L, passed: L::Mask, to: &mut [f32]) {
    if L::all(passed) {
        numbers.store_single(to);
    } else {
        numbers.store_single_where(passed, to);
    }
}

/// Buffers for a block of rays.
impl Columns<NUMBERS> {
    /// Wraps the buffers for rays.
    pub fn rays(&mut self, count: usize) -> Rays<'_> {
        Rays::of_all(self.first_mut(count), count)
    }

    /// Wraps the buffers for neighbours, without range and time.
    pub fn neighbours(&mut self, count: usize) -> Rays<'_> {
        let [ox, oy, oz, dx, dy, dz, .., weight] = self.first_mut(count);
        Rays::columns([ox, oy, oz], [dx, dy, dz], weight)
    }
}

/// Buffers for four rays. A ray and its two neighbours, or the three calls of a pbrt host, fill three of
/// them.
#[derive(Clone, Copy, Debug)]
pub struct FourRays([[f32; 4]; NUMBERS]);

impl FourRays {
    /// Buffers without any ray.
    pub const NONE: Self = Self([[0.0; 4]; NUMBERS]);

    /// Wraps the buffers of the first `count` rays.
    #[inline(always)]
    pub fn first(&mut self, count: usize) -> Rays<'_> {
        Rays::of_all(self.0.each_mut().map(|column| &mut column[..count]), count)
    }

    /// Returns the columns: origin, direction, range, time, weight.
    #[inline(always)]
    pub fn columns(&self) -> [&[f32; 4]; NUMBERS] {
        self.0.each_ref()
    }

    /// Returns the weight of a ray; 0 if it is blocked.
    #[inline(always)]
    pub fn weight(&self, i: usize) -> f32 {
        self.0[WEIGHT][i]
    }

    /// Returns the weight of a ray for writing.
    #[inline(always)]
    pub(crate) fn weight_mut(&mut self, i: usize) -> &mut f32 {
        &mut self.0[WEIGHT][i]
    }

    /// Returns a ray with its weight; `None` if it is blocked.
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let mut ray = WorldRay::default();
        let weight = self.copy_to(i, &mut ray);
        (weight > 0.0).then_some((ray, weight))
    }

    /// Copies a ray, unless it is blocked, directly to its destination, because an intermediate copy would
    /// stall on store forwarding. Returns the ray's weight.
    ///
    /// # Panics
    /// `i` is not less than 4.
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
