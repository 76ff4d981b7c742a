//! Columns of numbers: one per element, at any distance from each other, as a caller holds them; and columns of our own, side by
//! side, for a block of elements.
//!
//! Four numbers that lie one after the other in each element, as in structures and tables of rows, are copied at once: four
//! elements are a 4 x 4 matrix, transposed in registers.

use std::{mem::MaybeUninit, ptr::null_mut, slice};

use glam::Mat4;

/// Elements that are copied at once: with samples, rays and neighbours they take half of a first cache of 32 KiB.
pub(crate) const BLOCK: usize = 128;
/// Numbers that are moved at once.
const FOUR: usize = 4;

/// The place of a column's numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strided<T = f32> {
    /// The first; null where there are none.
    first: *mut T,
    /// Bytes from one to the next.
    stride: isize,
}

impl<T: Copy> Strided<T> {
    /// No numbers.
    pub const NONE: Self = Self { first: null_mut(), stride: 0 };

    /// Numbers at `first` and every `stride` bytes from there.
    #[inline(always)]
    pub const fn new(first: *mut T, stride: isize) -> Self {
        Self { first, stride }
    }

    #[inline(always)]
    pub fn is_there(self) -> bool {
        !self.first.is_null()
    }

    /// The address of number `i`.
    #[inline(always)]
    pub fn at(self, i: usize) -> *mut T {
        self.first.wrapping_byte_offset((i as isize).wrapping_mul(self.stride))
    }

    /// The numbers from number `i` on.
    #[inline(always)]
    pub fn from(self, i: usize) -> Self {
        Self { first: if self.is_there() { self.at(i) } else { self.first }, ..self }
    }

    /// Number `i`.
    ///
    /// # Safety
    /// There is one.
    #[inline(always)]
    pub unsafe fn get(self, i: usize) -> T {
        // SAFETY: the caller's promise; nothing needs to be aligned.
        unsafe { self.at(i).read_unaligned() }
    }

    /// Writes number `i`.
    ///
    /// # Safety
    /// There is room.
    #[inline(always)]
    pub unsafe fn put(self, i: usize, number: T) {
        // SAFETY: the caller's promise; nothing needs to be aligned.
        unsafe { self.at(i).write_unaligned(number) };
    }

    /// Whether `count` numbers are a slice.
    #[inline(always)]
    pub fn is_slice(self, count: usize) -> bool {
        self.first.is_aligned() && (self.stride == size_of::<T>() as isize || count == 1)
    }
}

/// Whether numbers lie one after the other in each element, but elements not side by side.
#[inline(always)]
fn are_rows(numbers: &[Strided]) -> bool {
    let first = numbers[0];
    let follows = |(k, number): (usize, &Strided)| {
        number.stride == first.stride && number.first == first.first.wrapping_add(k)
    };
    first.is_there() && first.stride != size_of::<f32>() as isize && numbers.iter().enumerate().all(follows)
}

/// Copies the numbers of elements `first` on to columns of our own; a column that is not there becomes 0.
///
/// # Safety
/// They are there.
pub(crate) unsafe fn read<const N: usize>(numbers: &[Strided; N], first: usize, to: &mut [&mut [f32]; N]) {
    let mut k = 0;
    while k < N {
        // SAFETY: the caller's promise.
        unsafe {
            if k + FOUR <= N && are_rows(&numbers[k..k + FOUR]) {
                read_rows(numbers[k], first, &mut to[k..k + FOUR]);
                k += FOUR;
            } else {
                if numbers[k].is_there() && numbers[k].is_slice(first + to[k].len()) {
                    to[k].copy_from_slice(slice::from_raw_parts(numbers[k].at(first), to[k].len()));
                } else if numbers[k].is_there() {
                    to[k].iter_mut().enumerate().for_each(|(i, to)| *to = numbers[k].get(first + i));
                } else {
                    to[k].fill(0.0);
                }
                k += 1;
            }
        }
    }
}

/// Copies rows of four to four columns.
///
/// # Safety
/// They are there.
#[inline(always)]
unsafe fn read_rows(rows: Strided, first: usize, to: &mut [&mut [f32]]) {
    let [a, b, c, d] = to else { return };
    let count = a.len();
    let (b, c, d) = (&mut b[..count], &mut c[..count], &mut d[..count]);
    // SAFETY: the caller's promise.
    let row = |from: Strided, k: usize| unsafe { from.at(k).cast::<[f32; FOUR]>().read_unaligned() };
    let whole = count - count % FOUR;
    let mut from = rows.from(first);
    for i in (0..whole).step_by(FOUR) {
        let [x, y, z, w] = transposed([row(from, 0), row(from, 1), row(from, 2), row(from, 3)]);
        a[i..i + FOUR].copy_from_slice(&x);
        b[i..i + FOUR].copy_from_slice(&y);
        c[i..i + FOUR].copy_from_slice(&z);
        d[i..i + FOUR].copy_from_slice(&w);
        from = from.from(FOUR);
    }
    for i in whole..count {
        [a[i], b[i], c[i], d[i]] = row(rows, first + i);
    }
}

