//! Access to a host's objects through the C++ part: the functions of `pbrt-shim/shim.h` and thin wrappers
//! around them. The cameras that the C++ part makes are in `abi/object`.

use std::ffi::{c_char, c_void};
use std::path::PathBuf;
use std::ptr::{NonNull, null};
use std::slice;

use crate::abi::boundary::{self, Failure, realistic_status};
use crate::abi::types::level_number;
use ::realistic_camera::Level;

/// The structure `realistic_shim_found` of `pbrt-shim/shim.h`.
#[repr(C)]
struct RawFound {
    count: i32,
    boolean: i32,
    floats: *const f32,
    integers: *const i32,
    text: *const c_char,
    text_size: usize,
}

const FLOAT: i32 = 0;
const INT: i32 = 1;
const BOOL: i32 = 2;
const STRING: i32 = 3;

const PARAMETERS: i32 = 0;
const SCENE_FILE: i32 = 1;

const ABSENT: i32 = 0;
const FOUND: i32 = 1;
const NO_HOST: i32 = 2;

unsafe extern "C" {
    fn realistic_shim_transform(transform: *const c_void, matrix: *mut f32, inverse: *mut f32) -> i32;
    fn realistic_shim_film_resolution(film: *const c_void, x: *mut i32, y: *mut i32) -> i32;
    fn realistic_shim_find(
        params: *const c_void,
        kind: i32,
        name: *const c_char,
        name_size: usize,
        out: *mut RawFound,
    ) -> i32;
    fn realistic_shim_text(
        params: *const c_void,
        which: i32,
        take: unsafe extern "C" fn(*mut c_void, *const c_char, usize),
        user: *mut c_void,
    ) -> i32;
    fn realistic_shim_message(level: i32, text: *const c_char);
}

/// The floats of a host's transform, as row-major matrices for column vectors.
pub struct Transform {
    /// The matrix.
    pub matrix: [f32; 16],
    /// The inverse of `matrix`, as the host computed it.
    pub inverse: [f32; 16],
}

/// Reads a host's `Transform`; `None` if a pointer in it is NULL.
///
/// # Safety
/// `transform` is NULL or points to a pbrt-v1 `Transform`.
pub unsafe fn transform(transform: *const c_void) -> Option<Transform> {
    let mut read = Transform { matrix: [0.0; 16], inverse: [0.0; 16] };
    // SAFETY: the caller's promise; both arrays have room for 16 floats.
    let done =
        unsafe { realistic_shim_transform(transform, read.matrix.as_mut_ptr(), read.inverse.as_mut_ptr()) };
    (done != 0).then_some(read)
}

/// Reads the x and y resolution of a host's `Film`; `None` for NULL.
///
/// # Safety
/// `film` is NULL or points to a pbrt-v1 `Film`.
pub unsafe fn film_resolution(film: *const c_void) -> Option<(i32, i32)> {
    let (mut x, mut y) = (0, 0);
    // SAFETY: the caller's promise.
    let done = unsafe { realistic_shim_film_resolution(film, &mut x, &mut y) };
    (done != 0).then_some((x, y))
}

/// A kind of value in a host's scene file, as the file spells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostKind {
    /// `"float name" 1.5`
    Float,
    /// `"integer name" 1`
    Integer,
    /// `"bool name" "true"`
    Bool,
    /// `"string name" "text"`
    String,
}

impl HostKind {
    /// Every kind of value that a scene may give for a parameter of this library.
    pub const ALL: [Self; 4] = [Self::Float, Self::Integer, Self::Bool, Self::String];

    /// Returns the word for this kind in a scene file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Integer => "integer",
            Self::Bool => "bool",
            Self::String => "string",
        }
    }
}

