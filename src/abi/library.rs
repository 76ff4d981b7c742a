//! Information about the library: versions, capabilities, the message of the last failure, and the file from
//! which it was loaded.

use std::ffi::c_char;
use std::path::PathBuf;

use super::boundary::{realistic_status, with_last_message};

/// The version of the C ABI that this header describes. It grows with each addition; nothing that was released is
/// removed or renumbered.
pub const REALISTIC_ABI_VERSION: u32 = 1;

/// A bit of `realistic_capabilities`: a pbrt-v1 host can load the library, because it exports `CreateCamera`.
pub const REALISTIC_CAPABILITY_PBRT_V1: u64 = 1;

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");

/// Returns the `REALISTIC_ABI_VERSION` of the loaded library. A caller works with any library whose version
/// is at least the version in the caller's header.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_abi_version() -> u32 {
    REALISTIC_ABI_VERSION
}

/// Returns the library's version, such as "0.1.0". The text lives as long as the library.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_version() -> *const c_char {
    VERSION.as_ptr().cast()
}

/// Returns the optional features of the loaded library as `REALISTIC_CAPABILITY_` bits.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_capabilities() -> u64 {
    if cfg!(realistic_shim) { REALISTIC_CAPABILITY_PBRT_V1 } else { 0 }
}

/// Returns the message of the last failure on this thread, one or more lines; empty if there was none. The
/// text is valid until the next failure on this thread.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_last_error() -> *const c_char {
    with_last_message(|message| message.as_ptr()).unwrap_or(c"".as_ptr())
}

/// Returns the meaning of a status in a few words; never NULL. The text lives as long as the library.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_status_name(status: i32) -> *const c_char {
    let known = realistic_status::ALL.into_iter().find(|&known| known as i32 == status);
    known.map_or(c"unknown status", realistic_status::name).as_ptr()
}

/// Returns the file from which this code was loaded: the plugin's `.so`, under the name by which the host
/// loaded it, or the program if the library is linked into one.
#[cfg(all(unix, not(miri)))]
pub(super) fn plugin_path() -> Option<PathBuf> {
    use std::ffi::{CStr, OsStr, c_void};
    use std::os::unix::ffi::OsStrExt;
    use std::ptr::{null, null_mut};

    let mut info =
        libc::Dl_info { dli_fname: null(), dli_fbase: null_mut(), dli_sname: null(), dli_saddr: null_mut() };
    let inside: fn() -> Option<PathBuf> = plugin_path;
    // SAFETY: any address is allowed; the result is written to `info`.
    let known = unsafe { libc::dladdr(inside as *const c_void, &mut info) };
    if known == 0 || info.dli_fname.is_null() {
        return None;
    }
    // SAFETY: the name ends in NUL and is valid while this code is loaded.
    let name = unsafe { CStr::from_ptr(info.dli_fname) };
    Some(PathBuf::from(OsStr::from_bytes(name.to_bytes())))
}

/// Returns `None`, because the file is unknown on this platform and in Miri, which has no loader.
#[cfg(any(miri, not(unix)))]
pub(super) fn plugin_path() -> Option<PathBuf> {
    None
}

/// Returns the directory of [`plugin_path`], which is the last one to be searched for lens files.
pub(super) fn plugin_directory() -> Option<PathBuf> {
    plugin_path()?.parent().map(PathBuf::from)
}

#[cfg(all(test, target_os = "linux", not(miri)))]
mod tests {
    #[test]
    fn linked_into_a_program_it_is_the_program() {
        let path = super::plugin_path().unwrap();
        let program = std::env::current_exe().unwrap();
        assert_eq!(path.file_name(), program.file_name());
    }
}
