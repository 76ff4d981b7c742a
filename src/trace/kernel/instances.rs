//! The algorithm compiled for each set of instructions: thin functions, one a set and a shape of call.
//!
//! Everything below them is inlined into them, which is what compiles it for their instructions. In
//! builds with debug assertions it is not: the same numbers, slowly, and LLVM 22 overflows its stack
//! on functions of that size when it also describes them to a debugger.

#[cfg(target_arch = "x86_64")]
use super::lanes::{
    avx2::{F32x4, F32x8, F64x4},
    avx512::{F32x16, F64x8},
};
use super::{
    Simd,
    batch::{Batch, Few, FromPlane, InPlace},
    lanes::{Cpu, Lanes, Portable, Scalar},
    march::{Start, march},
    table::Table,
};

/// The vectors of one precision.
pub trait Vectors: Scalar {
    /// Four lanes of AVX2's.
    #[cfg(target_arch = "x86_64")]
    type Quad: Lanes<Scalar = Self>;
    /// AVX2's widest.
    #[cfg(target_arch = "x86_64")]
    type Avx2: Lanes<Scalar = Self>;
    /// AVX-512's widest.
    #[cfg(target_arch = "x86_64")]
    type Avx512: Lanes<Scalar = Self>;
    /// Largest amplification of rounding that a link may have: where the golden rays' errors begin to grow.
    const AMPLIFICATION: f64;

    /// Rays from a plane.
    fn from_plane(simd: Simd, table: &Table<Self>, batch: &mut FromPlane<'_, '_, '_, Self>);
    /// Rays from anywhere, in place.
    fn in_place(simd: Simd, table: &Table<Self>, batch: &mut InPlace<'_, '_, Self>);
    /// One ray, for latency.
    fn one(simd: Simd, table: &Table<Self>, batch: &mut Few<Self, 1>);
    /// Up to four rays, for latency.
    fn quad(simd: Simd, table: &Table<Self>, batch: &mut Few<Self, 4>);
}

/// The algorithm's instances of one precision, compiled here and not where they are used.
macro_rules! compile {
    () => {
        fn from_plane(simd: Simd, table: &Table<Self>, batch: &mut FromPlane<'_, '_, '_, Self>) {
            run(simd, Shape::Wide, table, batch);
        }
        fn in_place(simd: Simd, table: &Table<Self>, batch: &mut InPlace<'_, '_, Self>) {
            run(simd, Shape::Wide, table, batch);
        }
        fn one(simd: Simd, table: &Table<Self>, batch: &mut Few<Self, 1>) {
            run(simd, Shape::One, table, batch);
        }
        fn quad(simd: Simd, table: &Table<Self>, batch: &mut Few<Self, 4>) {
            run(simd, Shape::Quad, table, batch);
        }
    };
}

impl Vectors for f64 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F64x8;
    const AMPLIFICATION: f64 = 25.0;
    compile!();
}

impl Vectors for f32 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F32x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F32x8;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F32x16;
    const AMPLIFICATION: f64 = 16.0;
    compile!();
}

/// Vectors traced side by side, so that one's roots overlap another's multiplications: measured; two to four are within 8 %.
const INTERLEAVED: usize = 3;
/// Lanes of the portable batch.
const PORTABLE: usize = 4;

/// How a batch is cut up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// The widest vectors, for throughput.
    Wide,
    /// Vectors of four, one after the other, for the latency of up to four rays.
    Quad,
    /// One ray after the other, for the latency of one.
    One,
}

/// Traces a batch.
#[cfg_attr(not(debug_assertions), inline(always))]
fn run<S: Vectors, B: Batch<S>>(simd: Simd, shape: Shape, table: &Table<S>, batch: &mut B) {
    debug_assert!(simd.is_available());
    #[cfg(target_arch = "x86_64")]
    match simd {
        // SAFETY: a `Kernel` is built only for instructions that the processor has.
        Simd::Avx512 if shape == Shape::Wide => return unsafe { avx512(table, batch) },
        // SAFETY: as above; what has AVX-512 has AVX2.
        Simd::Avx512 | Simd::Avx2 => unsafe {
            return match shape {
                Shape::Wide => avx2(table, batch),
                Shape::Quad => avx2_quad(table, batch),
                Shape::One => fma_one(table, batch),
            };
        },
        Simd::Portable => {}
    }
    match shape {
        Shape::Wide => each::<Portable<S, PORTABLE>, 1, _>(Cpu::any(), table, batch),
        Shape::Quad => each::<Portable<S, 4>, 1, _>(Cpu::any(), table, batch),
        Shape::One => each::<Portable<S, 1>, 1, _>(Cpu::any(), table, batch),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512<S: Vectors, B: Batch<S>>(table: &Table<S>, batch: &mut B) {
    // SAFETY: this function is called only where the processor has what it is compiled for.
    each::<S::Avx512, INTERLEAVED, _>(unsafe { Cpu::assume() }, table, batch);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<S: Vectors, B: Batch<S>>(table: &Table<S>, batch: &mut B) {
    // SAFETY: as in `avx512`.
    each::<S::Avx2, INTERLEAVED, _>(unsafe { Cpu::assume() }, table, batch);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2_quad<S: Vectors, B: Batch<S>>(table: &Table<S>, batch: &mut B) {
    // SAFETY: as in `avx512`.
    each::<S::Quad, 1, _>(unsafe { Cpu::assume() }, table, batch);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fma_one<S: Vectors, B: Batch<S>>(table: &Table<S>, batch: &mut B) {
    each::<Portable<S, 1>, 1, _>(Cpu::any(), table, batch);
}

/// Traces a batch `U` vectors at a time, what is left one at a time.
#[cfg_attr(not(debug_assertions), inline(always))]
fn each<L: Lanes, const U: usize, B: Batch<L::Scalar>>(cpu: Cpu<L>, table: &Table<L::Scalar>, batch: &mut B) {
    let n = batch.len();
    let mut done = 0;
    while U > 1 && n - done >= U * L::WIDTH {
        block::<L, U, B>(cpu, table, batch, done);
        done += U * L::WIDTH;
    }
    while done < n {
        block::<L, 1, B>(cpu, table, batch, done);
        done += L::WIDTH;
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn block<L: Lanes, const U: usize, B: Batch<L::Scalar>>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    batch: &mut B,
    first: usize,
) {
    let mut starts: [Start<L>; U] = [batch.start(cpu, table, first); U];
    for (u, start) in starts.iter_mut().enumerate().skip(1) {
        *start = batch.start(cpu, table, first + u * L::WIDTH);
    }
    let ends = if B::FLAT {
        march::<L, U, true>(cpu, table, starts)
    } else {
        march::<L, U, false>(cpu, table, starts)
    };
    for u in 0..U {
        batch.finish(cpu, first + u * L::WIDTH, starts[u].v[2], ends[u]);
    }
}
