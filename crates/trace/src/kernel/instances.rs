//! The algorithm compiled for each instruction set. There is one thin function per instruction set and grouping of
//! rays. All functions that it calls are inlined into it (see the parent module), except the code that [`Lanes::apart`]
//! compiles separately and that all thin functions share.

use super::{
    carried::Carried,
    dispersion::Own,
    ray_arrays::{Approach, Arrays},
    ray_lanes::{End, RayLanes, Start},
    table::Table,
    trace::{enter, through},
};
#[cfg(target_arch = "x86_64")]
use realistic_simd::Simd;
#[cfg(target_arch = "x86_64")]
use realistic_simd::lanes::{
    avx2::{F32x4, F32x8, F64x4},
    avx512::{F32x16, F64x8},
};
use realistic_simd::{Available, Cpu, Lanes, Portable, Scalar};

/// The vectors of one precision.
pub trait KernelScalar: Scalar {
    /// Four lanes in AVX2's registers.
    #[cfg(target_arch = "x86_64")]
    type Quad: Lanes<Scalar = Self>;
    /// The widest vector of AVX2.
    #[cfg(target_arch = "x86_64")]
    type Avx2: Lanes<Scalar = Self>;
    /// The widest vector of AVX-512.
    #[cfg(target_arch = "x86_64")]
    type Avx512: Lanes<Scalar = Self>;
    /// Largest amplification of rounding errors that a link may have. With a larger limit, the errors of the rays in
    /// tests/golden begin to grow.
    const AMPLIFICATION: f64;

    /// Traces rays in arrays. This is compiled here, not at each use.
    fn trace(simd: Available, grouping: Grouping, rays: &mut Arrays<'_, '_, '_, Self, LensSteps<Self, Own>>);
}

impl KernelScalar for f64 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F64x8;
    const AMPLIFICATION: f64 = 25.0;

    fn trace(simd: Available, grouping: Grouping, rays: &mut Arrays<'_, '_, '_, Self, LensSteps<Self, Own>>) {
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

    fn trace(simd: Available, grouping: Grouping, rays: &mut Arrays<'_, '_, '_, Self, LensSteps<Self, Own>>) {
        in_vectors(simd, grouping, rays);
    }
}

/// Number of vectors that are traced side by side, so that the roots of one vector overlap the multiplications of
/// another. Chosen by measurement: three to eight vectors are within 7 %.
#[cfg(target_arch = "x86_64")]
const INTERLEAVED: usize = 4;
/// Number of lanes in a portable batch. An x86-64 processor that runs this code has no fused multiply-add instruction,
/// so the operation is a function call per lane. One lane is then as fast, and shares the code of single rays.
const PORTABLE: usize = if cfg!(target_arch = "x86_64") { 1 } else { 4 };

/// Optics that vectors of rays are traced through.
pub trait Optics<S: Scalar> {
    /// A vector of rays between [`Optics::enter`] and [`Optics::leave`].
    type OnWay<L: Lanes<Scalar = S>>: Copy;
    /// The data that the rays carry ([`Carried`]).
    type State<L: Lanes<Scalar = S>>: Copy;
    /// Whether vectors take less time side by side, each step for all of them, than one after another.
    const SIDE_BY_SIDE: bool = false;
    /// Returns the plane from which rays start.
    fn approach(&self) -> Approach;
    /// Takes a vector of rays to the point where other vectors may join it. `wavelengths`, nm, are arbitrary if the
    /// rays do not have their own wavelengths.
    fn enter<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        wavelengths: L,
        start: Start<L>,
    ) -> (Self::OnWay<L>, Self::State<L>);
    /// Traces vectors of rays, each with its data, side by side: the first `count` of `U`. The remaining vectors are
    /// idle. Does nothing if [`Optics::enter`] has already taken the rays through the optics.
    #[inline(always)]
    fn through<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        _: Cpu<L>,
        _: &mut [Self::OnWay<L>; U],
        _: &mut [Self::State<L>; U],
        _: usize,
    ) {
    }
    /// Returns the optical path of a vector of rays, mm, if they carry it.
    #[inline(always)]
    fn optical_path<L: Lanes<Scalar = S>>(&self, _: Cpu<L>, _: &Self::State<L>) -> Option<L> {
        None
    }
    /// Returns the result of a vector of rays.
    fn leave<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        rays: Self::OnWay<L>,
        state: &Self::State<L>,
    ) -> End<L>;
}

