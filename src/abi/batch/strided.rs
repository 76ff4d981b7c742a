//! Numbers of a caller, one per element, at any distance from each other: lent as slices where they lie side by side,
//! copied in and out where they do not. Four numbers that lie one after the other in each element, as in structures and
//! tables of rows, are moved at once: four elements are a 4 x 4 matrix, transposed in registers.

use std::{
    ptr::{null, null_mut},
    slice,
};

use glam::Mat4;

use super::super::{
    boundary::{self, ADDRESSABLE, Failure},
    types::{realistic_input, realistic_output},
};

// Here and not with the types, for the header would have them as macros.
impl realistic_input {
    /// What is left out.
    pub const NONE: Self = Self { x: null(), y: null(), stride: 0 };
}

impl realistic_output {
    /// What is left out.
    pub const NONE: Self = Self { x: null_mut(), y: null_mut(), z: null_mut(), stride: 0 };
}

/// As many numbers as are moved at once.
pub(super) const FOUR: usize = 4;

/// Where numbers lie, or room for them.
#[derive(Clone, Copy)]
pub(in super::super) struct Strided<T = f32> {
    /// The first; NULL where there are none.
    first: *mut T,
    /// Bytes from one to the next.
    stride: isize,
}

impl<T: Copy> Strided<T> {
    /// No numbers.
    pub const NONE: Self = Self { first: null_mut(), stride: 0 };

    /// `n` numbers that must be there; `name` is theirs in a request, with the name of the component.
    ///
    /// # Errors
    /// They are not, two of them overlap (though those that are read may be one), or no memory holds so many at this stride.
    #[inline(always)]
    pub fn new(
        [name, component]: [&str; 2],
        n: usize,
        first: *mut T,
        stride: isize,
        may_repeat: bool,
    ) -> Result<Self, Failure> {
        let bytes = stride.unsigned_abs();
        if first.is_null() {
            return Err(missing(name, component));
        }
        if n > 1 && bytes < size_of::<T>() && !(may_repeat && bytes == 0) {
            return Err(overlapping(name, stride, size_of::<T>(), may_repeat));
        }
        if !is_addressable(first.addr(), n, stride, size_of::<T>()) {
            return Err(endless(name, n, stride));
        }
        Ok(Self { first, stride })
    }

    #[inline(always)]
    pub fn is_there(self) -> bool {
        !self.first.is_null()
    }

