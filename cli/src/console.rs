//! What the program says beside its results: warnings, notes, and what it did. `--quiet` leaves only errors.

use crate::files::is_stdout;
use realistic::unstable::message::printable;
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

static QUIET: AtomicBool = AtomicBool::new(false);

/// Says nothing from now on but errors.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether only errors are said.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// A warning on standard error.
pub fn warn(message: &str) {
    note(&format!("warning: {message}"));
}

/// What is worth knowing, on standard error.
pub fn note(message: &str) {
    if !is_quiet() {
        // A closed standard error leaves nobody to tell.
        let _ = writeln!(io::stderr(), "realistic: {}", printable(message));
    }
}

/// Lines on what was done and what `out` was written: on standard output, unless `--quiet`.
///
/// # Errors
/// Standard output cannot be written.
pub fn report(text: &str, out: &Path) -> io::Result<()> {
    if is_quiet() { Ok(()) } else { answer(text, Some(out)) }
}

/// What the user asked for: on standard output, or on standard error where a file takes that.
///
/// # Errors
/// Standard output cannot be written.
pub fn answer(text: &str, out: Option<&Path>) -> io::Result<()> {
    let text = printable(text);
    if out.is_some_and(is_stdout) {
        let _ = io::stderr().write_all(text.as_bytes());
        return Ok(());
    }
    io::stdout().write_all(text.as_bytes())
}
