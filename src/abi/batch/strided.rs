//! Checked columns of a caller's numbers.

use std::ptr::{null, null_mut};

use super::super::{
    boundary::{self, ADDRESSABLE, Failure},
    types::{realistic_input, realistic_output},
};
use ::realistic_camera::columns::Strided;

// Here and not with the types, because the header would export them as macros.
impl realistic_input {
    /// An omitted input.
    pub const NONE: Self = Self { x: null(), y: null(), stride: 0 };
}

impl realistic_output {
    /// An omitted output.
    pub const NONE: Self = Self { x: null_mut(), y: null_mut(), z: null_mut(), stride: 0 };
}

/// Returns the components of `n` required elements. `name` is their name in a request, `names` the names of the
/// components.
///
/// # Errors
/// A component is missing, its elements overlap (inputs may repeat one element), or no memory holds that many elements
/// at this stride.
#[inline(always)]
pub(in super::super) fn components<T: Copy, const N: usize>(
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

/// Returns the columns of required pairs.
///
/// # Errors
/// As for [`components`].
#[inline(always)]
pub(super) fn pair(name: &str, n: usize, given: &realistic_input) -> Result<[Strided; 2], Failure> {
    let realistic_input { x, y, stride } = *given;
    components(name, [".x", ".y"], n, [x.cast_mut(), y.cast_mut()], stride, true)
}

/// Returns the column of input numbers, or none if they are omitted.
///
/// # Errors
/// As for [`components`].
#[inline(always)]
pub(super) fn numbers(name: &str, n: usize, given: &realistic_input) -> Result<Strided, Failure> {
    let realistic_input { x, stride, .. } = *given;
    if x.is_null() {
        return Ok(Strided::NONE);
    }
    let [numbers] = components(name, [".x"], n, [x.cast_mut()], stride, true)?;
    Ok(numbers)
}

/// Returns the columns of required output vectors.
///
/// # Errors
/// As for [`components`].
#[inline(always)]
pub(super) fn vectors(name: &str, n: usize, given: &realistic_output) -> Result<[Strided; 3], Failure> {
    let realistic_output { x, y, z, stride } = *given;
    components(name, [".x", ".y", ".z"], n, [x, y, z], stride, false)
}

/// Returns the column of output numbers, or none if they are omitted.
///
/// # Errors
/// As for [`components`].
#[inline(always)]
pub(super) fn room(name: &str, n: usize, given: &realistic_output) -> Result<Strided, Failure> {
    if given.x.is_null() { Ok(Strided::NONE) } else { required_room(name, n, given) }
}

/// Returns the column of required output numbers.
///
/// # Errors
/// As for [`components`].
#[inline(always)]
pub(super) fn required_room(name: &str, n: usize, given: &realistic_output) -> Result<Strided, Failure> {
    let [numbers] = components(name, [".x"], n, [given.x], given.stride, false)?;
    Ok(numbers)
}