    /// Where number `i` lies.
    #[inline(always)]
    pub fn at(self, i: usize) -> *mut T {
        self.first.wrapping_byte_offset((i as isize).wrapping_mul(self.stride))
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

    /// Puts number `i`.
    ///
    /// # Safety
    /// There is room.
    #[inline(always)]
    pub unsafe fn put(self, i: usize, number: T) {
        // SAFETY: the caller's promise; nothing needs to be aligned.
        unsafe { self.at(i).write_unaligned(number) };
    }

    /// Whether the numbers lie side by side, as in a slice.
    #[inline(always)]
    pub fn is_slice(self) -> bool {
        self.stride == size_of::<T>() as isize && self.first.is_aligned()
    }

    /// `count` of them from number `first` on.
    ///
    /// # Safety
    /// They are a slice, and nobody writes them.
    #[inline(always)]
    pub unsafe fn slice<'a>(self, first: usize, count: usize) -> &'a [T] {
        // SAFETY: the caller's promise.
        unsafe { slice::from_raw_parts(self.first.add(first), count) }
    }

    /// [`Strided::slice`] to be written.
    ///
    /// # Safety
    /// They are a slice, and nothing else refers to them.
    #[inline(always)]
    pub unsafe fn slice_mut<'a>(self, first: usize, count: usize) -> &'a mut [T] {
        // SAFETY: the caller's promise.
        unsafe { slice::from_raw_parts_mut(self.first.add(first), count) }
    }
}

/// Whether `n` numbers of `size` bytes, the first at this address, can lie in memory: within [`ADDRESSABLE`] bytes, and without
/// a step over either end of the address space.
#[inline(always)]
fn is_addressable(first: usize, n: usize, stride: isize, size: usize) -> bool {
    let Some(span) = n.saturating_sub(1).checked_mul(stride.unsigned_abs()) else { return false };
    let is_inside = if stride < 0 { span <= first } else { first.checked_add(span).is_some() };
    is_inside && span <= ADDRESSABLE - size
}

#[cold]
fn missing(name: &str, component: &str) -> Failure {
    boundary::null(&format!("request.{name}{component}"))
}

#[cold]
fn overlapping(name: &str, stride: isize, size: usize, may_repeat: bool) -> Failure {
    let zero = if may_repeat { "0, or " } else { "" };
    Failure::invalid(format!(
        "request.{name}.stride is {stride}; it must be {zero}at least {size} bytes, or minus that"
    ))
}

#[cold]
fn endless(name: &str, n: usize, stride: isize) -> Failure {
    Failure::invalid(format!(
        "n is {n}: no memory holds so many elements of request.{name}, at a stride of {stride} bytes"
    ))
}

/// A pair that must be there.
///
/// # Errors
/// As [`Strided::new`].
#[inline(always)]
pub(super) fn pair(name: &str, n: usize, given: &realistic_input) -> Result<[Strided; 2], Failure> {
    let realistic_input { x, y, stride } = *given;
    Ok([
        Strided::new([name, ".x"], n, x.cast_mut(), stride, true)?,
        Strided::new([name, ".y"], n, y.cast_mut(), stride, true)?,
    ])
}

/// Numbers that are read, if they are there.
///
/// # Errors
/// As [`Strided::new`].
#[inline(always)]
pub(super) fn numbers(name: &str, n: usize, given: &realistic_input) -> Result<Strided, Failure> {
    let realistic_input { x, stride, .. } = *given;
    if x.is_null() { Ok(Strided::NONE) } else { Strided::new([name, ".x"], n, x.cast_mut(), stride, true) }
}

/// Room for vectors, which must be there.
///
/// # Errors
/// As [`Strided::new`].
#[inline(always)]
pub(super) fn vectors(name: &str, n: usize, given: &realistic_output) -> Result<[Strided; 3], Failure> {
    let realistic_output { x, y, z, stride } = *given;
    Ok([
        Strided::new([name, ".x"], n, x, stride, false)?,
        Strided::new([name, ".y"], n, y, stride, false)?,
        Strided::new([name, ".z"], n, z, stride, false)?,
    ])
}

/// Room for numbers, if it is there.
///
/// # Errors
/// As [`Strided::new`].
#[inline(always)]
pub(super) fn room(name: &str, n: usize, given: &realistic_output) -> Result<Strided, Failure> {
    if given.x.is_null() { Ok(Strided::NONE) } else { required_room(name, n, given) }
}

/// Room for numbers, which must be there.
///
/// # Errors
/// As [`Strided::new`].
#[inline(always)]
pub(super) fn required_room(name: &str, n: usize, given: &realistic_output) -> Result<Strided, Failure> {
    Strided::new([name, ".x"], n, given.x, given.stride, false)
}

/// Whether numbers lie one after the other in each element.
#[inline(always)]
pub(super) fn are_row(numbers: &[Strided]) -> bool {
    let first = numbers[0];
    let lies = |(k, number): (usize, &Strided)| {
        number.stride == first.stride && number.first == first.first.wrapping_add(k)
    };
    numbers.iter().enumerate().all(lies)
}

/// Whether numbers are to be copied as rows.
#[inline(always)]
fn are_rows(numbers: &[Strided]) -> bool {
    numbers[0].is_there() && !numbers[0].is_slice() && are_row(numbers)
}

/// Copies the numbers of elements `first / shared_by` on, each `shared_by` times, to arrays; those that are slices only
/// where they are shared.
///
/// # Safety
/// They are there.
#[inline(always)]
pub(super) unsafe fn read<const N: usize>(
    numbers: &[Strided; N],
    shared_by: usize,
    first: usize,
    mut to: [&mut [f32]; N],
) {
    let count = to[0].len();
    let mut k = 0;
    while k < N {
        // SAFETY: the caller's promise.
        unsafe {
            if k + FOUR <= N && shared_by == 1 && are_rows(&numbers[k..k + FOUR]) {
                read_rows(numbers[k], first, &mut to[k..k + FOUR]);
                k += FOUR;
            } else {
                if shared_by > 1 || !numbers[k].is_slice() {
                    for (i, to) in to[k][..count].iter_mut().enumerate() {
                        *to =
                            numbers[k].get(if shared_by == 1 { first + i } else { (first + i) / shared_by });
                    }
                }
                k += 1;
            }
        }
    }
}

/// Copies rows of four to four arrays.
///
/// # Safety
/// They are there.
#[inline(always)]
unsafe fn read_rows(rows: Strided, first: usize, to: &mut [&mut [f32]]) {
    let [a, b, c, d] = to else { return };
    let count = a.len();
    // SAFETY: the caller's promise.
    let row = |i: usize| unsafe { rows.at(first + i).cast::<[f32; 4]>().read_unaligned() };
    let whole = count - count % FOUR;
    for i in (0..whole).step_by(FOUR) {
        let [x, y, z, w] = transposed([row(i), row(i + 1), row(i + 2), row(i + 3)]);
        a[i..i + FOUR].copy_from_slice(&x);
        b[i..i + FOUR].copy_from_slice(&y);
        c[i..i + FOUR].copy_from_slice(&z);
        d[i..i + FOUR].copy_from_slice(&w);
    }
    for i in whole..count {
        [a[i], b[i], c[i], d[i]] = row(i);
    }
}

/// Copies arrays to the numbers of elements from `first` on that have a weight; not those that are slices.
///
/// # Safety
/// There is room.
#[inline(always)]
pub(super) unsafe fn write(numbers: &[Strided], first: usize, from: &[&[f32]], weights: &[f32]) {
    let mut k = 0;
    while k < numbers.len() {
        // SAFETY: the caller's promise.
        unsafe {
            if k + FOUR <= numbers.len() && are_rows(&numbers[k..k + FOUR]) {
                write_rows(numbers[k], first, &from[k..k + FOUR], weights);
                k += FOUR;
            } else {
                if numbers[k].is_there() && !numbers[k].is_slice() {
                    for (i, (number, weight)) in from[k].iter().zip(weights).enumerate() {
                        if *weight > 0.0 {
                            numbers[k].put(first + i, *number);
                        }
                    }
                }
                k += 1;
            }
        }
    }
}

/// Copies four arrays to rows of four.
///
/// # Safety
/// There is room.
#[inline(always)]
unsafe fn write_rows(rows: Strided, first: usize, from: &[&[f32]], weights: &[f32]) {
    let [a, b, c, d] = from else { return };
    let count = weights.len();
    let [a, b, c, d] = [&a[..count], &b[..count], &c[..count], &d[..count]];
    // SAFETY: the caller's promise.
    let put = |i: usize, row: [f32; 4]| unsafe {
        rows.at(first + i).cast::<[f32; 4]>().write_unaligned(row);
    };
    let whole = count - count % FOUR;
    for i in (0..whole).step_by(FOUR) {
        if weights[i..i + FOUR].iter().fold(true, |all, weight| all & (*weight > 0.0)) {
            let four = |array: &[f32]| [array[i], array[i + 1], array[i + 2], array[i + 3]];
            let [x, y, z, w] = transposed([four(a), four(b), four(c), four(d)]);
            put(i, x);
            put(i + 1, y);
            put(i + 2, z);
            put(i + 3, w);
        } else {
            (i..i + FOUR).filter(|&i| weights[i] > 0.0).for_each(|i| put(i, [a[i], b[i], c[i], d[i]]));
        }
    }
    (whole..count).filter(|&i| weights[i] > 0.0).for_each(|i| put(i, [a[i], b[i], c[i], d[i]]));
}

/// The rows of a matrix as its columns.
#[inline(always)]
fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}
