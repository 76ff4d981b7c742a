//! What the tests of every reader ask of a text: that it is a lens, or with which message it is refused, as its user
//! would read it.

use crate::prescription::{Prescription, read};

/// The name that the files of all tests have; the format is told by the text.
pub const FILE: &str = "lens.dat";

#[track_caller]
pub fn ok(text: &(impl AsRef<[u8]> + ?Sized)) -> Prescription {
    read(FILE, text.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

/// That the text is refused at `line:column`, with a message that has all of `parts`.
#[track_caller]
pub fn refused(text: &(impl AsRef<[u8]> + ?Sized), at: &str, parts: &[&str]) {
    let message = read(FILE, text.as_ref()).expect_err("refused").to_string();
    assert!(message.starts_with(&format!("{FILE}:{at}: ")), "{message}");
    for part in parts {
        assert!(message.contains(part), "{message} lacks {part:?}");
    }
}
