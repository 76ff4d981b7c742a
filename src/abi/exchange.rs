//! What is copied between this library and a caller's memory: structures that may grow, which begin with `struct_size`,
//! the bytes that the caller knows; and texts.

use std::ffi::c_char;

use super::boundary::{self, Failure, realistic_status};

/// Whether a caller's structure is one that this library knows: of `first` bytes, the first version's, to `current`.
///
/// # Errors
/// It is not; what to set.
pub(super) fn check_size(what: &str, given: u32, first: usize, current: usize) -> Result<(), Failure> {
    let size = given as usize;
    if size < first {
        return Err(Failure::new(
            realistic_status::StructSize,
            format!("{what}.struct_size is {size}; set it to sizeof({what}), {current} in this library"),
        ));
    }
    if size > current {
        return Err(Failure::new(
            realistic_status::StructSize,
            format!(
                "{what}.struct_size is {size}, and this library knows {current} bytes: it is older than \
                 the header that the caller was compiled with"
            ),
        ));
    }
    Ok(())
}

/// Copies as much of `filled` as the caller's structure has room for; its own `struct_size` stays. `first`: the bytes of
/// the structure's first version.
///
/// # Errors
/// `out` is NULL (named `name`), or its size none that this library knows.
///
/// # Safety
/// `T` begins with a `u32`, its size; `out` is NULL or points to a structure of its `struct_size` bytes.
pub(super) unsafe fn give<T>(
    what: &str,
    first: usize,
    filled: &T,
    name: &str,
    out: *mut T,
) -> Result<(), Failure> {
    // SAFETY: the caller's promise; the check allows no more than `filled` has.
    unsafe {
        let size = known_size(what, first, name, out)?;
        let skipped = size_of::<u32>();
        let from = std::ptr::from_ref(filled).cast::<u8>();
        std::ptr::copy_nonoverlapping(from.add(skipped), out.cast::<u8>().add(skipped), size - skipped);
    }
    Ok(())
}

/// A caller's structure, of which there is one version.
///
/// # Errors
/// As [`give`].
///
/// # Safety
/// As there, and any bytes are a `T`.
pub(super) unsafe fn take<T: Copy>(what: &str, name: &str, given: *const T) -> Result<T, Failure> {
    // SAFETY: the caller's promise; the size is this version's.
    unsafe {
        known_size(what, size_of::<T>(), name, given)?;
        Ok(given.read_unaligned())
    }
}

/// # Safety
/// As [`give`].
unsafe fn known_size<T>(what: &str, first: usize, name: &str, at: *const T) -> Result<usize, Failure> {
    if at.is_null() {
        return Err(boundary::null(name));
    }
    // SAFETY: not NULL; the first field is always there.
    let size = unsafe { at.cast::<u32>().read_unaligned() };
    check_size(what, size, first, size_of::<T>())?;
    Ok(size as usize)
}

/// Refuses a caller's structure of which one of these arrays is NULL.
#[inline(always)]
pub(super) fn required_arrays<T, const N: usize>(
    structure: &str,
    names: [&str; N],
    arrays: [*const T; N],
) -> Result<(), Failure> {
    match arrays.iter().position(|array| array.is_null()) {
        Some(number) => Err(boundary::null(&format!("{structure}.{}", names[number]))),
        None => Ok(()),
    }
}

/// Copies a text with a closing NUL, cut to `capacity` bytes, and writes its whole length without the NUL.
///
/// # Safety
/// `buffer` is NULL or has `capacity` writable bytes; `length` is NULL or writable.
pub(super) unsafe fn give_text(
    text: &str,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Result<(), Failure> {
    if buffer.is_null() && capacity > 0 {
        return Err(boundary::null("buffer"));
    }
    if let Some(room) = capacity.checked_sub(1) {
        let cut = text.floor_char_boundary(room);
        // SAFETY: `cut` and the NUL fit into `capacity`.
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr(), buffer.cast::<u8>(), cut);
            buffer.add(cut).write(0);
        }
    }
    if !length.is_null() {
        // SAFETY: the caller's promise.
        unsafe { length.write(text.len()) };
    }
    Ok(())
}
