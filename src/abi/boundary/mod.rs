//! The boundary of the C ABI. Every exported function runs its work through this module, so that no panic
//! reaches a host and the reason for the last failure is available.
//!
//! A panic that is caught is still printed by the process's panic hook, as the header states: a defect should
//! not go unnoticed, and the hook belongs to the program if the library is linked into one.
//!
//! Errors of the modules below become a [`Failure`] with a status of the ABI. Exhausted memory does not: in
//! that case Rust's standard library ends the process. [`memory_to_build`] therefore allocates memory on
//! trial before a camera or a lens is built. `float_environment` is the other half of the boundary and
//! shields the work from the host's traps and rounding mode.

pub(super) mod float_environment;

use std::{
    any::Any,
    cell::RefCell,
    ffi::{CStr, CString},
    hint::black_box,
    panic::{AssertUnwindSafe, catch_unwind},
};

use ::realistic_camera::{CameraError, ParameterError, autofocus::AutofocusError};
use realistic_base::message::bounded;
use realistic_optics::imaging::{focus::FocusError, moving::MovingError};

/// Result of a call of the C ABI. The numbers are part of the ABI and never change.
#[allow(non_camel_case_types)]
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum realistic_status {
    /// Success.
    Ok = 0,
    /// A pointer that must not be NULL is NULL. For a pointer to a camera or a lens, see
    /// `REALISTIC_STATUS_NOT_A_CAMERA` and `REALISTIC_STATUS_NOT_A_LENS`.
    NullPointer = 1,
    /// The `struct_size` is unknown.
    StructSize = 2,
    /// A parameter is unknown, of the wrong kind, out of range or given twice.
    InvalidParameter = 3,
    /// The lens description is missing or cannot be read.
    LensFile = 4,
    /// The lens cannot be focused at the requested distance.
    UnreachableFocus = 5,
    /// A file other than the lens description cannot be read: the picture of `stop_picture`.
    Io = 6,
    /// A panic was caught, which is a defect of this library.
    Panic = 7,
    /// The pointer is NULL or does not point to a camera of this library.
    NotACamera = 8,
    /// Memory is exhausted. Building a camera or a lens needs 8 MiB, and autofocus needs memory for its
    /// zones. If other threads use up the memory in the meantime, or if there is none for a message, the
    /// process ends, as in most Rust programs.
    OutOfMemory = 9,
    /// Reserved, and not returned by this version. The process lacks a function that the call needs.
    /// (`CreateCamera` returns NULL if functions of the host are missing, and `realistic.hpp` throws this
    /// status if the library is older than the header.)
    Unsupported = 10,
    /// The pointer is NULL or does not point to a lens of this library.
    NotALens = 11,
}

impl realistic_status {
    /// Every status.
    pub(super) const ALL: [Self; 12] = [
        Self::Ok,
        Self::NullPointer,
        Self::StructSize,
        Self::InvalidParameter,
        Self::LensFile,
        Self::UnreachableFocus,
        Self::Io,
        Self::Panic,
        Self::NotACamera,
        Self::OutOfMemory,
        Self::Unsupported,
        Self::NotALens,
    ];

    /// Returns the meaning of the status in a few words.
    pub(super) fn name(self) -> &'static CStr {
        match self {
            Self::Ok => c"ok",
            Self::NullPointer => c"a pointer is NULL",
            Self::StructSize => c"struct_size is not of this library",
            Self::InvalidParameter => c"invalid parameter",
            Self::LensFile => c"lens description missing or not readable",
            Self::UnreachableFocus => c"the lens cannot focus there",
            Self::Io => c"a file cannot be read or written",
            Self::Panic => c"a defect of the library was caught",
            Self::NotACamera => c"not a camera of this library",
            Self::OutOfMemory => c"out of memory",
            Self::Unsupported => c"the process lacks what the call needs",
            Self::NotALens => c"not a lens of this library",
        }
    }
}

/// The reason for a failed call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// The status that is returned to the caller.
    pub status: realistic_status,
    /// The message for the user, one or more lines.
    pub message: String,
}

impl Failure {
    /// Returns a failure with its message.
    pub fn new(status: realistic_status, message: impl Into<String>) -> Self {
        Self { status, message: message.into() }
    }

    /// Returns the failure for a wrong parameter.
    pub fn invalid(message: impl Into<String>) -> Self {
        Self::new(realistic_status::InvalidParameter, message)
    }
}

/// Returns the failure for a pointer that must not be NULL but is.
pub fn null(what: &str) -> Failure {
    Failure::new(realistic_status::NullPointer, format!("{what} is NULL"))
}

/// Returns the failure for a pointer that is NULL or does not point to a camera of this library.
pub fn not_a_camera() -> Failure {
    Failure::new(realistic_status::NotACamera, "this is no camera of this library (or it is NULL)")
}

