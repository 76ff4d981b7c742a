//! The true pupil of a film point, by tracing; and statistics of the uniformity of points in a
//! disk.

pub mod disk_statistics;
mod outline;

pub use outline::{Outline, acceptance};
