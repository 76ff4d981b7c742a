//! What the processor can do at best: square roots through the divider, and fused multiply-adds.

#[cfg(target_arch = "x86_64")]
use realistic_lab::{results::statistics::median, timing::repeated};

/// Prints the throughput of both a register, and of the 20 roots and 200 other operations that a double Gauss's
/// ten refracting surfaces need, in ns per ray.
#[cfg(target_arch = "x86_64")]
pub fn print(rounds: usize) {
    println!("| | root, ns | FMA, ns | 20 roots, ns per ray | 200 FMA, ns per ray |\n|---|---|---|---|---|");
    if std::is_x86_feature_detected!("avx512f") {
        // SAFETY: just asked.
        unsafe {
            row("f32x16", 16.0, rounds, x86::sqrt_f32x16, x86::fma_f32x16);
            row("f64x8", 8.0, rounds, x86::sqrt_f64x8, x86::fma_f64x8);
        }
    }
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        // SAFETY: just asked.
        unsafe {
            row("f32x8", 8.0, rounds, x86::sqrt_f32x8, x86::fma_f32x8);
            row("f64x4", 4.0, rounds, x86::sqrt_f64x4, x86::fma_f64x4);
        }
    }
}

/// Other processors have no table.
#[cfg(not(target_arch = "x86_64"))]
pub fn print(_rounds: usize) {}

/// Turns of a measurement, and independent chains in each, enough to hide the latency.
#[cfg(target_arch = "x86_64")]
const TURNS: usize = 4096;
#[cfg(target_arch = "x86_64")]
const CHAINS: usize = 10;

/// # Safety
/// The processor has what the two functions are compiled for.
#[cfg(target_arch = "x86_64")]
unsafe fn row(name: &str, lanes: f64, rounds: usize, root: unsafe fn(), fma: unsafe fn()) {
    let measure = |work: unsafe fn()| {
        // SAFETY: the caller's promise.
        let (_, times) = repeated(rounds, || unsafe { work() });
        median(&times) * 1e9 / (TURNS * CHAINS) as f64
    };
    let (root, fma) = (measure(root), measure(fma));
    println!("| {name} | {root:.2} | {fma:.3} | {:.1} | {:.1} |", 20.0 * root / lanes, 200.0 * fma / lanes);
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{CHAINS, TURNS};
    use std::{arch::x86_64::*, hint::black_box};

    macro_rules! work {
        ($features:literal, $root:ident, $fma:ident, $set:ident, $sqrt:ident, $fmadd:ident) => {
            #[target_feature(enable = $features)]
            pub fn $root() {
                // Toward no number whose root is short: of 1 some dividers take less time.
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
