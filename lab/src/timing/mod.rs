//! Tasks in, seconds out: run times on a machine that does other things, too, and what machine it is.

mod bench;
pub mod camera_calls;
pub mod clock;
mod contest;
pub mod cost;
pub mod machine;

pub use bench::{Effort, Timing, interleaved, interleaved_within, repeated};
pub use contest::{BenchArguments, Contest, LARGE_LENSES};
