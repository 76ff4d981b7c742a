//! Messages of the program besides its results: warnings, notes, and reports. `--quiet` leaves only errors.

use crate::files::is_stdout;
use realistic_base::message::printable;
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

static QUIET: AtomicBool = AtomicBool::new(false);

/// Suppresses all later messages except errors.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether only errors are printed.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints a warning on standard error.
pub fn warn(message: &str) {
    note(&format!("warning: {message}"));
}

/// Prints a note on standard error.
pub fn note(message: &str) {
    if !is_quiet() {
        // If standard error is closed, nobody can read the note.
        let _ = writeln!(io::stderr(), "realistic: {}", printable(message));
    }
}

/// Prints a report on the work done to the stream that [`answer`] uses, unless `--quiet` is given.
///
/// # Errors
/// Standard output cannot be written.
pub fn report(text: &str, out: &Path) -> io::Result<()> {
    if is_quiet() { Ok(()) } else { answer(text, Some(out)) }
}

/// Prints the answer to the user on standard output, or on standard error if `out` is standard output.
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
