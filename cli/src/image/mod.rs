//! Pictures: their pixels, their files, whole or in tiles, their lettering, and several on one sheet.

mod filter;
pub mod lettering;
mod picture;
mod sheet;
mod srgb;
pub mod tile;

pub use filter::Filter;
pub use picture::{Curve, Format, LARGEST_SIDE, Picture, Tone, check_memory, picture_path};
pub use sheet::Sheet;
pub use srgb::{Colours, SrgbImage, hex};
