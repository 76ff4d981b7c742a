//! The algorithm compiled for each set of instructions: thin functions, one a set and a grouping of rays, into which
//! everything below them is inlined (see the room's own page), but for what is compiled apart for all of them
//! ([`Lanes::apart`]).

#[cfg(target_arch = "x86_64")]
use super::Simd;
#[cfg(target_arch = "x86_64")]
use super::lanes::{
    avx2::{F32x4, F32x8, F64x4},
    avx512::{F32x16, F64x8},
};
use super::{
    Available,
    dispersion::Own,
    lanes::{Cpu, Lanes, Portable, Scalar},
    ray::{End, RayLanes, Start},
    rays::{Approach, Arrays},
    table::Table,
    trace::through,
};

/// The vectors of one precision.
pub trait KernelScalar: Scalar {
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

    /// Traces rays of arrays. Compiled here and not where it is used.
    fn trace(simd: Available, grouping: Grouping, rays: &mut Arrays<'_, '_, '_, Self, Table<Self>>);
}

impl KernelScalar for f64 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F64x8;
    const AMPLIFICATION: f64 = 25.0;

    fn trace(simd: Available, grouping: Grouping, rays: &mut Arrays<'_, '_, '_, Self, Table<Self>>) {
        in_vectors(simd, grouping, rays);
    }
}

impl KernelScalar for f32 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F32x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F32x8;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F32x16;
    const AMPLIFICATION: f64 = 16.0;

    fn trace(simd: Available, grouping: Grouping, rays: &mut Arrays<'_, '_, '_, Self, Table<Self>>) {
        in_vectors(simd, grouping, rays);
    }
}

/// Vectors traced side by side, so that one's roots overlap another's multiplications: measured; three to eight are
/// within 7 %.
#[cfg(target_arch = "x86_64")]
const INTERLEAVED: usize = 4;
/// Lanes of the portable batch. An x86-64 processor that comes here has no fused multiply-add, which is then a function
/// call per lane: one lane is as quick, and is the code that single rays take.
const PORTABLE: usize = if cfg!(target_arch = "x86_64") { 1 } else { 4 };

/// What rays are taken through in lanes.
pub trait Optics<S: Scalar> {
    /// A vector of rays on its way.
    type OnWay<L: Lanes<Scalar = S>>: Copy;
    /// What is known of its light, where rays have wavelengths of their own; else `()`.
    type Light<L: Lanes<Scalar = S>>: Copy;
    /// Whether vectors take less time side by side, each step for all of them, than one after the other.
    const SIDE_BY_SIDE: bool;
    /// Where rays start.
    fn approach(&self) -> Approach;
    /// Takes a vector of rays to where others may join it. `wavelengths`, nm, are anything where rays have none of their own.
    fn enter<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        wavelengths: L,
        start: Start<L>,
    ) -> (Self::OnWay<L>, Self::Light<L>);
    /// Takes vectors of rays, each with its light, through, side by side: the first `count` of `U`. Those behind them are
    /// idle.
    fn through<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [Self::OnWay<L>; U],
        light: &mut [Self::Light<L>; U],
        count: usize,
    );
    /// What became of a vector of rays, with its squared cosine to the axis before.
    fn leave<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, rays: Self::OnWay<L>) -> (End<L>, L);
}

impl<S: Scalar> Optics<S> for Table<S> {
    type OnWay<L: Lanes<Scalar = S>> = RayLanes<L>;
    type Light<L: Lanes<Scalar = S>> = ();
    const SIDE_BY_SIDE: bool = true;

    #[inline(always)]
    fn approach(&self) -> Approach {
        Approach { entry: self.entry, travel_sign: self.travel_sign }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, _: L, start: Start<L>) -> (RayLanes<L>, ()) {
        (RayLanes::enter(cpu, &self.steps[0], Own, start), ())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn through<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L>; U],
        _: &mut [(); U],
        count: usize,
    ) {
        through(cpu, self, &mut Own, rays, count);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn leave<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, rays: RayLanes<L>) -> (End<L>, L) {
        (rays.leave(cpu, self), rays.cos2)
    }
}

/// How a batch is cut up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grouping {
    /// The widest vectors, for throughput.
    Wide,
    /// A vector of four, for the latency of up to four rays.
    Quad,
    /// For the latency of one ray.
    One,
}

impl Grouping {
    /// The one that takes least time for so many rays.
    #[inline(always)]
    pub fn of(rays: usize) -> Self {
        match rays {
            0 | 1 => Self::One,
            2..=4 => Self::Quad,
            _ => Self::Wide,
        }
    }
}

/// Work on many elements, vectors of them at a time.
pub trait InVectors<S: Scalar> {
    /// How many elements.
    fn len(&self) -> usize;
    /// Does the work for `count` vectors of elements, from one to `U`, from the element numbered `first` on. Only the last may
    /// reach beyond the last element.
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize);
}

/// Does work in vectors.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn in_vectors<S: KernelScalar, W: InVectors<S>>(simd: Available, grouping: Grouping, work: &mut W) {
    #[cfg(target_arch = "x86_64")]
    match simd.simd() {
        Simd::Portable => {}
        // SAFETY: the processor has these instructions.
        Simd::Avx512 if grouping == Grouping::Wide => return unsafe { avx512(work) },
        // SAFETY: as above; what has AVX-512 has AVX2.
        Simd::Avx512 | Simd::Avx2 => unsafe {
            return match grouping {
                Grouping::Wide => avx2(work),
                Grouping::Quad => avx2_quad(work),
                Grouping::One => fma_one(work),
            };
        },
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (simd, grouping);
    if work.len() == 1 {
        portable_vectors::<1, _, _>(work);
    } else {
        portable_vectors::<PORTABLE, _, _>(work);
    }
}

/// Not inlined, so that all calls of one width share it; on x86-64, where none but the oldest processors come here, all
/// callers share the steps, too.
#[inline(never)]
fn portable_vectors<const LANES: usize, S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    each::<Portable<S, LANES, { cfg!(target_arch = "x86_64") }>, 1, _>(Portable::cpu(), work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    // SAFETY: this function is called only where the processor has what it is compiled for.
    each::<S::Avx512, INTERLEAVED, _>(unsafe { Cpu::assume() }, work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    // SAFETY: as in `avx512`.
    each::<S::Avx2, INTERLEAVED, _>(unsafe { Cpu::assume() }, work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2_quad<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    // SAFETY: as in `avx512`.
    once::<S::Quad, _>(unsafe { Cpu::assume() }, work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fma_one<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    once::<Portable<S, 1>, _>(Portable::cpu(), work);
}

/// Does work on no more elements than a vector has. Without a loop, before which the compiler would put constants into
/// registers that the surfaces need.
#[cfg(target_arch = "x86_64")]
#[cfg_attr(not(debug_assertions), inline(always))]
fn once<L: Lanes, W: InVectors<L::Scalar>>(cpu: Cpu<L>, work: &mut W) {
    if work.len() > 0 {
        work.group::<L, 1>(cpu, 0, 1);
    }
}

/// Does work `U` vectors at a time, in the end as many as are left.
#[cfg_attr(not(debug_assertions), inline(always))]
fn each<L: Lanes, const U: usize, W: InVectors<L::Scalar>>(cpu: Cpu<L>, work: &mut W) {
    let n = work.len();
    let mut done = 0;
    while done < n {
        let count = if U == 1 { 1 } else { (n - done).div_ceil(L::WIDTH).min(U) };
        work.group::<L, U>(cpu, done, count);
        done += U * L::WIDTH;
    }
}
