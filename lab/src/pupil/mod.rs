//! The true pupil of a film point, by tracing; and how evenly points lie in a disk, as numbers.

pub mod disk_statistics;
mod outline;

pub use outline::{Outline, acceptance};
