//! Columns of numbers of a caller, checked.

use std::ptr::{null, null_mut};

use super::super::{
    boundary::{self, ADDRESSABLE, Failure},
    types::{realistic_input, realistic_output},
};
use crate::camera::columns::Strided;

// Here and not with the types, for the header would have them as macros.
impl realistic_input {
    /// What is left out.
    pub const NONE: Self = Self { x: null(), y: null(), stride: 0 };
}

impl realistic_output {
    /// What is left out.
    pub const NONE: Self = Self { x: null_mut(), y: null_mut(), z: null_mut(), stride: 0 };
}

/// The components of `n` elements, which must be there; `name` is theirs in a request, with the names of the components.
///
/// # Errors
/// One is not, two numbers overlap (though those that are read may be one), or no memory holds so many at this stride.
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

/// A pair that must be there.
///
/// # Errors
/// As [`components`].
#[inline(always)]
pub(super) fn pair(name: &str, n: usize, given: &realistic_input) -> Result<[Strided; 2], Failure> {
    let realistic_input { x, y, stride } = *given;
    components(name, [".x", ".y"], n, [x.cast_mut(), y.cast_mut()], stride, true)
}

/// Numbers that are read, if they are there.
///
/// # Errors
/// As [`components`].
#[inline(always)]
pub(super) fn numbers(name: &str, n: usize, given: &realistic_input) -> Result<Strided, Failure> {
    let realistic_input { x, stride, .. } = *given;
    if x.is_null() {
        return Ok(Strided::NONE);
    }
    let [numbers] = components(name, [".x"], n, [x.cast_mut()], stride, true)?;
    Ok(numbers)
}

/// Room for vectors, which must be there.
///
/// # Errors
/// As [`components`].
#[inline(always)]
pub(super) fn vectors(name: &str, n: usize, given: &realistic_output) -> Result<[Strided; 3], Failure> {
    let realistic_output { x, y, z, stride } = *given;
    components(name, [".x", ".y", ".z"], n, [x, y, z], stride, false)
}

/// Room for numbers, if it is there.
///
/// # Errors
/// As [`components`].
#[inline(always)]
pub(super) fn room(name: &str, n: usize, given: &realistic_output) -> Result<Strided, Failure> {
    if given.x.is_null() { Ok(Strided::NONE) } else { required_room(name, n, given) }
}

/// Room for numbers, which must be there.
///
/// # Errors
/// As [`components`].
#[inline(always)]
pub(super) fn required_room(name: &str, n: usize, given: &realistic_output) -> Result<Strided, Failure> {
    let [numbers] = components(name, [".x"], n, [given.x], given.stride, false)?;
    Ok(numbers)
}
