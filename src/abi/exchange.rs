//! Copies between this library and a caller's memory: structures, which begin with their `struct_size`, and texts.

use std::{ffi::c_char, mem::MaybeUninit};

use super::boundary::{self, Failure, realistic_status};

/// Checks that a caller's structure has this library's size.
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

/// Fills a caller's structure, which has its `struct_size` set.
///
/// # Errors
/// `out` is NULL (`name` in the message), or its size differs.
///
/// # Safety
/// `T` begins with a `u32`, its size; `out` is NULL or points to a structure of its `struct_size` bytes.
pub(super) unsafe fn give<T>(what: &str, filled: T, name: &str, out: *mut T) -> Result<(), Failure> {
    // SAFETY: the caller's promise; the size is this structure's.
    unsafe {
        check(what, name, out)?;
        out.write_unaligned(filled);
    }
    Ok(())
}

/// Reads a caller's structure.
///
/// # Errors
/// As for [`give`].
///
/// # Safety
/// As for [`give`], and any bytes are a valid `T`.
#[inline(always)]
pub(super) unsafe fn take<T: Copy>(what: &str, name: &str, given: *const T) -> Result<T, Failure> {
    // SAFETY: the caller's promise; the size is this structure's.
    unsafe {
        check(what, name, given)?;
        Ok(given.read_unaligned())
    }
}

/// Borrows a caller's structure in place, or copies it to `copy` if it is misaligned. For structures so large that
/// copying takes noticeable time.
///
/// # Errors
/// As for [`give`].
///
/// # Safety
/// As for [`take`], and nobody writes the structure while it is borrowed.
#[inline(always)]
pub(super) unsafe fn borrow<'a, T: Copy>(
    what: &str,
    name: &str,
    given: *const T,
    copy: &'a mut MaybeUninit<T>,
) -> Result<&'a T, Failure> {
    // SAFETY: the caller's promise; the size is this structure's.
    unsafe {
        check(what, name, given)?;
        Ok(if given.is_aligned() { &*given } else { copy.write(given.read_unaligned()) })
    }
}

/// # Safety
/// As for [`give`].
#[inline(always)]
unsafe fn check<T>(what: &str, name: &str, at: *const T) -> Result<(), Failure> {
    if at.is_null() {
        return Err(boundary::null(name));
    }
    // SAFETY: not NULL; the first field is always there.
    check_size(what, unsafe { at.cast::<u32>().read_unaligned() }, size_of::<T>())
}

/// Copies a text with a closing NUL, cut to `capacity` bytes, and writes its full length without the NUL.
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
