//! What a ray costs by each way to trace it, in each way of calling, so that the cheapest is tried first.
//!
//! Nanoseconds through the lens alone, as fitted to the tables of `cargo bench --bench plan` in `benches/record`: for
//! AVX-512 on a machine that has it, for AVX2 and without either on the same one with `REALISTIC_SIMD`. Only their ratios
//! count, which are the instructions': a clock at build time would make a picture depend on what else the machine did.

use super::task::{
    Entry, Precision,
    Precision::{F32, F64},
};
use crate::{lens::Lens, trace::kernel::Simd};

/// The exact trace: nanoseconds for no surface, and for each.
#[derive(Clone, Copy)]
struct Exact {
    none: f64,
    surface: f64,
}

/// Polynomials: nanoseconds for none, for each coefficient of the rays, and of the apertures.
#[derive(Clone, Copy)]
struct PolynomialCost {
    none: f64,
    ray: f64,
    aperture: f64,
}

/// How many spheres an asphere costs, about: measured from 2.7 to 3.8.
const ASPHERE: usize = 3;
/// How many times as much each of more than two apertures takes.
const CROWD: f64 = 1.6;

/// The surfaces of a lens, aspheres counted as what they cost.
pub fn in_spheres(lens: &Lens) -> usize {
    lens.surfaces.iter().map(|surface| if surface.figure.is_some() { ASPHERE } else { 1 }).sum()
}

/// The exact trace through so many surfaces.
pub fn exact(simd: Simd, entry: Entry, precision: Precision, surfaces: usize) -> f64 {
    let Exact { none, surface } = match (simd, entry, precision) {
        (Simd::Avx512, Entry::Many, F32) => Exact { none: 0.6, surface: 0.25 },
        (Simd::Avx512, Entry::Many, F64) => Exact { none: 1.0, surface: 0.67 },
        (Simd::Avx2, Entry::Many, F32) => Exact { none: 0.7, surface: 0.53 },
        (Simd::Avx2, Entry::Many, F64) => Exact { none: 2.0, surface: 1.15 },
        (Simd::Avx512 | Simd::Avx2, Entry::One, F32) => Exact { none: 0.0, surface: 9.0 },
        (Simd::Avx512 | Simd::Avx2, Entry::One, F64) => Exact { none: 0.0, surface: 10.0 },
        (Simd::Portable, _, _) => Exact { none: 2.0, surface: 27.0 },
    };
    none + surface * surfaces as f64
}

/// Polynomials with so many monomials each, that test so many apertures besides the front's.
pub fn polynomials(
    simd: Simd,
    entry: Entry,
    precision: Precision,
    monomials: usize,
    apertures: usize,
) -> f64 {
    let PolynomialCost { none, ray, aperture } = match (simd, entry, precision) {
        (Simd::Avx512, Entry::Many, F32) => PolynomialCost { none: 1.35, ray: 0.0135, aperture: 0.0195 },
        (Simd::Avx512, Entry::Many, F64) => PolynomialCost { none: 2.9, ray: 0.028, aperture: 0.039 },
        (Simd::Avx2, Entry::Many, F32) => PolynomialCost { none: 2.5, ray: 0.027, aperture: 0.036 },
        (Simd::Avx2, Entry::Many, F64) => PolynomialCost { none: 5.4, ray: 0.055, aperture: 0.075 },
        (Simd::Avx512 | Simd::Avx2, Entry::One, F32) => {
            PolynomialCost { none: 18.0, ray: 0.15, aperture: 0.31 }
        }
        (Simd::Avx512 | Simd::Avx2, Entry::One, F64) => {
            PolynomialCost { none: 35.0, ray: 0.15, aperture: 0.25 }
        }
        (Simd::Portable, _, _) => PolynomialCost { none: 80.0, ray: 3.4, aperture: 3.4 },
    };
    // One ray by itself waits for loops that end at more places than a processor foresees.
    let crowd = if entry == Entry::One && apertures > 2 { CROWD } else { 1.0 };
    // Four polynomials for the ray, two for each aperture.
    none + ray * (4 * monomials) as f64 + crowd * aperture * (2 * monomials * apertures) as f64
}
