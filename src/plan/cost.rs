//! What a ray costs by each way to trace it, so that the cheapest is tried first.
//!
//! Nanoseconds per ray in batches, as fitted to `cargo bench --bench plan` on one core of the machine of
//! `benches/record`: only their order counts, which is the processor's width's. A clock at build time would
//! make a picture depend on what else the machine did.

use super::tracing::Precision::{self, F32, F64};
use crate::trace::kernel::Simd;

/// What is counted: nanoseconds for none of it, and for each.
#[derive(Clone, Copy)]
struct Line {
    none: f64,
    each: f64,
}

impl Line {
    fn at(self, count: usize) -> f64 {
        self.none + self.each * count as f64
    }
}

/// The exact trace, by the number of surfaces.
pub fn kernel(simd: Simd, precision: Precision, surfaces: usize) -> f64 {
    let line = match (simd, precision) {
        (Simd::Avx512, F32) => Line { none: 1.2, each: 0.44 },
        (Simd::Avx512, F64) => Line { none: 3.3, each: 0.83 },
        (Simd::Avx2, F32) => Line { none: 1.7, each: 0.57 },
        (Simd::Avx2, F64) => Line { none: 3.5, each: 1.58 },
        (Simd::Portable, _) => Line { none: 2.0, each: 27.0 },
    };
    line.at(surfaces)
}

/// Polynomials, by the monomials of each and the polynomials: four, and two for each aperture.
pub fn polynomials(simd: Simd, precision: Precision, monomials: usize, apertures: usize) -> f64 {
    let line = match (simd, precision) {
        (Simd::Avx512, F32) => Line { none: 1.9, each: 0.0175 },
        (Simd::Avx512, F64) => Line { none: 3.8, each: 0.035 },
        (Simd::Avx2, F32) => Line { none: 2.9, each: 0.034 },
        (Simd::Avx2, F64) => Line { none: 5.8, each: 0.07 },
        (Simd::Portable, _) => Line { none: 80.0, each: 3.4 },
    };
    line.at(monomials * (4 + 2 * apertures))
}
