//! Errors in finding or reading a lens or a file beside it.

use std::path::PathBuf;

use thiserror::Error;

use crate::prescription::{LensFileError, MAX_NAME_BYTES, MAX_PATH_BYTES};

/// An error in finding or reading a lens.
#[derive(Debug, Error)]
pub enum SourceError {
    /// The file was read, but is not a lens.
    #[error(transparent)]
    File(#[from] LensFileError),
    /// The name is neither a file nor in the catalogue.
    #[error(
        "no lens file \"{name}\" in {searched}, and no lens of that name in the catalogue{collections}; {known}"
    )]
    NotFound {
        /// The name as given.
        name: String,
        /// The directories that were searched, and the directories that were not.
        searched: String,
        /// The collections that were searched, as the end of a list; empty if there are none.
        collections: String,
        /// A question that suggests the most similar name in the catalogue and the collections, or a list of all names in the catalogue.
        known: String,
    },
    /// Several lenses of the collections have the name.
    #[error("lens \"{name}\" may be one of {candidates}; give more of its path")]
    Ambiguous {
        /// The name as given.
        name: String,
        /// The paths of the lenses.
        candidates: String,
    },
    /// No file has that name.
    #[error("no {what} \"{name}\" in {searched}")]
    NoSuchFile {
        /// The kind of file.
        what: &'static str,
        /// The name as given.
        name: String,
        /// The directories that were searched, and those that were not.
        searched: String,
    },
    /// Something of that name exists, but is not a file.
    #[error("{what} \"{}\" {why}", path.display())]
    NoFile {
        /// The kind of file.
        what: &'static str,
        /// The path that exists.
        path: PathBuf,
        /// A description of the thing at the path, for the message.
        why: String,
    },
    /// The file exists, but cannot be read.
    #[error("{what} \"{}\" cannot be read: {error}", path.display())]
    Unreadable {
        /// The kind of file.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The name is longer than any file name.
    #[error(
        "{what} \"{start}...\": the name has {length} bytes; the name of a {what} or of its file has at most {MAX_NAME_BYTES}, \
         with its directories {MAX_PATH_BYTES}"
    )]
    NameTooLong {
        /// The kind of name: a lens or a glass catalogue.
        what: &'static str,
        /// The beginning of the name.
        start: String,
        /// The length of the name in bytes.
        length: usize,
    },
    /// The file was read, but not every statement of it is used as written.
    #[error("lens \"{name}\" is not used as written, which \"strict\" demands: {listed}")]
    NotAsWritten {
        /// The name of the lens.
        name: String,
        /// The statements that are replaced or left out, with their places and the reasons.
        listed: String,
    },
    /// The part after `@` is not a focal length.
    #[error("lens \"{name}\": after @ comes a positive focal length in mm, as in \"dgauss.50mm@35mm\"")]
    FocalLength {
        /// The name as given.
        name: String,
    },
}