/// Largest number of bytes that one array can span: 128 TiB, the address space of a process on x86-64; with
/// 32-bit addresses, half of the address space.
pub const ADDRESSABLE: usize = if usize::BITS < 64 { isize::MAX as usize } else { 1 << 47 };

/// Checks that an array of `n` elements of `bytes` bytes each fits into the address space.
///
/// # Errors
/// The array does not fit, because `n` is uninitialised or wrong.
pub fn fits_memory(n: usize, bytes: usize) -> Result<(), Failure> {
    match n.checked_mul(bytes) {
        Some(all) if all <= ADDRESSABLE => Ok(()),
        _ => Err(too_many(n, bytes)),
    }
}

/// Returns the failure for an `n` that is uninitialised or wrong.
#[cold]
pub fn too_many(n: usize, bytes: usize) -> Failure {
    Failure::invalid(format!("n is {n}: no memory holds so many elements of {bytes} bytes"))
}

/// Returns the failure for exhausted memory.
pub fn out_of_memory() -> Failure {
    Failure::new(realistic_status::OutOfMemory, "memory is out")
}

thread_local! {
    static LAST_MESSAGE: RefCell<CString> = RefCell::new(CString::default());
}

/// Runs `work` in the default floating-point environment; a panic in it becomes a [`Failure`].
///
/// # Errors
/// The error of `work`, or [`realistic_status::Panic`] if it panics.
pub fn catch<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    // Unwind safety: `work` owns any state that a panic leaves half done (outputs are written last), and the
    // library's shared state is immutable.
    let work = AssertUnwindSafe(|| float_environment::in_default(work));
    catch_unwind(work).unwrap_or_else(|payload| {
        Err(Failure::new(
            realistic_status::Panic,
            format!("a defect of this library was caught: {}", describe(payload)),
        ))
    })
}

/// Runs `work` for an exported function that returns a status, and stores the message of a failure.
pub fn status(work: impl FnOnce() -> Result<(), Failure>) -> realistic_status {
    match catch(work) {
        Ok(()) => realistic_status::Ok,
        Err(failure) => {
            remember(&failure);
            failure.status
        }
    }
}

/// Runs `work` for an exported function that returns a value. After a failure it stores the message and
/// returns `fallback`.
pub fn value<T>(fallback: T, work: impl FnOnce() -> Result<T, Failure>) -> T {
    catch(work).unwrap_or_else(|failure| {
        remember(&failure);
        fallback
    })
}

/// Runs `work` for a function that is called for each ray. After a panic it returns `fallback` without
/// storing a message, to save time.
#[inline]
pub fn ray<T>(fallback: T, work: impl FnOnce() -> T) -> T {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(value) => value,
        Err(payload) => {
            describe(payload);
            fallback
        }
    }
}

/// Stores a failure's message as the last message of this thread.
pub fn remember(failure: &Failure) {
    let message = c_string(&failure.message);
    // The cell may already be destroyed at the end of a thread; then nobody can read it.
    let _ = LAST_MESSAGE.try_with(|last| *last.borrow_mut() = message);
}

/// Reads the last message of this thread. The pointer to it is valid until the next failure.
pub fn with_last_message<T>(read: impl FnOnce(&CString) -> T) -> Option<T> {
    LAST_MESSAGE.try_with(|last| read(&last.borrow())).ok()
}

/// Converts a message to a C string of bounded length. `bounded` escapes NUL characters, at which C would
/// stop reading; replacing them by a space is only a safeguard.
pub fn c_string(text: &str) -> CString {
    CString::new(bounded(text).replace('\0', " ")).unwrap_or_default()
}

/// Returns the message of a panic. A payload that is not a text is leaked, because its destructor might panic
/// in turn, and nothing would catch that panic.
fn describe(payload: Box<dyn Any + Send>) -> String {
    match payload.downcast::<&'static str>() {
        Ok(text) => (*text).to_owned(),
        Err(payload) => match payload.downcast::<String>() {
            Ok(text) => *text,
            Err(payload) => {
                std::mem::forget(payload);
                "no message".to_owned()
            }
        },
    }
}

