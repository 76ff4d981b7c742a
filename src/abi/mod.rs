//! The C ABI.
mod types;
pub use types::*;
