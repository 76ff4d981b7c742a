//! Columns with one number per element: a caller's columns with any stride, and contiguous buffers for a
//! block of elements.
//!
//! Four numbers that are adjacent in each element, as members of a structure are, are copied together: those
//! of four elements form a 4 x 4 matrix, which is transposed in registers.

use std::{mem::MaybeUninit, ptr::null_mut, slice};

use glam::Mat4;

/// Number of elements in a block. The samples, rays and neighbours of a block take 18 KiB, a little more than
/// half of a 32 KiB first-level cache.
pub(crate) const BLOCK: usize = 128;
/// Number of columns, and of elements, that are transposed together.
const FOUR: usize = 4;

/// A column of numbers, given by the address of the first number and the stride.
#[derive(Clone, Copy, Debug)]
pub struct Strided<T = f32> {
    /// Address of the first number; null if the column is missing.
    first: *mut T,
    /// Distance in bytes from one number to the next.
    stride: isize,
}

impl<T: Copy> Strided<T> {
    /// A missing column.
    pub const NONE: Self = Self { first: null_mut(), stride: 0 };

    /// Describes a column of numbers with the first at `first` and one every `stride` bytes.
    #[inline(always)]
    pub const fn new(first: *mut T, stride: isize) -> Self {
        Self { first, stride }
    }

    /// Whether the column is present.
    #[inline(always)]
    pub fn is_there(self) -> bool {
        !self.first.is_null()
    }

    /// Returns this column or, if it is missing, one that repeats the number at `first`.
    #[inline(always)]
    pub fn or(self, first: *mut T) -> Self {
        if self.is_there() { self } else { Self::new(first, 0) }
    }

    /// Returns the address of number `i`.
    #[inline(always)]
    pub fn at(self, i: usize) -> *mut T {
        self.first.wrapping_byte_offset((i as isize).wrapping_mul(self.stride))
    }

    /// Describes the part of the column that begins at number `i`.
    #[inline(always)]
    pub fn from(self, i: usize) -> Self {
        Self { first: if self.is_there() { self.at(i) } else { self.first }, ..self }
    }

    /// Reads number `i`.
    ///
    /// # Safety
    /// The number exists.
    #[inline(always)]
    pub unsafe fn get(self, i: usize) -> T {
        // SAFETY: the caller promises that the number exists; the read needs no alignment.
        unsafe { self.at(i).read_unaligned() }
    }

    /// Writes number `i`.
    ///
    /// # Safety
    /// Number `i` can be written.
    #[inline(always)]
    pub unsafe fn put(self, i: usize, number: T) {
        // SAFETY: the caller promises that the number can be written; the write needs no alignment.
        unsafe { self.at(i).write_unaligned(number) };
    }

    /// Whether `count` numbers form a slice: aligned and contiguous.
    #[inline(always)]
    pub(crate) fn is_slice(self, count: usize) -> bool {
        self.first.is_aligned() && (self.stride == size_of::<T>() as isize || count == 1)
    }
}

/// Whether the columns are adjacent members of structures.
#[inline(always)]
fn are_rows(numbers: &[Strided]) -> bool {
    let first = numbers[0];
    let follows = |(k, number): (usize, &Strided)| {
        number.stride == first.stride && number.first == first.first.wrapping_add(k)
    };
    first.is_there() && first.stride != size_of::<f32>() as isize && numbers.iter().enumerate().all(follows)
}

/// Copies numbers, from element `first` on, to buffers; a missing column gives zeros.
///
/// # Safety
/// The present columns have at least as many numbers as are copied.
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

/// Copies rows of four numbers to four buffers.
///
/// # Safety
/// The rows exist.
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

/// Copies buffers to columns, from element `first` on. Elements whose weight is not positive and missing
/// columns are skipped.
///
/// # Safety
/// The present columns have at least as many numbers as are copied, and these can be written.
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

/// Copies a buffer to a column for the elements with a positive weight.
///
/// # Safety
/// The column has at least as many numbers as are copied, and these can be written.
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

/// Copies four buffers to rows of four numbers for the elements with a positive weight.
///
/// # Safety
/// The rows exist.
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

/// Whether all weights are positive. The loop is branch-free, so that the compiler vectorizes it.
#[inline(always)]
pub(crate) fn are_positive(weights: &[f32]) -> bool {
    weights.iter().fold(true, |all, weight| all & (*weight > 0.0))
}

/// Transposes a matrix.
#[inline(always)]
fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}

/// Contiguous buffers for up to [`BLOCK`] elements. Only the part in use is cleared, so that small blocks are cheap.
pub(crate) struct Columns<const N: usize> {
    columns: [[MaybeUninit<f32>; BLOCK]; N],
    /// Number of initialized numbers in each buffer.
    set: usize,
}

impl<const N: usize> Columns<N> {
    /// Returns buffers with `count` zeros each, at most [`BLOCK`].
    #[inline(always)]
    pub fn zeros(count: usize) -> Self {
        let set = count.min(BLOCK);
        // SAFETY: an array of uninitialized numbers needs no initialization.
        let mut columns: [[MaybeUninit<f32>; BLOCK]; N] = unsafe { MaybeUninit::uninit().assume_init() };
        // Clears four numbers at a time, because a call of memset per column would dominate the time of small
        // blocks.
        for begin in (0..set).step_by(FOUR) {
            for column in &mut columns {
                column[begin..begin + FOUR].copy_from_slice(&[MaybeUninit::new(0.0); FOUR]);
            }
        }
        Self { columns, set }
    }

    /// Returns the first `count` numbers of each buffer, or fewer if [`Columns::zeros`] was asked for fewer.
    #[inline(always)]
    pub fn first(&self, count: usize) -> [&[f32]; N] {
        let count = count.min(self.set);
        // SAFETY: the first `set` numbers are initialized.
        self.columns.each_ref().map(|column| unsafe { slice::from_raw_parts(column.as_ptr().cast(), count) })
    }

    /// [`Columns::first`] for writing.
    #[inline(always)]
    pub fn first_mut(&mut self, count: usize) -> [&mut [f32]; N] {
        let count = count.min(self.set);
        // SAFETY: as in `first`.
        self.columns
            .each_mut()
            .map(|column| unsafe { slice::from_raw_parts_mut(column.as_mut_ptr().cast(), count) })
    }
}
