//! The fast kernel: many rays at once, one quickly, all exactly.
//!
//! A [`Kernel`] is a lens compiled for one direction and one precision. It traces by the same
//! algorithm whatever the grouping of the call and the processor's registers, and **gives the same bits
//! in all of them**: every operation is correctly rounded, fused multiply-add and square root included.
//! Where the library is compiled for a processor without FMA instructions and finds none at run
//! time, fused multiply-adds are function calls: ten times slower, still the same bits.
//!
//! [`Path::walk`] is its oracle, and says why a blocked ray is blocked ([`Kernel::reason`]). The two agree
//! but for rays within rounding of an edge. Squares of n cos I below 2^-256 (double precision) or 2^-64 (single) count
//! as 0 and block.
//!
//! What follows what: `surface` gathers what is known of each surface, with what its neighbours' shapes prove; `table` makes a
//! step of each, within the growth of rounding that `rounding` allows; `rays` makes vectors of `lanes` of a caller's rays;
//! `trace` takes a `group` of them through the steps, each of which is a method in `ray` or, for what is no sphere, in `asphere`;
//! `dispersion` is the table for a wavelength per lane; `instances` compiles all that for each set of instructions in `simd`.
//! `clearance` asks the same loop how near rays come to the edges of `apertures`, for searches.
//!
//! # Instances: what is compiled, and what runs where
//!
//! A *vector* has one number of several rays, one in each *lane*, and an instruction works on all of its lanes at once. `F64x8` is
//! one of eight lanes in double precision. A portable vector is an array, which the compiler translates as it can.
//!
//! The algorithm is written once, over `Lanes`, vectors of either precision. Thin functions in `instances`, one
//! for each set of instructions and number of rays, run it. Which one, the processor ([`Simd`]) and the caller
//! (`Grouping`: `One`, `Quad` or `Wide`) decide. The environment variable `REALISTIC_SIMD` (`portable`,
//! `avx2` or `avx512`) lowers what the processor may do, once for the whole process.
//!
//! | processor | one ray: `One` | up to four: `Quad` | many: `Wide` |
//! |---|---|---|---|
//! | AVX-512F, AVX2 and FMA | one lane (`fma_one`) | `F32x4`, `F64x4` (`avx2_quad`) | `F32x16`, `F64x8` (`avx512`) |
//! | AVX2 and FMA | one lane (`fma_one`) | `F32x4`, `F64x4` (`avx2_quad`) | `F32x8`, `F64x4` (`avx2`) |
//! | other x86-64 | one portable lane (`portable_vectors`) | the same | the same |
//! | not x86-64 | one portable lane (`portable_vectors`) | four portable lanes | the same |
//!
//! The lane of `fma_one` is a `OneLane`, a portable vector of one number. Its fused multiply-add is the
//! processor's instruction there.
//!
//! Two values prove that a processor has the instructions, and no compiled instance runs without them. An
//! `Available` is a set of instructions that was found: `in_vectors` matches on it and calls the thin
//! function. A `Cpu<L>` is made by the thin function and goes along as an argument; what makes a vector of
//! `L` of numbers (`splat`, `load`) takes it.
//!
//! All runs in the caller's thread: the library starts none. A kernel is immutable, and several threads may share it.
//!
//! In the widest vectors of AVX2 and AVX-512 many rays are traced four vectors side by side (`Group`), in the end as many vectors
//! as are left; a vector that is left alone stays in registers. A step is a loop over the vectors that there are, not written out
//! for each of them: the processor overlaps them all the same, and the code is a quarter. Only aspheres are written out, for one
//! vector, two and four, of which one may be idle: their sums are too long for the processor to look beyond. Polynomials and ideal
//! lenses take one vector after the other (`Optics::SIDE_BY_SIDE`).
//!
//! Work (`InVectors`: a camera's samples, or rays in arrays, through `Optics`) is compiled for each entry of the table that a caller may ask for. Code
//! that all work has in common is not:
//! - The steps of a lens are one function for each kind of vectors (`Lanes::apart`), which all work calls.
//!   They are inlined into work on vectors that are not `Lanes::SHARED`: one lane and `F32x4`, of which only
//!   the latency counts, and four portable lanes. `F64x4` is shared, for it is also AVX2's widest vector.
//! - On x86-64 all processors of the last ten years have AVX2, so that the code of portable vectors is small rather than quick.
//!
//! Beside the table, `Simd::run` compiles other work (`Compiled`), such as one look-up in the pupil's map, for each set of
//! instructions, so that its fused multiplications are the processor's own.
//!
//! On `#[cfg_attr(not(debug_assertions), inline(always))]`, which stands at functions below `instances`
//! (the smallest are `inline(always)` in every build): a vector operation is compiled for a processor only
//! inside a function that is, so that all of them must be inlined into the thin functions there, or into
//! the function of its own that `Lanes::apart` makes. With debug assertions they are called instead, with
//! the same bits: described to a debugger, functions of that size overflow LLVM's stack. An attribute
//! cannot be given a name of its own in stable Rust.

