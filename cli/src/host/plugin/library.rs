//! The loaded library and its functions, which are resolved by name.

use crate::failure::Failure;
use libloading::Library;
use realistic::ffi::realistic_request;
use realistic::ffi::realistic_status;
use realistic::ffi::{REALISTIC_ABI_VERSION, realistic_camera, realistic_camera_info, realistic_options};
use realistic::ffi::{realistic_aimed, realistic_importance, realistic_scene_points};
use realistic::ffi::{realistic_contrast, realistic_distance, realistic_zone};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::error::Error as _;
use std::ffi::{CStr, c_char, c_void};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// An error of a plugin or a camera.
#[derive(Debug, Error)]
pub enum PluginError {
    /// The file is in none of the searched locations.
    #[error(
        "the plugin was not found; looked for {searched}. In the project's folder `cargo build --release -p realistic` \
         makes it as target/release/{}: put it into one of these places, or name it by --plugin or REALISTIC_PLUGIN",
        file_name()
    )]
    NotFound {
        /// The searched locations, in order.
        searched: String,
    },
    /// The loader rejects the file, or the file lacks a function.
    #[error(
        "cannot load the plugin {path}: {reason}. `cargo build --release -p realistic` makes a fresh one"
    )]
    Load {
        /// The file.
        path: String,
        /// The loader's message.
        reason: String,
    },
    /// The plugin lacks functions that later versions of the ABI added.
    #[error(
        "the plugin {path} speaks version {found} of the C ABI and this program needs version \
         {REALISTIC_ABI_VERSION} or later: `cargo build --release -p realistic` makes a fresh one, and --plugin PATH names another"
    )]
    Version {
        /// The file.
        path: String,
        /// Version that the file reports.
        found: u32,
    },
    /// The plugin's message for a failed call.
    #[error("{0}")]
    Refused(String),
    /// The plugin's message for a focus that the lens does not reach.
    #[error("{0}")]
    Unreachable(String),
    /// The plugin's message for invalid parameters.
    #[error("{0}")]
    Invalid(String),
}

/// Returns the file name that cargo gives the plugin.
pub fn file_name() -> String {
    format!("{DLL_PREFIX}realistic{DLL_SUFFIX}")
}

impl From<PluginError> for Failure {
    fn from(error: PluginError) -> Self {
        let message = error.to_string();
        match error {
            PluginError::Invalid(_) => Self::Usage(message),
            _ => Self::Other(message),
        }
    }
}

macro_rules! functions {
    ($($name:ident: $symbol:literal, fn($($type:ty),*) $(-> $result:ty)?;)*) => {
        /// The exported functions, valid for as long as the library stays loaded.
        pub struct Functions { $(pub $name: unsafe extern "C" fn($($type),*) $(-> $result)?,)* }

        impl Functions {
            /// # Safety
            /// The library's functions of these names have these signatures.
            unsafe fn resolve(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: the caller's promise; the table is kept beside the library.
                unsafe { Ok(Self { $($name: *library.get($symbol)?,)* }) }
            }
        }
    };
}

functions! {
    version: b"realistic_version", fn() -> *const c_char;
    last_error: b"realistic_last_error", fn() -> *const c_char;
    options_init: b"realistic_options_init", fn(*mut realistic_options, u32) -> i32;
    camera_new: b"realistic_camera_new",
        fn(*const realistic_options, *mut *mut realistic_camera) -> i32;
    camera_free: b"realistic_camera_free", fn(*mut realistic_camera);
    camera_get_info: b"realistic_camera_get_info",
        fn(*const realistic_camera, *mut realistic_camera_info) -> i32;
    camera_get_lens_name: b"realistic_camera_get_lens_name",
        fn(*const realistic_camera, *mut c_char, usize, *mut usize) -> i32;
    camera_generate_batch: b"realistic_camera_generate_batch",
        fn(*const realistic_camera, usize, *const realistic_request) -> i32;
    camera_sample_importance: b"realistic_camera_sample_importance",
        fn(*const realistic_camera, usize, *const realistic_scene_points, *const realistic_aimed,
           *const realistic_importance) -> i32;
    autofocus: b"realistic_autofocus",
        fn(*const realistic_options, *const realistic_zone, usize, i32, realistic_distance,
           realistic_contrast, *mut c_void, *mut f64) -> i32;
}

/// A loaded plugin. Cameras and autofocus call its functions.
pub struct Plugin {
    pub functions: Functions,
    path: PathBuf,
    // The last field is dropped last, because the functions live in the library.
    _library: Library,
}

impl Plugin {
    /// Loads a plugin and checks that its ABI is this host's version or a later one; later versions only add
    /// functions.
    ///
    /// # Errors
    /// The loader rejects the file, a function is missing, or the plugin's ABI is older than this host's.
    pub fn load(path: &Path) -> Result<Self, PluginError> {
        let name = path.display().to_string();
        let failed = |error: libloading::Error| PluginError::Load {
            path: name.clone(),
            // The outer error names only the loader's function.
            reason: error.source().map_or(error.to_string(), ToString::to_string),
        };
        // The loader would search the system's directories for a path without a slash.
        let exact = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        // SAFETY: loading runs the library's initialisers, which are those of Rust; the user named or built this
        // file.
        let library = unsafe { Library::new(exact) }.map_err(failed)?;
        // SAFETY: every version of the ABI keeps this signature.
        let found = unsafe {
            let abi_version =
                library.get::<unsafe extern "C" fn() -> u32>(b"realistic_abi_version").map_err(failed)?;
            abi_version()
        };
        if !is_served_by(found) {
            return Err(PluginError::Version { path: name, found });
        }
        // SAFETY: the version guarantees the functions of the header with its signatures.
        let functions = unsafe { Functions::resolve(&library) }.map_err(failed)?;
        Ok(Self { functions, path: path.to_path_buf(), _library: library })
    }

    /// Returns the path of the loaded file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the plugin's own version.
    pub fn version(&self) -> String {
        // SAFETY: a static string that ends in NUL.
        unsafe { text((self.functions.version)()) }
    }

    /// Converts a call's status to a result with the plugin's own message.
    pub fn check(&self, status: i32) -> Result<(), PluginError> {
        if status == 0 {
            return Ok(());
        }
        // SAFETY: the message lives until this thread's next call.
        let message = unsafe { text((self.functions.last_error)()) };
        let message = match message.as_str() {
            "" => format!("the plugin failed with status {status} and gave no message"),
            _ => message,
        };
        Err(match status {
            _ if status == realistic_status::InvalidParameter as i32 => PluginError::Invalid(message),
            _ if status == realistic_status::UnreachableFocus as i32 => PluginError::Unreachable(message),
            _ => PluginError::Refused(message),
        })
    }
}

/// Whether version `found` of the ABI has all functions that this host calls.
fn is_served_by(found: u32) -> bool {
    found >= REALISTIC_ABI_VERSION
}

/// # Safety
/// `pointer` is NULL or a string that ends in NUL.
pub unsafe fn text(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_later_abi_serves_and_an_older_one_does_not() {
        assert!(is_served_by(REALISTIC_ABI_VERSION) && is_served_by(REALISTIC_ABI_VERSION + 1));
        assert!(!is_served_by(REALISTIC_ABI_VERSION - 1));
    }

    #[test]
    fn what_is_no_library_is_refused_with_its_name() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = Plugin::load(file.path()).err().unwrap().to_string();
        assert!(error.contains("cannot load the plugin"), "{error}");
    }
}
