//! Lens descriptions: what a designer's table says, before any optics.
//!
//! [`Prescription`] is the model; [`read`] makes one from the text of a lens file
//! in any of the formats that are read (see `reader`); [`catalogue`] holds the lenses that
//! are built in; [`LensSource`] finds a lens by file or name; [`glass`] says what a medium's index is at a
//! wavelength.
//!
//! From a camera's parameter to a lens: `camera/setup/prescribed.rs` takes the name to `lens/open.rs`, which has
//! `LensSource::parse` and `LensSource::load` (`source`) find the file or the catalogue's text and [`read`] (`reader`)
//! make the prescription; `lens/open.rs` scales it and sets it up at a wavelength and stop.
//!
//! Lengths are millimetres. Interfaces stand in the order of the file, scene side first. What is read is bounded
//! by [`MAX_FILE_BYTES`], [`MAX_INTERFACES`] and [`MAX_NAME_BYTES`].

mod asphere;
mod blades;
pub mod catalogue;
mod error;
pub mod glass;
mod interfaces;
mod limits;
mod positions;
mod reader;
mod source;
mod stated;
mod wavelength;

pub use asphere::{Asphere, FIRST_POWER, LAST_POWER};
pub use blades::{BladeConstants, Blades};
pub use error::LensFileError;
pub use glass::GlassLibrary;
pub use interfaces::{Glass, Interface, Medium, Prescription, Sellmeier, Shape};
pub use limits::{
    MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES, MAX_CATALOGS, MAX_FILE_BYTES, MAX_INTERFACES, MAX_NAME_BYTES,
    MAX_PATH_BYTES, MAX_POSITIONS,
};
pub use positions::{Layout, LayoutError, Position, Positions};
pub use reader::{read, read_with};
pub use source::{LensSource, SearchPath, SourceError, glass_library};
pub use stated::Stated;
