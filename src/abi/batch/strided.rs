//! Numbers of a caller, one per element, at any distance from each other: lent as slices where they lie side by side,
//! copied in and out where they do not. Four numbers that lie one after the other in each element, as in structures and
//! tables of rows, are moved at once: four elements are a 4 x 4 matrix, transposed in registers.

use std::{
    mem::MaybeUninit,
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

    /// The components of `n` elements, which must be there; `name` is theirs in a request, with the names of the components.
    ///
    /// # Errors
    /// One is not, two numbers overlap (though those that are read may be one), or no memory holds so many at this stride.
    #[inline(always)]
    pub fn components<const N: usize>(
        name: &str,
        names: [&str; N],
        n: usize,
        firsts: [*mut T; N],
        stride: isize,
        may_repeat: bool,
    ) -> Result<[Self; N], Failure> {
        let bytes = stride.unsigned_abs();
        if let Some(number) = firsts.iter().position(|first| first.is_null()) {
            return Err(missing(name, names[number]));
        }
        if n > 1 && bytes < size_of::<T>() && !(may_repeat && bytes == 0) {
            return Err(overlapping(name, stride, size_of::<T>(), may_repeat));
        }
        let span =
            n.saturating_sub(1).checked_mul(bytes).filter(|span| *span <= ADDRESSABLE - size_of::<T>());
        let is_inside = |span: usize, first: usize| {
            if stride < 0 { span <= first } else { first.checked_add(span).is_some() }
        };
        if !span.is_some_and(|span| firsts.iter().all(|first| is_inside(span, first.addr()))) {
            return Err(endless(name, n, stride));
        }
        Ok(firsts.map(|first| Self { first, stride }))
    }

    /// `n` numbers, as [`Strided::components`].
    ///
    /// # Errors
    /// As there.
    #[inline(always)]
    pub fn new(
        [name, component]: [&str; 2],
        n: usize,
        first: *mut T,
        stride: isize,
        may_repeat: bool,
    ) -> Result<Self, Failure> {
        let [numbers] = Self::components(name, [component], n, [first], stride, may_repeat)?;
        Ok(numbers)
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

    /// The numbers from number `i` on.
    #[inline(always)]
    fn from(self, i: usize) -> Self {
        Self { first: self.at(i), ..self }
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

    /// Whether nothing has to be copied: a slice, or nothing at all.
    #[inline(always)]
    pub fn is_slice_or_none(self) -> bool {
        self.is_slice() || !self.is_there()
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
    Strided::components(name, [".x", ".y"], n, [x.cast_mut(), y.cast_mut()], stride, true)
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
    Strided::components(name, [".x", ".y", ".z"], n, [x, y, z], stride, false)
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
    mut to: [&mut [MaybeUninit<f32>]; N],
) {
    let mut k = 0;
    while k < N {
        // SAFETY: the caller's promise.
        unsafe {
            if k + FOUR <= N && shared_by == 1 && are_rows(&numbers[k..k + FOUR]) {
                read_rows(numbers[k], first, &mut to[k..k + FOUR]);
                k += FOUR;
            } else {
                if shared_by > 1 {
                    let element = |i: usize| (first + i) / shared_by;
                    to[k].iter_mut().enumerate().for_each(|(i, to)| _ = to.write(numbers[k].get(element(i))));
                } else if !numbers[k].is_slice() {
                    to[k].iter_mut().enumerate().for_each(|(i, to)| _ = to.write(numbers[k].get(first + i)));
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
unsafe fn read_rows(rows: Strided, first: usize, to: &mut [&mut [MaybeUninit<f32>]]) {
    let [a, b, c, d] = to else { return };
    let (a, b, c, d) = (&mut **a, &mut **b, &mut **c, &mut **d);
    let count = a.len();
    // SAFETY: the caller's promise.
    let row = |from: Strided, k: usize| unsafe { from.at(k).cast::<[f32; FOUR]>().read_unaligned() };
    let set = |four: [f32; FOUR]| four.map(MaybeUninit::new);
    let whole = count - count % FOUR;
    let mut from = rows.from(first);
    for i in (0..whole).step_by(FOUR) {
        let [x, y, z, w] = transposed([row(from, 0), row(from, 1), row(from, 2), row(from, 3)]);
        a[i..i + FOUR].copy_from_slice(&set(x));
        b[i..i + FOUR].copy_from_slice(&set(y));
        c[i..i + FOUR].copy_from_slice(&set(z));
        d[i..i + FOUR].copy_from_slice(&set(w));
        from = from.from(FOUR);
    }
    for i in whole..count {
        [a[i], b[i], c[i], d[i]] = set(row(rows, first + i));
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
                    write_numbers(numbers[k], first, from[k], weights);
                }
                k += 1;
            }
        }
    }
}

/// Copies an array to the numbers of elements that have a weight.
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

#[inline(always)]
fn are_positive(four: &[f32]) -> bool {
    four.iter().fold(true, |all, weight| all & (*weight > 0.0))
}

/// The rows of a matrix as its columns.
#[inline(always)]
fn transposed(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols_array_2d(&rows).transpose().to_cols_array_2d()
}
