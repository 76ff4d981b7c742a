//! The subcommands: one module each, with its `Args` and its `run`.

pub mod disks;
pub mod focus_stack;
pub mod install;
pub mod render;
