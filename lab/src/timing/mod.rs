//! Run times of tasks on a busy machine, and a description of the machine.

mod bench;
pub mod camera_calls;
pub mod clock;
mod contest;
pub mod cost;
pub mod machine;

pub use bench::{Effort, Timing, interleaved, interleaved_within, repeated};
pub use contest::{BenchArguments, Contest, LARGE_LENSES};
