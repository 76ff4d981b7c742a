//! The names of the built-in lenses, as text.

use std::ffi::c_char;

use super::super::{
    boundary::{self, realistic_status},
    exchange::give_text,
};
use realistic_optics::prescription::catalogue;

/// Copies the names of the built-in lenses, one per line, beginning with that of the default lens. Each name
/// is a valid `lens_file`.
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