mod apertures;
mod asphere;
mod clearance;
mod dispersion;
mod group;
mod instances;
mod lanes;
mod ray;
mod rays;
mod rounding;
mod simd;
mod surface;
mod table;
mod trace;

pub(crate) use clearance::{ClearanceTracer, FilmRay};
pub(crate) use dispersion::SpectralKernel;
pub use instances::KernelScalar;
pub use rays::{LensRays, PlaneRays, RayBuffer, Traced};
pub use simd::Simd;
pub(crate) use simd::{Available, Compiled};

pub(crate) use self::{
    asphere::Profile,
    group::Group,
    instances::{Grouping, InVectors, Optics, in_vectors},
    lanes::{Cpu, Lanes, OneLane, Portable, Scalar},
    ray::{End, Start, power},
    rays::{Approach, Arrays, from_plane, trace_few},
    table::Table,
};
use crate::{
    lens::{Lens, Ray, refraction::Refraction},
    trace::{
        Blocked,
        path::{Direction, Path},
    },
};

/// A lens compiled for tracing rays in one direction with numbers of type `S`: `f64` or `f32`.
///
/// Immutable; may be shared between threads.
#[derive(Clone, Debug)]
pub struct Kernel<S> {
    table: Table<S>,
    path: Path<f64>,
    simd: Available,
}

impl<S: KernelScalar> Kernel<S> {
    /// Compiles a lens for the best instructions that there are ([`Simd::best`]).
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        Self::along(&Path::new(lens, direction, Refraction::Fused))
    }

    /// [`Kernel::new`] of a path that there is already; it may have mirrors ([`Path::reflected`]).
    pub fn along(path: &Path) -> Self {
        Self::compile(path.clone(), Available::best())
    }

    /// Compiles a lens for the instructions named; `None` where the processor lacks them.
    pub fn with_simd(lens: &Lens, direction: Direction, simd: Simd) -> Option<Self> {
        let path = || Path::new(lens, direction, Refraction::Fused);
        simd.available().map(|simd| Self::compile(path(), simd))
    }

    fn compile(path: Path, simd: Available) -> Self {
        Self { table: Table::new(&path, S::AMPLIFICATION), path, simd }
    }

    /// The instructions in use.
    pub fn simd(&self) -> Simd {
        self.simd.simd()
    }

    /// The knowledge that the processor has them.
    pub(crate) fn available(&self) -> Available {
        self.simd
    }

    /// What rays are taken through.
    pub(crate) fn table(&self) -> &Table<S> {
        &self.table
    }

    /// One ray from `point` (x, y in mm) on the plane z = `plane` (mm, lens space), with slopes dx/dz
    /// and dy/dz; `None` where the lens blocks it.
    #[inline]
    pub fn trace_one(&self, plane: f64, point: [S; 2], slopes: [S; 2]) -> Option<Traced<S>> {
        let [traced] =
            trace_few(plane, [point], [slopes], |from, to| self.trace(Grouping::One, Some(from), to));
        traced
    }

    /// Three rays as in [`Kernel::trace_one`], in little more than the time of one: a ray and its two
    /// differentials.
    #[inline]
    pub fn trace_triple(
        &self,
        plane: f64,
        points: [[S; 2]; 3],
        slopes: [[S; 2]; 3],
    ) -> [Option<Traced<S>>; 3] {
        let [a, b, c] = points;
        let [s, t, u] = slopes;
        let trace =
            |from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>| self.trace(Grouping::Quad, Some(from), to);
        let [first, second, third, _] = trace_few(plane, [a, b, c, a], [s, t, u, s], trace);
        [first, second, third]
    }

    /// Many rays from a plane. Origin and direction of a blocked ray are 0.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn trace_batch(&self, from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>) {
        let n = from.checked_len();
        assert_eq!(n, to.checked_len(), "a batch needs as much room as it has rays");
        self.trace(Grouping::Wide, Some(from), to);
    }

    /// Many rays, each from anywhere before the first surface with a direction of any length but 0; the
    /// outcome takes their place. Origin and direction of a blocked ray become 0.
    ///
    /// # Panics
    /// The arrays differ in length.
    pub fn trace_in_place(&self, rays: &mut LensRays<'_, S>) {
        rays.checked_len();
        self.trace(Grouping::Wide, None, rays);
    }

    #[inline(always)]
    fn trace(&self, grouping: Grouping, from: Option<&PlaneRays<'_, S>>, to: &mut LensRays<'_, S>) {
        S::trace(self.simd, grouping, &mut Arrays { optics: &self.table, from, to });
    }

    /// Why a ray is blocked, by the scalar walk. Where the walk in double precision lets it through it
    /// passes within rounding of the edge of a clear aperture, and is [`Blocked::Clipped`].
    pub fn reason(&self, ray: Ray) -> Blocked {
        self.path.walk(ray).blocked.unwrap_or(Blocked::Clipped)
    }
}
