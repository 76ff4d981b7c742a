//! Vectors of numbers, the instruction sets that a processor has, and the choice among them.
//!
//! Algorithms are written once, over [`Lanes`]: `F64x8` in `lanes/avx512.rs`, `F32x8` and `F64x4` in `lanes/avx2.rs`, arrays
//! in `lanes/portable.rs`. Every operation is correctly rounded, so that all of them give the same bits. [`Simd`] names a
//! set of instructions, [`Available`] proves that the processor has it, and [`Cpu`] carries the proof to where vectors
//! are made. [`Simd::run`] compiles a [`Compiled`] for each set.

pub mod lanes;
mod simd;

pub use lanes::{Cpu, Indexed, Lanes, LookUp, OneLane, Portable, Scalar, cos_sin, cos_sin_over, turned};
pub use simd::{Available, Compiled, Simd};
