//! Pictures: their pixels and files, and several on one sheet.

pub mod lettering;
mod picture;
mod sheet;

pub use picture::{Format, Picture};
pub use sheet::Sheet;
