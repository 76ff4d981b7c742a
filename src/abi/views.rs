//! Views of a caller's arrays: columns of numbers with any stride, which are checked before anything is read
//! or written.

use std::ptr::{null, null_mut};

use super::{
    boundary::{self, ADDRESSABLE, Failure},
    types::{realistic_input, realistic_output, realistic_vectors},
};
use ::realistic_camera::columns::Strided;

// These constants are here and not with the types, because the header would otherwise export them as macros.
impl realistic_input {
    /// An omitted input.
    pub const NONE: Self = Self { x: null(), y: null(), z: null(), stride: 0 };

    /// Describes elements whose components lie in contiguous arrays: one array for numbers, two for pairs, three
    /// for vectors.
    pub const fn columns<const N: usize>(firsts: [*const f32; N]) -> Self {
        const { assert!(0 < N && N <= 3, "elements have one to three components") };
        let y = if N > 1 { firsts[1] } else { null() };
        let z = if N > 2 { firsts[2] } else { null() };
        Self { x: firsts[0], y, z, stride: size_of::<f32>() as isize }
    }
}

impl realistic_output {
    /// An omitted output.
    pub const NONE: Self = Self { x: null_mut(), y: null_mut(), z: null_mut(), stride: 0 };

    /// Describes elements whose components lie in contiguous arrays: one array for numbers, two for pairs, three
    /// for vectors.
    pub const fn columns<const N: usize>(firsts: [*mut f32; N]) -> Self {
        const { assert!(0 < N && N <= 3, "elements have one to three components") };
        let y = if N > 1 { firsts[1] } else { null_mut() };
        let z = if N > 2 { firsts[2] } else { null_mut() };
        Self { x: firsts[0], y, z, stride: size_of::<f32>() as isize }
    }
}

impl realistic_vectors {
    /// Describes vectors whose components lie in contiguous arrays.
    pub const fn columns([x, y, z]: [*mut f64; 3]) -> Self {
        Self { x, y, z, stride: size_of::<f64>() as isize }
    }
}

/// Returns the components of `n` required elements. `name` is the name of the array in the caller's
/// structure, and `names` are the names of the components.
///
/// # Errors
/// A component is missing, elements overlap (inputs may repeat one element), or no memory can hold that many
/// elements at this stride.
#[inline(always)]
fn components<T: Copy, const N: usize>(
    name: &str,
    names: [&str; N],
    n: usize,
    firsts: [*mut T; N],
    stride: isize,
    may_repeat: bool,
) -> Result<[Strided<T>; N], Failure> {
    let bytes = stride.unsigned_abs();
    if let Some(number) = firsts.iter().position(|first| first.is_null()) {
        return Err(missing(name, names[number]));
    }
    if n > 1 && bytes < size_of::<T>() && !(may_repeat && bytes == 0) {
        return Err(overlapping(name, stride, size_of::<T>(), may_repeat));
    }
    let span = n.saturating_sub(1).checked_mul(bytes).filter(|span| *span <= ADDRESSABLE - size_of::<T>());
    let is_inside = |span: usize, first: usize| {
        if stride < 0 { span <= first } else { first.checked_add(span).is_some() }
    };
    if !span.is_some_and(|span| firsts.iter().all(|first| is_inside(span, first.addr()))) {
        return Err(endless(name, n, stride));
    }
    Ok(firsts.map(|first| Strided::new(first, stride)))
}

#[cold]
fn missing(name: &str, component: &str) -> Failure {
    boundary::null(&format!("{name}{component}"))
}

#[cold]
fn overlapping(name: &str, stride: isize, size: usize, may_repeat: bool) -> Failure {
    let zero = if may_repeat { "0, or " } else { "" };
    Failure::invalid(format!(
        "{name}.stride is {stride}; it must be {zero}at least {size} bytes, or minus that"
    ))
}

#[cold]
fn endless(name: &str, n: usize, stride: isize) -> Failure {
    Failure::invalid(format!(
        "n is {n}: no memory holds so many elements of {name}, at a stride of {stride} bytes"
    ))
}

/// The names of the components of a vector; the first is also used for a plain number.
const XYZ: [&str; 3] = [".x", ".y", ".z"];

/// Returns the columns of a required input: of vectors or, with N of 2 or 1, of pairs or numbers.
///
/// # Errors
/// The errors of [`components`].
#[inline(always)]
pub(super) fn input<const N: usize>(
    name: &str,
    n: usize,
    given: &realistic_input,
) -> Result<[Strided; N], Failure> {
    let firsts = [given.x, given.y, given.z].map(<*const f32>::cast_mut);
    components(name, first_of(XYZ), n, first_of(firsts), given.stride, true)
}

/// Returns the column of input numbers, or a missing column if they are omitted.
///
/// # Errors
/// The errors of [`components`].
#[inline(always)]
pub(super) fn optional_input(name: &str, n: usize, given: &realistic_input) -> Result<Strided, Failure> {
    if given.x.is_null() { Ok(Strided::NONE) } else { input(name, n, given).map(|[numbers]| numbers) }
}

/// Returns the columns of a required output: of vectors or, with N of 2 or 1, of pairs or numbers.
///
/// # Errors
/// The errors of [`components`].
#[inline(always)]
pub(super) fn output<const N: usize>(
    name: &str,
    n: usize,
    given: &realistic_output,
) -> Result<[Strided; N], Failure> {
    components(name, first_of(XYZ), n, first_of([given.x, given.y, given.z]), given.stride, false)
}

/// Returns the columns of an output as [`output`] does, or missing columns if it is omitted.
///
/// # Errors
/// The errors of [`components`].
#[inline(always)]
pub(super) fn optional_output<const N: usize>(
    name: &str,
    n: usize,
    given: &realistic_output,
) -> Result<[Strided; N], Failure> {
    if given.x.is_null() { Ok([Strided::NONE; N]) } else { output(name, n, given) }
}

/// Returns the columns of vectors in double precision.
///
/// # Errors
/// The errors of [`components`].
pub(super) fn vectors(name: &str, n: usize, given: &realistic_vectors) -> Result<[Strided<f64>; 3], Failure> {
    components(name, XYZ, n, [given.x, given.y, given.z], given.stride, false)
}

/// Returns the column of results or counts, one per element, or a missing column if it is omitted.
///
/// # Errors
/// The errors of [`components`].
#[inline(always)]
pub(super) fn optional_column<T: Copy>(
    name: &str,
    n: usize,
    first: *mut T,
    stride: isize,
) -> Result<Strided<T>, Failure> {
    if first.is_null() {
        return Ok(Strided::NONE);
    }
    let [column] = components(name, [""], n, [first], stride, false)?;
    Ok(column)
}

/// Returns the first N of three values.
#[inline(always)]
fn first_of<T: Copy, const N: usize>(all: [T; 3]) -> [T; N] {
    std::array::from_fn(|k| all[k])
}
