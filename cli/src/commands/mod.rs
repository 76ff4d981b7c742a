//! The subcommands, each in a module with its `Args` and its `run`. The subcommands that take pictures share a
//! folder.

pub mod blender;
pub mod convert;
pub mod disks;
pub mod draw;
pub mod export;
pub mod flare;
pub mod focus;
pub mod install;
pub mod lens;
pub mod lenses;
pub mod pictures;
pub mod plan;
pub mod pupil;
pub mod refractions;
pub mod report;
pub mod trace;
pub mod waves;
