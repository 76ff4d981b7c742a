//! The subcommands: one module each, with its `Args` and its `run`.

pub mod blender;
pub mod convert;
pub mod disks;
pub mod draw;
pub mod focus;
pub mod focus_stack;
pub mod install;
pub mod lens;
pub mod plan;
pub mod pupil;
pub mod refractions;
pub mod render;
pub mod report;
pub mod trace;
