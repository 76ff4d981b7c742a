//! Lens descriptions: what a designer's table says, before any optics.
//!
//! [`Prescription`] is the model; [`read`] makes one from the text of a lens file
//! in either of two table formats (see `reader`); [`catalogue`] holds the lenses that
//! are built in; [`LensSource`] finds a lens by file or name; [`glass`] says what a medium's index is at a
//! wavelength.
//!
//! Lengths are millimetres. Interfaces stand in the order of the file, scene side first.

pub mod catalogue;
mod error;
pub mod glass;
mod interfaces;
mod reader;
mod source;

pub use error::LensFileError;
pub use interfaces::{Interface, Medium, Prescription, Sellmeier, Shape};
pub use reader::read;
pub use source::{LensSource, MAX_FILE_BYTES, SearchPath, SourceError};
