//! Vectors of numbers, the instruction sets that a processor has, and the choice among them.
//!
//! An algorithm is written once, over [`Lanes`], and compiled for each instruction set. Every operation is correctly
//! rounded, so all instruction sets give the same bits in the same precision.
//!
//! | type | is |
//! |---|---|
//! | [`Simd`] | an instruction set, detected once per process and limited by `REALISTIC_SIMD` |
//! | [`Available`] | the proof that the processor has an instruction set |
//! | [`Cpu`] | the proof that the processor has the instructions of one vector type; making a vector requires it |
//! | [`Scalar`] | the type of the number in a lane: `f64` or `f32` |
//! | [`Lanes`] | a vector with its operations |
//! | [`Portable`], [`OneLane`] | vectors stored in arrays, for any processor |
//! | [`LookUp`], [`Indexed`] | tables that each lane reads at an index of its own |
//! | [`Compiled`] | work that is compiled for each instruction set, for [`Simd::run`] |
//!
//! This crate depends on `base`; `trace`, `light` and `camera` depend on this crate.
//!
//! ```
//! use realistic_simd::{Compiled, Lanes, Portable, Simd};
//!
//! type Four = Portable<f64, 4>;
//! struct Squares<'a>(&'a mut [f64]);
//!
//! impl Compiled for Squares<'_> {
//!     #[inline(always)]
//!     fn run(self) {
//!         for numbers in self.0.chunks_mut(Four::WIDTH) {
//!             let x = Four::load(Four::cpu(), numbers);
//!             (x * x).store(numbers);
//!         }
//!     }
//! }
//!
//! let mut numbers = [1.0, 2.0, 3.0, 4.0, 5.0];
//! Simd::best().run(Squares(&mut numbers));
//! assert_eq!(numbers, [1.0, 4.0, 9.0, 16.0, 25.0]);
//! ```
//!
//! Only the public interface of the crate `realistic` is stable; the interface of this crate may change in any version.

mod instruction_sets;
pub mod lanes;

pub use instruction_sets::{Available, Compiled, Simd};
pub use lanes::{Cpu, Indexed, Lanes, LookUp, OneLane, Portable, Scalar, cos_sin, cos_sin_over, turned};