impl From<CameraError> for Failure {
    fn from(error: CameraError) -> Self {
        let status = match &error {
            CameraError::Source(_) => realistic_status::LensFile,
            CameraError::PictureFile(_) | CameraError::StopPicture { .. } => realistic_status::Io,
            CameraError::Focus(FocusError::TooNear { .. })
            | CameraError::TooNear { .. }
            | CameraError::Moving(MovingError::Unreachable { .. }) => realistic_status::UnreachableFocus,
            CameraError::Parameter(_)
            | CameraError::Lens(_)
            | CameraError::Focus(_)
            | CameraError::Moving(_)
            | CameraError::FilmStays
            | CameraError::NoFilmDistance(_)
            | CameraError::FilmInLens { .. }
            | CameraError::PupilAtInfinity
            | CameraError::TooFar { .. }
            | CameraError::DarkAxis { .. }
            | CameraError::Weight { .. }
            | CameraError::NoBlades { .. }
            | CameraError::NoCoatings { .. }
            | CameraError::NothingReflects { .. }
            | CameraError::GhostsOnPosedFilm
            | CameraError::GhostsOfGeneralLens { .. }
            | CameraError::FilmCurvature { .. }
            | CameraError::Exposure { .. }
            | CameraError::NoStopFor { .. }
            | CameraError::GainWithoutPicture
            | CameraError::Transform(_)
            | CameraError::Raster { .. } => realistic_status::InvalidParameter,
        };
        Self::new(status, error.to_string())
    }
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        CameraError::from(error).into()
    }
}

impl From<AutofocusError> for Failure {
    fn from(error: AutofocusError) -> Self {
        let status = match error {
            AutofocusError::Camera(error) => return error.into(),
            AutofocusError::Nothing { .. } => realistic_status::UnreachableFocus,
            AutofocusError::NoZones { .. } | AutofocusError::Zone { .. } | AutofocusError::ByGroup => {
                realistic_status::InvalidParameter
            }
        };
        Self::new(status, error.to_string())
    }
}

/// Memory for building, bytes. Building takes 2.5 MB for any lens, up to 7.7 MB with a tolerance, and keeps
/// less than that. The fit for `transmission` may take more.
const CAMERA: usize = 8 << 20;
/// Block size, bytes, that is small enough for allocators to use the same heap as for smaller blocks.
const CHUNK: usize = 1 << 16;

/// Allocates the memory that building a camera or a lens needs, and frees it again without writing to it.
///
/// It first tries a single block. With many small blocks, the allocator writes a header to each, and the
/// system must clear every page that is written to; this takes a quarter of the time of building a small
/// camera.
///
/// # Errors
/// Memory is exhausted.
pub fn memory_to_build() -> Result<(), Failure> {
    let mut block: Vec<u8> = Vec::new();
    let is_there = block.try_reserve_exact(CAMERA).is_ok();
    // `black_box` keeps the compiler from removing an allocation that nobody reads.
    drop(black_box(block));
    if is_there {
        return Ok(());
    }
    let mut chunks: Vec<Vec<u8>> = Vec::new();
    let is_there = chunks.try_reserve_exact(CAMERA / CHUNK).is_ok()
        && (0..CAMERA / CHUNK).all(|_| {
            chunks.push(Vec::new());
            chunks.last_mut().is_some_and(|chunk| chunk.try_reserve_exact(CHUNK).is_ok())
        });
    drop(black_box(chunks));
    if is_there { Ok(()) } else { Err(out_of_memory()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last() -> String {
        with_last_message(|text| text.to_str().unwrap().to_owned()).unwrap()
    }

    #[test]
    fn a_panic_becomes_a_status_and_a_message() {
        assert_eq!(status(|| panic!("row {}", 7)), realistic_status::Panic);
        assert!(last().contains("row 7"));
        assert_eq!(value(3, || panic!("plain")), 3);
        assert!(last().contains("plain"));
        assert_eq!(ray(0.0_f32, || panic!("in a ray")), 0.0);
    }

    #[test]
    fn a_message_is_of_bounded_length_whoever_made_it() {
        let text = format!("lens \"{}\": what to do", "x".repeat(100_000_000));
        assert_eq!(status(|| Err(Failure::invalid(text.as_str()))), realistic_status::InvalidParameter);
        assert!(last().len() <= 4005 && last().ends_with("x\": what to do"), "{}", last().len());
    }

    #[test]
    fn a_payload_whose_destructor_panics_is_harmless() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("dropped");
            }
        }
        assert_eq!(ray(1, || std::panic::panic_any(Bomb)), 1);
        assert_eq!(status(|| std::panic::panic_any(Bomb)), realistic_status::Panic);
    }

    #[test]
    fn success_keeps_the_last_message_and_a_nul_does_not_cut_it() {
        let failure = Failure::new(realistic_status::Io, "a\0b");
        assert_eq!(status(|| Err(failure)), realistic_status::Io);
        assert_eq!(status(|| Ok(())), realistic_status::Ok);
        assert_eq!(last(), "a\\u{0}b");
    }

    #[test]
    fn the_numbers_stay() {
        for (number, status) in realistic_status::ALL.into_iter().enumerate() {
            assert_eq!(status as usize, number);
        }
    }
}