/// Copies columns of our own to the numbers of elements from `first` on that have a weight; columns that are not there are
/// passed over.
///
/// # Safety
/// There is room.
pub(crate) unsafe fn write(numbers: &[Strided], first: usize, from: &[&[f32]], weights: &[f32]) {
    let mut k = 0;
    while k < numbers.len() {
        // SAFETY: the caller's promise.
        unsafe {
            if k + FOUR <= numbers.len() && are_rows(&numbers[k..k + FOUR]) {
                write_rows(numbers[k], first, &from[k..k + FOUR], weights);
                k += FOUR;
            } else {
                if numbers[k].is_there() {
                    write_numbers(numbers[k], first, from[k], weights);
                }
                k += 1;
            }
        }
    }
}

/// Copies a column to the numbers of elements that have a weight.
///
/// # Safety
/// There is room.
#[inline(always)]
unsafe fn write_numbers(numbers: Strided, first: usize, from: &[f32], weights: &[f32]) {
    let count = weights.len();
    let from = &from[..count];
    let whole = count - count % FOUR;
    let mut to = numbers.from(first);
    // SAFETY: the caller's promise.
    unsafe {
        for i in (0..whole).step_by(FOUR) {
            let (four, weights) = (&from[i..i + FOUR], &weights[i..i + FOUR]);
            if are_positive(weights) {
                (0..FOUR).for_each(|k| to.put(k, four[k]));
            } else {
                (0..FOUR).filter(|&k| weights[k] > 0.0).for_each(|k| to.put(k, four[k]));
            }
            to = to.from(FOUR);
        }
        (whole..count).filter(|&i| weights[i] > 0.0).for_each(|i| numbers.put(first + i, from[i]));
    }
}

/// Copies four columns to rows of four.
///
/// # Safety
/// There is room.
#[inline(always)]
unsafe fn write_rows(rows: Strided, first: usize, from: &[&[f32]], weights: &[f32]) {
    let [a, b, c, d] = from else { return };
    let count = weights.len();
    let [a, b, c, d] = [&a[..count], &b[..count], &c[..count], &d[..count]];
    // SAFETY: the caller's promise.
    let put = |to: Strided, k: usize, row: [f32; FOUR]| unsafe {
        to.at(k).cast::<[f32; FOUR]>().write_unaligned(row);
    };
    let whole = count - count % FOUR;
    let mut to = rows.from(first);
    for i in (0..whole).step_by(FOUR) {
        let weights = &weights[i..i + FOUR];
        let four = |array: &[f32]| [array[i], array[i + 1], array[i + 2], array[i + 3]];
        let turned = transposed([four(a), four(b), four(c), four(d)]);
        if are_positive(weights) {
            (0..FOUR).for_each(|k| put(to, k, turned[k]));
        } else {
            (0..FOUR).filter(|&k| weights[k] > 0.0).for_each(|k| put(to, k, turned[k]));
        }
        to = to.from(FOUR);
    }
    (whole..count).filter(|&i| weights[i] > 0.0).for_each(|i| put(rows, first + i, [a[i], b[i], c[i], d[i]]));
}

/// Whether all weights are those of rays. Without a branch, so that the compiler makes vectors of it.
#[inline(always)]
pub(crate) fn are_positive(weights: &[f32]) -> bool {
    weights.iter().fold(true, |all, weight| all & (*weight > 0.0))
}

/// The rows of a matrix as its columns.
#[inline(always)]
fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}

/// Columns of our own, for up to [`BLOCK`] elements. Only as many numbers are cleared as are used, so that few cost little.
pub(crate) struct Columns<const N: usize> {
    columns: [[MaybeUninit<f32>; BLOCK]; N],
    /// Numbers of each column that are set.
    set: usize,
}

impl<const N: usize> Columns<N> {
    /// Columns of `count` zeros, at most [`BLOCK`].
    #[inline(always)]
    pub fn zeros(count: usize) -> Self {
        let set = count.min(BLOCK);
        // SAFETY: an array of numbers that may be unset needs none set.
        let mut columns: [[MaybeUninit<f32>; BLOCK]; N] = unsafe { MaybeUninit::uninit().assume_init() };
        // Four at a time: few numbers are not worth a call for each column.
        for begin in (0..set).step_by(FOUR) {
            for column in &mut columns {
                column[begin..begin + FOUR].copy_from_slice(&[MaybeUninit::new(0.0); FOUR]);
            }
        }
        Self { columns, set }
    }

    /// The first `count` numbers of each column, at most as many as were asked for.
    #[inline(always)]
    pub fn first(&self, count: usize) -> [&[f32]; N] {
        let count = count.min(self.set);
        // SAFETY: the first `set` numbers are set.
        self.columns.each_ref().map(|column| unsafe { slice::from_raw_parts(column.as_ptr().cast(), count) })
    }

    /// [`Columns::first`], to be written.
    #[inline(always)]
    pub fn first_mut(&mut self, count: usize) -> [&mut [f32]; N] {
        let count = count.min(self.set);
        // SAFETY: as there.
        self.columns
            .each_mut()
            .map(|column| unsafe { slice::from_raw_parts_mut(column.as_mut_ptr().cast(), count) })
    }
}
