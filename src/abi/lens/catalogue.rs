//! The names of the built-in lenses, as text.

use std::ffi::c_char;

use super::super::{
    boundary::{self, realistic_status},
    exchange::give_text,
};
use crate::prescription::catalogue;

/// Copies the names of the built-in lenses, each of which `specfile` may be, the default's first, a newline between two: see
/// `realistic_camera_get_lens_name` for `buffer`, `capacity` and `length`.
///
/// # Safety
/// `buffer` has `capacity` writable bytes; `length` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_catalogue(
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> realistic_status {
    let names: Vec<&str> = catalogue::names().collect();
    // SAFETY: the caller's promise.
    boundary::status(|| unsafe { give_text(&names.join("\n"), buffer, capacity, length) })
}
