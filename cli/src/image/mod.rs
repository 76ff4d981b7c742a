//! Pictures: their pixels, their files, the letters in them, and several on one sheet.

pub mod lettering;
mod picture;
mod sheet;
mod srgb;

pub use picture::{Picture, picture_path, writable};
pub use sheet::Sheet;
pub use srgb::{Colours, SrgbImage, hex};
