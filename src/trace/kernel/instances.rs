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
    group::Group,
    lanes::{Cpu, Lanes, Portable, Scalar},
    ray::{End, RayLanes, Start},
    rays::{Approach, Batch, InPlaceBatch, PlaneBatch, RaysByValue},
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

    /// Rays from a plane.
    fn from_plane(simd: Available, table: &Table<Self>, batch: &mut PlaneBatch<'_, '_, '_, Self>);
    /// Rays from anywhere, in place.
    fn in_place(simd: Available, table: &Table<Self>, batch: &mut InPlaceBatch<'_, '_, Self>);
    /// One ray, for latency.
    fn one(simd: Available, table: &Table<Self>, batch: &mut RaysByValue<Self, 1>);
    /// Up to four rays, for latency.
    fn quad(simd: Available, table: &Table<Self>, batch: &mut RaysByValue<Self, 4>);
}

/// The algorithm's instances of one precision, compiled here and not where they are used.
macro_rules! compile {
    () => {
        fn from_plane(simd: Available, table: &Table<Self>, batch: &mut PlaneBatch<'_, '_, '_, Self>) {
            run(simd, Grouping::Wide, table, batch);
        }
        fn in_place(simd: Available, table: &Table<Self>, batch: &mut InPlaceBatch<'_, '_, Self>) {
            run(simd, Grouping::Wide, table, batch);
        }
        fn one(simd: Available, table: &Table<Self>, batch: &mut RaysByValue<Self, 1>) {
            run(simd, Grouping::One, table, batch);
        }
        fn quad(simd: Available, table: &Table<Self>, batch: &mut RaysByValue<Self, 4>) {
            run(simd, Grouping::Quad, table, batch);
        }
    };
}

impl KernelScalar for f64 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F64x4;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F64x8;
    const AMPLIFICATION: f64 = 25.0;
    compile!();
}

impl KernelScalar for f32 {
    #[cfg(target_arch = "x86_64")]
    type Quad = F32x4;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = F32x8;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = F32x16;
    const AMPLIFICATION: f64 = 16.0;
    compile!();
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
    /// Takes a vector of rays, those from the one numbered `at` on, to where others may join it.
    fn enter<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        at: usize,
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
    fn enter<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, _: usize, start: Start<L>) -> (RayLanes<L>, ()) {
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
    /// Vectors of four, one after the other, for the latency of up to four rays.
    Quad,
    /// One ray after the other, for the latency of one.
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
    /// Does the work for `U` vectors of elements from the one numbered `first` on. Only the last may reach beyond the last
    /// element.
    fn vectors<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize);
    /// The same for `count` vectors, from one to `U`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        if count == U {
            return self.vectors::<L, U>(cpu, first);
        }
        for u in 0..count {
            self.vectors::<L, 1>(cpu, first + u * L::WIDTH);
        }
    }
}

/// Traces a batch.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn run<S: KernelScalar, O: Optics<S>, B: Batch<S>>(
    simd: Available,
    grouping: Grouping,
    optics: &O,
    batch: &mut B,
) {
    in_vectors(simd, grouping, &mut Through { optics, batch });
}

/// Does work in vectors.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn in_vectors<S: KernelScalar, W: InVectors<S>>(simd: Available, grouping: Grouping, work: &mut W) {
    if !in_registers(simd, grouping, work) {
        portable(work);
    }
}

/// Does work in vectors of more than the portable instructions; `false`, and nothing done, where there are none.
#[cfg_attr(not(debug_assertions), inline(always))]
#[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables, reason = "one set of instructions only"))]
pub fn in_registers<S: KernelScalar, W: InVectors<S>>(
    simd: Available,
    grouping: Grouping,
    work: &mut W,
) -> bool {
    #[cfg(target_arch = "x86_64")]
    match simd.simd() {
        Simd::Portable => return false,
        // SAFETY: the processor has these instructions.
        Simd::Avx512 if grouping == Grouping::Wide => unsafe { avx512(work) },
        // SAFETY: as above; what has AVX-512 has AVX2.
        Simd::Avx512 | Simd::Avx2 => unsafe {
            match grouping {
                Grouping::Wide => avx2(work),
                Grouping::Quad => avx2_quad(work),
                Grouping::One => fma_one(work),
            }
        },
    }
    cfg!(target_arch = "x86_64")
}

/// Does work in portable vectors.
pub fn portable<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
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
    each::<S::Quad, 1, _>(unsafe { Cpu::assume() }, work);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fma_one<S: KernelScalar, W: InVectors<S>>(work: &mut W) {
    each::<Portable<S, 1>, 1, _>(Portable::cpu(), work);
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

/// A batch on its way through optics.
pub struct Through<'a, O, B> {
    pub optics: &'a O,
    pub batch: &'a mut B,
}

impl<O, B> Through<'_, O, B> {
    /// One vector of rays from the one numbered `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes>(&mut self, cpu: Cpu<L>, at: usize)
    where
        O: Optics<L::Scalar>,
        B: Batch<L::Scalar>,
    {
        let Self { optics, batch } = self;
        let [ready] = batch.prepare(cpu, at);
        let (start, carry) = batch.start(cpu, optics.approach(), ready);
        let (entered, light) = optics.enter(cpu, at, start);
        let mut rays = [entered];
        optics.through(cpu, &mut rays, &mut [light], 1);
        let (end, cos2) = optics.leave(cpu, rays[0]);
        batch.finish(cpu, at, cos2, carry, end);
    }
}

impl<S: Scalar, O: Optics<S>, B: Batch<S>> InVectors<S> for Through<'_, O, B> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.batch.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vectors<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize) {
        self.group::<L, U>(cpu, first, U);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        // Alone it stays in registers.
        if U == 1 || count == 1 || !O::SIDE_BY_SIDE {
            for u in 0..count {
                self.vector(cpu, first + u * L::WIDTH);
            }
            return;
        }
        let Self { optics, batch } = self;
        let (mut rays, mut light, mut carried) =
            (Group::<_, U>::new(), Group::<_, U>::new(), Group::<_, U>::new());
        let together: Option<[B::Ready<L>; U]> =
            if L::PREPARED_TOGETHER && count == U { Some(batch.prepare(cpu, first)) } else { None };
        for u in 0..count {
            let at = first + u * L::WIDTH;
            let ready = match &together {
                Some(all) => all[u],
                None => {
                    let [one] = batch.prepare(cpu, at);
                    one
                }
            };
            let (start, carry) = batch.start(cpu, optics.approach(), ready);
            let (entered, of_rays) = optics.enter(cpu, at, start);
            rays.push(entered);
            light.push(of_rays);
            carried.push(carry);
        }
        let rays = rays.filled();
        optics.through(cpu, rays, light.filled(), count);
        for (u, rays) in rays.iter().enumerate().take(count) {
            let (end, cos2) = optics.leave(cpu, *rays);
            batch.finish(cpu, first + u * L::WIDTH, cos2, carried.get(u), end);
        }
    }
}
