//! The instances of the code in vectors that this crate compiles: all of them, and in its unit tests the one for single
//! elements alone. Other tests compare the instances.

#[cfg(test)]
use realistic_simd::Available;
#[cfg(not(test))]
pub use realistic_trace::kernel::in_vectors;
#[cfg(test)]
use realistic_trace::kernel::{Grouping, InVectors, KernelScalar, one_by_one};

/// Does work one element at a time.
#[cfg(test)]
pub fn in_vectors<S: KernelScalar, W: InVectors<S>>(_: Available, _: Grouping, work: &mut W) {
    one_by_one(work);
}