/// The values that a scene gives for one name and kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given<'a> {
    /// The floats.
    Floats(&'a [f32]),
    /// The integers.
    Integers(&'a [i32]),
    /// The number of booleans, and the first of them.
    Bools(usize, bool),
    /// The number of strings, and the bytes of the first of them.
    Strings(usize, &'a [u8]),
}

impl Given<'_> {
    /// Returns the number of values.
    pub fn count(&self) -> usize {
        match *self {
            Self::Floats(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Bools(count, _) | Self::Strings(count, _) => count,
        }
    }
}

/// A host's parameter set, valid during one call.
#[derive(Clone, Copy)]
pub struct ParamSet<'a> {
    pointer: NonNull<c_void>,
    host: std::marker::PhantomData<&'a ()>,
}

impl<'a> ParamSet<'a> {
    /// Wraps a host's parameter set; `None` for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to a pbrt-v1 `ParamSet` that does not change for `'a`.
    pub unsafe fn new(pointer: *const c_void) -> Option<Self> {
        NonNull::new(pointer.cast_mut()).map(|pointer| Self { pointer, host: std::marker::PhantomData })
    }

    /// Looks up `name` among the values of one kind; the host then counts it as used.
    ///
    /// # Errors
    /// The process lacks the host's functions, or memory is exhausted.
    pub fn find(&self, name: &str, kind: HostKind) -> Result<Option<Given<'a>>, Failure> {
        let number = match kind {
            HostKind::Float => FLOAT,
            HostKind::Integer => INT,
            HostKind::Bool => BOOL,
            HostKind::String => STRING,
        };
        let mut found =
            RawFound { count: 0, boolean: 0, floats: null(), integers: null(), text: null(), text_size: 0 };
        // SAFETY: by the promise of `new`, the set is valid; the name is read only during the call.
        let result = unsafe {
            realistic_shim_find(self.pointer.as_ptr(), number, name.as_ptr().cast(), name.len(), &mut found)
        };
        match result {
            ABSENT => return Ok(None),
            FOUND => {}
            NO_HOST => {
                return Err(Failure::new(
                    realistic_status::Unsupported,
                    "this process exports no ParamSet::FindFloat, FindInt, FindBool and FindString: \
                     CreateCamera works in a pbrt-v1 host that exports its symbols (-rdynamic)",
                ));
            }
            _ => return Err(boundary::out_of_memory()),
        }
        let count = usize::try_from(found.count).unwrap_or(0);
        Ok(Some(match kind {
            // SAFETY: if something is found, the host's array has `count` floats, which are valid as long as
            // the set.
            HostKind::Float => Given::Floats(unsafe { slice_of(found.floats, count) }),
            // SAFETY: as above, with integers.
            HostKind::Integer => Given::Integers(unsafe { slice_of(found.integers, count) }),
            HostKind::Bool => Given::Bools(count, found.boolean != 0),
            // SAFETY: the first string has `text_size` bytes and is valid as long as the set; pointer and
            // size are both zero if there is no first string.
            HostKind::String => {
                Given::Strings(count, unsafe { slice_of(found.text.cast(), found.text_size) })
            }
        }))
    }
}

impl ParamSet<'_> {
    /// Returns every parameter in the syntax of a scene file, as a text that the host makes; `None` if the
    /// host cannot make it.
    pub fn text(&self) -> Option<String> {
        text(self.pointer.as_ptr(), PARAMETERS)
    }
}

/// Returns the path of the scene file that the host is reading; `None` if it is not known.
pub fn scene_file() -> Option<PathBuf> {
    text(null(), SCENE_FILE).map(PathBuf::from)
}

/// Returns a text of the host; `None` if there is none. `params` is the pointer of a [`ParamSet`], or NULL
/// for a text that does not belong to a set.
fn text(params: *const c_void, which: i32) -> Option<String> {
    unsafe extern "C" fn take(user: *mut c_void, text: *const c_char, size: usize) {
        // SAFETY: `user` is the string below, and the C++ part passes a text of `size` bytes.
        unsafe { (*user.cast::<String>()).push_str(&String::from_utf8_lossy(slice_of(text.cast(), size))) };
    }
    let mut found = String::new();
    // SAFETY: by the promise of `ParamSet::new`, the set is valid; `take` and the string are used only during
    // the call.
    let result = unsafe { realistic_shim_text(params, which, take, (&raw mut found).cast()) };
    (result == FOUND).then_some(found)
}

/// Returns a slice of `count` values; an empty slice if the pointer is NULL.
///
/// # Safety
/// `pointer` is NULL or points to `count` values that live for `'a`.
unsafe fn slice_of<'a, T>(pointer: *const T, count: usize) -> &'a [T] {
    if pointer.is_null() {
        return &[];
    }
    // SAFETY: the caller's promise.
    unsafe { slice::from_raw_parts(pointer, count) }
}

/// Reports a message with the host's message functions or, if it has none, on stderr.
pub fn message(level: Level, text: &str) {
    let text = boundary::c_string(text);
    // SAFETY: the text ends in NUL and is valid during the call.
    unsafe { realistic_shim_message(level_number(level), text.as_ptr()) }
}