/// The steps of a lens, and the constants for the data that its rays carry.
#[derive(Clone, Debug)]
pub struct LensSteps<S, C> {
    /// Steps of the surfaces, in the order of the rays.
    pub table: Table<S>,
    /// Constants for the data that rays carry.
    pub carried: C,
}

impl<S: Scalar, C: Carried<S>> Optics<S> for LensSteps<S, C> {
    type OnWay<L: Lanes<Scalar = S>> = RayLanes<L>;
    type State<L: Lanes<Scalar = S>> = C::State<L>;
    const SIDE_BY_SIDE: bool = true;

    #[inline(always)]
    fn approach(&self) -> Approach {
        Approach { entry: self.table.entry, travel_sign: self.table.travel_sign }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        wavelengths: L,
        start: Start<L>,
    ) -> (RayLanes<L>, C::State<L>) {
        enter(cpu, &self.table, &self.carried, wavelengths, start)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn through<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L>; U],
        states: &mut [C::State<L>; U],
        count: usize,
    ) {
        through(cpu, &self.table, &self.carried, rays, states, count);
    }

    #[inline(always)]
    fn optical_path<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &C::State<L>) -> Option<L> {
        self.carried.optical_path(cpu, state)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn leave<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, rays: RayLanes<L>, state: &C::State<L>) -> End<L> {
        let rays = match self.carried.per_last_index(cpu, state) {
            Some(factor) => rays.scaled(factor),
            None => rays,
        };
        rays.leave(cpu, &self.table, self.carried.left(cpu, state))
    }
}

/// Division of a batch into vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grouping {
    /// The widest vectors, for throughput.
    Wide,
    /// A vector of four, for the latency of up to four rays.
    Quad,
    /// A single lane, for the latency of one ray.
    One,
}

impl Grouping {
    /// Returns the grouping that takes the least time for this number of rays.
    #[inline(always)]
    pub fn of(rays: usize) -> Self {
        match rays {
            0 | 1 => Self::One,
            2..=4 => Self::Quad,
            _ => Self::Wide,
        }
    }
}

/// Work on many elements, several vectors of elements at a time.
#[allow(clippy::len_without_is_empty, reason = "the loops need the number alone")]
pub trait InVectors<S: Scalar> {
    /// Returns the number of elements.
    fn len(&self) -> usize;
    /// Does the work for `count` vectors of elements, from one to `U`, starting with element number `first`. Only the
    /// last vector may extend beyond the last element.
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize);
}

/// Does work in the vectors for an instruction set and a grouping.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn in_vectors<S: KernelScalar, W: InVectors<S>>(simd: Available, grouping: Grouping, work: &mut W) {
    #[cfg(target_arch = "x86_64")]
    match simd.simd() {
        Simd::Portable => {}
        // SAFETY: the processor has these instructions.
        Simd::Avx512 if grouping == Grouping::Wide => return unsafe { avx512(work) },
        // SAFETY: as above; a processor with AVX-512 has AVX2.
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

/// Does work one element at a time, with the bits of [`in_vectors`] and in the instance that compiles fastest. For unit
/// tests: the others take minutes to compile.
pub fn one_by_one<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    portable_vectors::<1, _, _>(work);
}

/// Does work in portable vectors. Not inlined, so that all calls of one width share this function. On x86-64, where
/// only the oldest processors run it, all callers also share the steps.
#[inline(never)]
fn portable_vectors<const LANES: usize, S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    each::<Portable<S, LANES, { cfg!(target_arch = "x86_64") }>, 1, _>(Portable::cpu(), work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn avx512<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    // SAFETY: this function is called only on processors with the instructions that it is compiled for.
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

/// Does work on no more elements than one vector has. There is no loop, because the compiler would load constants
/// before the loop into registers that the surfaces need.
#[cfg(target_arch = "x86_64")]
#[cfg_attr(not(debug_assertions), inline(always))]
fn once<L: Lanes, W: InVectors<L::Scalar>>(cpu: Cpu<L>, work: &mut W) {
    if work.len() > 0 {
        work.group::<L, 1>(cpu, 0, 1);
    }
}

/// Does work `U` vectors at a time; the last group has the vectors that remain.
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
