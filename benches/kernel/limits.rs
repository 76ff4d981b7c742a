//! The processor's peak throughput of square roots (by the divider) and of fused multiply-adds, and the lower bound
//! that it sets on the time to trace a ray through a lens.

#[cfg(target_arch = "x86_64")]
use realistic_lab::{results::statistics::median, timing::repeated};
use realistic_optics::lens::Lens;
use realistic_simd::Simd;

/// Peak speed of an instruction set with one type of register: the least time per operation, ns.
#[derive(Clone, Copy, Debug)]
pub struct Register {
    pub name: &'static str,
    simd: Simd,
    lanes: f64,
    /// Times of a square root by the divider and of a fused multiply-add, in a stream of independent operations.
    root: f64,
    multiply_add: f64,
    /// Square roots per interface that are computed by the multipliers instead of the divider.
    computed_roots: f64,
}

/// Square roots in the kernel's link for a refracting sphere: n cos I and n' cos I'.
const ROOTS: f64 = 2.0;
/// Instructions of the link that contain a product, including fused sums; three further sums have their own ports on
/// some processors.
const PRODUCTS: f64 = 17.0;
/// Instructions that contain a product in a computed square root: two for the start, three for each of two steps, and
/// two for the last step.
const PER_ROOT: f64 = 10.0;

impl Register {
    /// Returns the least time of a ray through a lens of spheres and planes, ns: the time of the divider or of the
    /// multipliers, whichever is busier. `None` if there are aspheres, for which the number of steps depends on the
    /// ray.
    pub fn least(&self, lens: &Lens) -> Option<f64> {
        if lens.surfaces.iter().any(|surface| surface.figure.is_some()) {
            return None;
        }
        let refracting =
            lens.surfaces.iter().filter(|surface| surface.n_scene != surface.n_film).count() as f64;
        let by_divider = (ROOTS - self.computed_roots) * self.root;
        let by_multipliers = (PRODUCTS + self.computed_roots * PER_ROOT) * self.multiply_add;
        Some(refracting * by_divider.max(by_multipliers) / self.lanes)
    }

    /// Finds the register of a precision, "f32" or "f64", in an instruction set.
    pub fn of<'a>(all: &'a [Self], precision: &str, simd: Simd) -> Option<&'a Self> {
        all.iter().find(|register| register.simd == simd && register.name.starts_with(precision))
    }
}

/// Measures the registers of this processor.
#[cfg(target_arch = "x86_64")]
pub fn measure(rounds: usize) -> Vec<Register> {
    let mut registers = Vec::new();
    if Simd::Avx512.is_available() {
        // SAFETY: availability was checked just before.
        unsafe {
            registers.push(register("f32x16", Simd::Avx512, 0.0, rounds, x86::sqrt_f32x16, x86::fma_f32x16));
            registers.push(register("f64x8", Simd::Avx512, 1.0, rounds, x86::sqrt_f64x8, x86::fma_f64x8));
        }
    }
    if Simd::Avx2.is_available() {
        // SAFETY: availability was checked just before.
        unsafe {
            registers.push(register("f32x8", Simd::Avx2, 0.0, rounds, x86::sqrt_f32x8, x86::fma_f32x8));
            registers.push(register("f64x4", Simd::Avx2, 0.0, rounds, x86::sqrt_f64x4, x86::fma_f64x4));
        }
    }
    registers
}

/// Returns no registers on other processors.
#[cfg(not(target_arch = "x86_64"))]
pub fn measure(_rounds: usize) -> Vec<Register> {
    Vec::new()
}

/// Prints the times of each register.
pub fn print(registers: &[Register]) {
    println!("| | root, ns | FMA, ns |\n|---|---|---|");
    for Register { name, root, multiply_add, .. } in registers {
        println!("| {name} | {root:.2} | {multiply_add:.3} |");
    }
}

/// Iterations of a measurement; and the independent chains in each iteration, enough to hide the latency.
#[cfg(target_arch = "x86_64")]
const TURNS: usize = 4096;
#[cfg(target_arch = "x86_64")]
const CHAINS: usize = 10;

/// Measures a register.
///
/// # Safety
/// The processor supports the instructions that the two functions are compiled for.
#[cfg(target_arch = "x86_64")]
unsafe fn register(
    name: &'static str,
    simd: Simd,
    computed_roots: f64,
    rounds: usize,
    root: unsafe fn(),
    fma: unsafe fn(),
) -> Register {
    let measure = |work: unsafe fn()| {
        // SAFETY: guaranteed by the caller.
        let (_, times) = repeated(rounds, || unsafe { work() });
        median(&times) * 1e9 / (TURNS * CHAINS) as f64
    };
    let lanes = name.rsplit('x').next().and_then(|lanes| lanes.parse().ok()).expect("a name with lanes");
    Register { name, simd, lanes, root: measure(root), multiply_add: measure(fma), computed_roots }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{CHAINS, TURNS};
    use std::{arch::x86_64::*, hint::black_box};

    macro_rules! work {
        ($features:literal, $root:ident, $fma:ident, $set:ident, $sqrt:ident, $fmadd:ident) => {
            #[target_feature(enable = $features)]
            pub fn $root() {
                // The chains avoid numbers whose square roots have few digits: some divide units find the root of 1
                // faster.
                let (a, b) = ($set(black_box(0.5)), $set(black_box(3.0)));
                let mut chains = [b; CHAINS];
                for _ in 0..TURNS {
                    for chain in &mut chains {
                        *chain = $sqrt($fmadd(*chain, b, a));
                    }
                }
                black_box(chains);
            }

            #[target_feature(enable = $features)]
            pub fn $fma() {
                let (a, mut chains) = ($set(black_box(0.5)), [$set(black_box(3.0)); CHAINS]);
                for _ in 0..TURNS {
                    for chain in &mut chains {
                        *chain = $fmadd(*chain, a, a);
                    }
                }
                black_box(chains);
            }
        };
    }

    work!("avx512f", sqrt_f32x16, fma_f32x16, _mm512_set1_ps, _mm512_sqrt_ps, _mm512_fmadd_ps);
    work!("avx512f", sqrt_f64x8, fma_f64x8, _mm512_set1_pd, _mm512_sqrt_pd, _mm512_fmadd_pd);
    work!("avx2,fma", sqrt_f32x8, fma_f32x8, _mm256_set1_ps, _mm256_sqrt_ps, _mm256_fmadd_ps);
    work!("avx2,fma", sqrt_f64x4, fma_f64x4, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_fmadd_pd);
}
