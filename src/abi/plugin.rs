//! Where this library was loaded from.

use std::path::PathBuf;

/// The file that this code was loaded from: the plugin's `.so`, as the host named it when
/// it loaded it, or the program when the library is linked into one.
#[cfg(unix)]
pub fn plugin_path() -> Option<PathBuf> {
    use std::ffi::{CStr, OsStr, c_void};
    use std::os::unix::ffi::OsStrExt;
    use std::ptr::{null, null_mut};

    let mut info =
        libc::Dl_info { dli_fname: null(), dli_fbase: null_mut(), dli_sname: null(), dli_saddr: null_mut() };
    let inside: fn() -> Option<PathBuf> = plugin_path;
    // SAFETY: any address will do; the answer is written to `info`.
    let known = unsafe { libc::dladdr(inside as *const c_void, &mut info) };
    if known == 0 || info.dli_fname.is_null() {
        return None;
    }
    // SAFETY: a NUL-terminated name that lives while this code is loaded.
    let name = unsafe { CStr::from_ptr(info.dli_fname) };
    Some(PathBuf::from(OsStr::from_bytes(name.to_bytes())))
}

/// Not known on this platform.
#[cfg(not(unix))]
pub fn plugin_path() -> Option<PathBuf> {
    None
}

/// The directory of that file, where lens files are looked for last.
pub fn directory() -> Option<PathBuf> {
    plugin_path()?.parent().map(PathBuf::from)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn linked_into_a_program_it_is_the_program() {
        let path = super::plugin_path().unwrap();
        let program = std::env::current_exe().unwrap();
        assert_eq!(path.file_name(), program.file_name());
    }
}
