//! Costs of a ray for each method of tracing and each kind of call; candidates are tried in order of
//! increasing cost.
//!
//! The unit is nanoseconds per ray through the lens alone. The constants are fitted to the tables of `cargo
//! bench --bench plan` in `benches/record`. All were measured on a machine with AVX-512, where
//! `REALISTIC_SIMD` selected AVX2 and portable code. Only the ratios of costs matter, and these depend on the
//! instruction set. Costs are not measured when a camera is built, because a picture would then depend on the
//! machine's load.

use super::task::{
    Entry, Precision,
    Precision::{F32, F64},
};
use realistic_optics::lens::Lens;
use realistic_simd::Simd;

/// Cost of the exact trace, ns: a constant, and a term per surface.
#[derive(Clone, Copy)]
struct ExactCost {
    none: f64,
    surface: f64,
}

/// Cost of polynomials, ns: a constant, and a term each per coefficient of the ray's polynomials and of the
/// apertures' polynomials.
#[derive(Clone, Copy)]
struct PolynomialCost {
    none: f64,
    ray: f64,
    aperture: f64,
}

/// Approximate cost of an asphere, in units of the cost of a sphere; 2.7 to 3.8 were measured.
const ASPHERE: usize = 3;
/// Factor on the cost of each aperture if more than two are tested.
const CROWD: f64 = 1.6;

/// Counts the surfaces of a lens; an asphere counts as the number of spheres that cost the same.
pub fn in_spheres(lens: &Lens) -> usize {
    lens.surfaces.iter().map(|surface| if surface.figure.is_some() { ASPHERE } else { 1 }).sum()
}

/// Returns the cost of the exact trace through the given number of surfaces, ns per ray.
pub fn exact(simd: Simd, entry: Entry, precision: Precision, surfaces: usize) -> f64 {
    let ExactCost { none, surface } = match (simd, entry, precision) {
        (Simd::Avx512, Entry::Many, F32) => ExactCost { none: 0.6, surface: 0.25 },
        (Simd::Avx512, Entry::Many, F64) => ExactCost { none: 1.0, surface: 0.67 },
        (Simd::Avx2, Entry::Many, F32) => ExactCost { none: 0.7, surface: 0.53 },
        (Simd::Avx2, Entry::Many, F64) => ExactCost { none: 2.0, surface: 1.15 },
        (Simd::Avx512 | Simd::Avx2, Entry::One, F32) => ExactCost { none: 0.0, surface: 9.0 },
        (Simd::Avx512 | Simd::Avx2, Entry::One, F64) => ExactCost { none: 0.0, surface: 10.0 },
        (Simd::Portable, _, _) => ExactCost { none: 2.0, surface: 27.0 },
    };
    none + surface * surfaces as f64
}

/// Returns the cost of polynomials with `monomials` terms each that test `apertures` apertures besides that
/// of the front surface, ns per ray.
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
    // A single ray pays for branch mispredictions at the ends of many short loops.
    let crowd = if entry == Entry::One && apertures > 2 { CROWD } else { 1.0 };
    // There are four polynomials for the ray and two for each aperture.
    none + ray * (4 * monomials) as f64 + crowd * aperture * (2 * monomials * apertures) as f64
}
