//! Copies between this library and a caller's memory: texts, and structures that begin with their
//! `struct_size`.

use std::{ffi::c_char, mem::MaybeUninit};

use super::boundary::{self, Failure, realistic_status};

/// Checks that a caller's structure has the size that this library expects.
///
/// # Errors
/// The size differs; the message states which size to set.
#[inline(always)]
pub(super) fn check_size(what: &str, given: u32, current: usize) -> Result<(), Failure> {
    if given as usize == current { Ok(()) } else { Err(other_size(what, given, current)) }
}

#[cold]
fn other_size(what: &str, given: u32, current: usize) -> Failure {
    let message = if (given as usize) < current {
        format!("{what}.struct_size is {given}; set it to sizeof({what}), {current} in this library")
    } else {
        format!(
            "{what}.struct_size is {given}, and this library knows {current} bytes: it is older than the header that \
             the caller was compiled with"
        )
    };
    Failure::new(realistic_status::StructSize, message)
}

/// Fills a caller's structure whose `struct_size` is set.
///
/// # Errors
/// `out` is NULL (the message calls it `name`), or the structure's size differs.
///
/// # Safety
/// `T` begins with a `u32` that states its size; `out` is NULL or points to a structure of `struct_size`
/// bytes.
pub(super) unsafe fn give<T>(what: &str, filled: T, name: &str, out: *mut T) -> Result<(), Failure> {
    // SAFETY: the caller's promise; `check` ensures that the size is that of `T`.
    unsafe {
        check(what, name, out)?;
        out.write_unaligned(filled);
    }
    Ok(())
}

/// Reads a caller's structure.
///
/// # Errors
/// The errors of [`give`].
///
/// # Safety
/// The promises of [`give`]; also, any bytes are a valid `T`.
#[inline(always)]
pub(super) unsafe fn take<T: Copy>(what: &str, name: &str, given: *const T) -> Result<T, Failure> {
    // SAFETY: the caller's promise; `check` ensures that the size is that of `T`.
    unsafe {
        check(what, name, given)?;
        Ok(given.read_unaligned())
    }
}

/// Borrows a caller's structure in place, or copies it to `copy` if it is misaligned. This is for structures
/// that are so large that copying takes noticeable time.
///
/// # Errors
/// The errors of [`give`].
///
/// # Safety
/// The promises of [`take`]; also, nobody writes to the structure while it is borrowed.
#[inline(always)]
pub(super) unsafe fn borrow<'a, T: Copy>(
    what: &str,
    name: &str,
    given: *const T,
    copy: &'a mut MaybeUninit<T>,
) -> Result<&'a T, Failure> {
    // SAFETY: the caller's promise; `check` ensures that the size is that of `T`.
    unsafe {
        check(what, name, given)?;
        Ok(if given.is_aligned() { &*given } else { copy.write(given.read_unaligned()) })
    }
}

/// # Safety
/// The promises of [`give`].
#[inline(always)]
unsafe fn check<T>(what: &str, name: &str, at: *const T) -> Result<(), Failure> {
    if at.is_null() {
        return Err(boundary::null(name));
    }
    // SAFETY: the pointer is not NULL, and the first field is always present.
    check_size(what, unsafe { at.cast::<u32>().read_unaligned() }, size_of::<T>())
}

/// Copies a text with a terminating NUL, truncated to `capacity` bytes, and writes its full length without
/// the NUL.
///
/// # Errors
/// `buffer` is NULL, but `capacity` is not 0.
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
