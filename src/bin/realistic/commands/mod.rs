//! The subcommands: one module each, with its `Args` and its `run`.

pub mod install;
pub mod render;
#[cfg(feature = "report")]
pub mod report;
