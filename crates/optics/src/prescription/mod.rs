//! Lens descriptions: a designer's table, before any optics.
//!
//! [`Prescription`] is the model. [`read`] builds one from the text of a lens file in any supported format (see
//! `reader`). [`catalogue`] holds the built-in lenses, `load` finds a lens by file or name, and [`glass`] gives the
//! index of a medium at a wavelength.
//!
//! A camera's parameter leads to a lens as follows. `camera/setup/prescribed.rs` passes the name to
//! `optics/imaging/open.rs`. There, `split_scale` and `load` (`source`) find the file or the text in the catalogue, and
//! [`read`] (`reader`) builds the prescription. `imaging/open.rs` then scales the prescription and sets up the lens at
//! a wavelength and stop.
//!
//! Lengths are in millimetres. Interfaces are in the order of the file, scene side first. [`MAX_FILE_BYTES`],
//! [`MAX_INTERFACES`] and [`MAX_NAME_BYTES`] limit the input. Larger input is refused before anything is computed from
//! it. No real lens comes near these limits, and a file from elsewhere must not keep the program busy. Every reader
//! reports an error in a file as [`LensFileError`], with its location.

mod aperture;
mod blades;
pub mod catalogue;
mod coating;
mod coordinate_break;
mod findings;
pub mod glass;
mod interfaces;
mod picture;
mod positions;
mod reader;
mod source;
mod unsymmetric;
mod wavelength;

use thiserror::Error;

pub use aperture::{Aperture, MAX_VERTICES, Outline};
pub use blades::{BladeConstants, Blades};
pub use coating::{AirSide, Coating, Layer, STACK, SurfaceCoating};
pub use coordinate_break::CoordinateBreak;
pub use findings::{Fate, Finding, Place};
pub use glass::GlassLibrary;
pub use interfaces::{
    Asphere, AsphereTerms, FIRST_POWER, Glass, Interface, Medium, NO_TERMS, Prescription, Shape, Stated,
};
pub use picture::{MAX_PICTURE_SIDE, StopPicture};
pub use positions::{Layout, Position, Positions};
pub use reader::{read, read_with};
pub use source::{
    Collection, CollectionFile, Fault, MAX_FILES, SearchPath, SourceError, find_file, glass_library,
};
pub(crate) use source::{load, split_scale};
pub use unsymmetric::{
    Biconic, Cylinder, Meridian, PROFILE_TERMS, Toroid, Unsymmetric, UnsymmetricConstants,
};

/// An error in a lens file, shown as `file:line:column: what was expected`.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}:{line}:{column}: {message}")]
pub struct LensFileError {
    /// The file as the caller names it.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in bytes, counted from 1.
    pub column: usize,
    /// The fault, what was expected instead, and how to write it.
    pub message: String,
}

/// Maximum size of a lens file, in bytes: 1 MiB. Real files have a few thousand bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 20;

/// Maximum size of an archive of a lens with its catalogues, in bytes: 16 MiB. Its members have the limits of their
/// kinds.
pub const MAX_ARCHIVE_BYTES: u64 = 16 << 20;

/// Maximum number of interfaces of a lens, and of glasses that a lens file defines.
pub const MAX_INTERFACES: usize = 1000;

/// Maximum length of a lens file's name with its directories, in bytes.
pub(crate) const MAX_PATH_BYTES: usize = 4096;

/// Maximum length of a lens's name (for a file, without the directories) and of a glass's name, in bytes.
pub const MAX_NAME_BYTES: usize = 255;

/// Maximum size of a glass catalogue, and of all catalogues beside a lens file together, in bytes: 8 MiB. The largest
/// makers' catalogues have one or two MiB.
pub const MAX_CATALOG_BYTES: u64 = 8 << 20;

/// Maximum number of glasses of a catalogue, and of all catalogues beside a lens file together. All makers together
/// have some 5,000 glasses.
pub const MAX_CATALOG_GLASSES: usize = 20_000;

/// Maximum number of catalogues that are read beside a lens file.
pub(crate) const MAX_CATALOGS: usize = 64;

/// Maximum size of a glass's entry in a catalogue, in bytes. Real entries have three thousand bytes, mostly
/// transmittances.
const MAX_GLASS_BYTES: usize = 1 << 14;

/// Maximum number of positions of a lens's moving groups.
pub(crate) const MAX_POSITIONS: usize = 100;
