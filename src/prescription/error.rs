//! What is wrong with a lens file, and where: the one error of every reader.

use thiserror::Error;

/// A lens file that cannot be read. Shown as `file:line:column: what was expected`.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}:{line}:{column}: {message}")]
pub struct LensFileError {
    /// The file as the caller named it.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in bytes, counted from 1.
    pub column: usize,
    /// What was found, what was expected and how to write it.
    pub message: String,
}
