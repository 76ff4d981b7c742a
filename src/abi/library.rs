//! What the library is: versions, capabilities, the message of the last failure, and the file it was loaded from.

use std::ffi::c_char;
use std::path::PathBuf;

use super::boundary::{realistic_status, with_last_message};

/// The version of the C ABI that this header describes. It grows when something is added;
/// nothing is ever taken away or renumbered. Version 2 states what version 1 had come to: the fields of
/// `realistic_options` from `camera_to_world_end` on, `realistic_autofocus` and `realistic_camera_plan`; and it
/// adds rays with differentials. Version 3 adds lenses without a film (`realistic_lens_new`),
/// and `focusby` and `zoom`. Version 4 adds rays at a wavelength per sample (`realistic_generate_ray_at`), with
/// differentials too (`realistic_generate_ray_differential_at`), batches of any strides (`realistic_camera_generate_batch`), `crop`, the figure of a surface (`realistic_lens_get_surface`), the points
/// where rays meet the surfaces (`realistic_lens_trace_points`), and importance (`realistic_camera_importance`).
pub const REALISTIC_ABI_VERSION: u32 = 4;

/// The library can be loaded by a pbrt-v1 host (`CreateCamera` is there).
pub const REALISTIC_CAPABILITY_PBRT_V1: u64 = 1;
/// Rays can be asked for many at a time.
pub const REALISTIC_CAPABILITY_BATCH: u64 = 2;
/// Batches tell why a ray is blocked.
pub const REALISTIC_CAPABILITY_REASONS: u64 = 4;
/// The wavelength matters for lenses with V-numbers or Sellmeier's constants.
pub const REALISTIC_CAPABILITY_DISPERSION: u64 = 8;
/// `model` may be "thick", "thin", "perspective", "orthographic" and "environment".
pub const REALISTIC_CAPABILITY_MODELS: u64 = 16;
/// The camera may move (`camera_to_world_end`), and the shutter be other than global.
pub const REALISTIC_CAPABILITY_MOTION: u64 = 32;
/// `realistic_autofocus` is there.
pub const REALISTIC_CAPABILITY_AUTOFOCUS: u64 = 64;
/// `tolerance` and `realistic_camera_plan` are there.
pub const REALISTIC_CAPABILITY_PLAN: u64 = 128;
/// Rays can be asked for with their differentials (`realistic_generate_ray_differential`).
pub const REALISTIC_CAPABILITY_DIFFERENTIALS: u64 = 256;
/// A lens can be opened without a film, and asked what it is (`realistic_lens_new`).
pub const REALISTIC_CAPABILITY_LENS: u64 = 512;
/// `zoom` and `focusby` are there, for lenses whose groups move.
pub const REALISTIC_CAPABILITY_MOVING_GROUPS: u64 = 1024;
/// Rays can be asked for at a wavelength per sample (`realistic_generate_ray_at`).
pub const REALISTIC_CAPABILITY_WAVELENGTHS: u64 = 2048;
/// Cameras can be asked what rays from the scene count, and for directions toward the lens
/// (`realistic_camera_importance`, `realistic_camera_sample_importance`).
pub const REALISTIC_CAPABILITY_IMPORTANCE: u64 = 4096;
/// `crop` is there, and `realistic_camera_get_info` tells the pixels to render.
pub const REALISTIC_CAPABILITY_CROP: u64 = 8192;

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");

/// The `REALISTIC_ABI_VERSION` that the loaded library was built with. A caller works with any
/// library whose number is not below its own header's.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_abi_version() -> u32 {
    REALISTIC_ABI_VERSION
}

/// The library's version, such as "0.1.0"; lives as long as the library.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_version() -> *const c_char {
    VERSION.as_ptr().cast()
}

/// The `REALISTIC_CAPABILITY_` bits of the loaded library.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_capabilities() -> u64 {
    let pbrt = if cfg!(realistic_shim) { REALISTIC_CAPABILITY_PBRT_V1 } else { 0 };
    pbrt | REALISTIC_CAPABILITY_BATCH
        | REALISTIC_CAPABILITY_REASONS
        | REALISTIC_CAPABILITY_DISPERSION
        | REALISTIC_CAPABILITY_MODELS
        | REALISTIC_CAPABILITY_MOTION
        | REALISTIC_CAPABILITY_AUTOFOCUS
        | REALISTIC_CAPABILITY_PLAN
        | REALISTIC_CAPABILITY_DIFFERENTIALS
        | REALISTIC_CAPABILITY_LENS
        | REALISTIC_CAPABILITY_MOVING_GROUPS
        | REALISTIC_CAPABILITY_WAVELENGTHS
        | REALISTIC_CAPABILITY_IMPORTANCE
        | REALISTIC_CAPABILITY_CROP
}

/// The message of this thread's last failure, in one or more lines of UTF-8; empty when there was none. The
/// pointer holds until the thread's next failing call.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_last_error() -> *const c_char {
    with_last_message(|message| message.as_ptr()).unwrap_or(c"".as_ptr())
}

/// What a status means, in a few words; never NULL. Lives as long as the library.
#[unsafe(no_mangle)]
pub extern "C" fn realistic_status_name(status: i32) -> *const c_char {
    let known = realistic_status::ALL.into_iter().find(|&known| known as i32 == status);
    known.map_or(c"unknown status", realistic_status::name).as_ptr()
}

/// The file that this code was loaded from: the plugin's `.so`, as the host named it when
/// it loaded it, or the program when the library is linked into one.
#[cfg(all(unix, not(miri)))]
pub(super) fn plugin_path() -> Option<PathBuf> {
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

/// Not known on this platform, or to Miri, which has no loader.
#[cfg(any(miri, not(unix)))]
pub(super) fn plugin_path() -> Option<PathBuf> {
    None
}

/// The directory of [`plugin_path`], where lens files are looked for last.
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
