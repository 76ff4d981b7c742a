//! The fast kernel, which traces many rays at once, or one ray quickly, and all rays exactly.
//!
//! A [`Kernel`] is a lens compiled for one direction and one precision. It uses the same algorithm for every grouping
//! of rays and every register width, and **gives the same bits in all cases**: every operation is correctly rounded,
//! fused multiply-add and square root included. If the library is compiled for a processor without FMA instructions and
//! finds none at run time, fused multiply-adds are function calls: ten times slower, but with the same bits.
//!
//! [`Path::walk`] is the reference, and gives the reason why a ray is blocked ([`Kernel::reason`]). Kernel and walk
//! agree except on rays within rounding of an edge. Squares of n cos I below 2^-256 (double precision) or 2^-64
//! (single) count as 0 and block the ray.
//!
//! Modules in order: `surface` collects the data of each surface, with the facts that the shapes of its neighbours
//! prove; `table` converts each surface to a step, within the growth of rounding errors that `rounding` allows;
//! `ray_arrays` loads a caller's rays into vectors of lanes; `trace` takes a `group` of vectors through the steps, each
//! of which is a method in `ray_lanes`, for aspheres in `asphere`, and for other figures in `unsymmetric`; `outline` tests shaped apertures; `carried` is
//! the data that rays carry along, such as the media at each ray's own wavelength (`dispersion`) or the `optical_path`; `instances` compiles
//! all of this for each instruction set in `simd`. `clearance` runs the same loop for searches, and measures how near
//! rays come to the edges of `apertures`.
//!
//! # Instances: which code is compiled, and where it runs
//!
//! A *vector* holds one number for each of several rays, one in each *lane*, and an instruction works on all of its
//! lanes at once. `F64x8` has eight lanes in double precision. A portable vector is an array, which the compiler
//! translates as best it can.
//!
//! The algorithm is written once, over `Lanes`, vectors of either precision. Thin functions in `instances`, one for
//! each instruction set and grouping of rays, run it. The processor ([`Simd`]) and the caller (`Grouping`: `One`,
//! `Quad` or `Wide`) determine which function runs. The environment variable `REALISTIC_SIMD` (`portable`, `avx2` or
//! `avx512`) limits the instruction set, once for the whole process.
//!
//! | processor | one ray: `One` | up to four: `Quad` | many: `Wide` |
//! |---|---|---|---|
//! | AVX-512F, AVX2 and FMA | one lane (`fma_one`) | `F32x4`, `F64x4` (`avx2_quad`) | `F32x16`, `F64x8` (`avx512`) |
//! | AVX2 and FMA | one lane (`fma_one`) | `F32x4`, `F64x4` (`avx2_quad`) | `F32x8`, `F64x4` (`avx2`) |
//! | other x86-64 | one portable lane (`portable_vectors`) | the same | the same |
//! | not x86-64 | one portable lane (`portable_vectors`) | four portable lanes | the same |
//!
//! The lane of `fma_one` is a `OneLane`, a portable vector of one number, whose fused multiply-add is the processor's
//! instruction.
//!
//! Two types prove that a processor has the instructions, and no compiled instance runs without them. An `Available`
//! is an instruction set that was detected: `in_vectors` matches on it and calls the thin function. The thin function
//! makes a `Cpu<L>` and passes it along as an argument; the functions that make a vector of `L` from numbers
//! (`splat`, `load`) require it.
//!
//! All work runs in the caller's thread. A kernel is immutable, and several threads may share it.
//!
//! Batches in the widest vectors of AVX2 and AVX-512 are traced four vectors side by side (`Group`); the last group has
//! the vectors that remain, and a single remaining vector stays in registers. A step is a loop over the vectors of the
//! group, which is not unrolled: the processor overlaps the vectors anyway, and the code is a quarter of the size. Only
//! the loops at aspheres are unrolled, for one, two and four vectors, some of which may be idle, because the sums of an
//! asphere are longer than the processor's out-of-order window. Polynomials and ideal lenses take one vector after
//! another (`Optics::SIDE_BY_SIDE`).
//!
//! Work (`InVectors`: a camera's samples, or rays in arrays, through `Optics`) is compiled for each entry of the
//! table that a caller may request. Two rules keep the code small:
//! - The steps of a lens are one function for each type of vector (`Lanes::apart`), which all work calls. They are
//!   inlined into work on vectors that are not `Lanes::SHARED`: one lane and `F32x4`, for which only the latency
//!   counts, and four portable lanes. `F64x4` is shared, because it is also AVX2's widest vector.
//! - On x86-64 the code of portable vectors is small rather than fast, because all processors of the last ten years
//!   have AVX2.
//!
//! `Simd::run` compiles work outside the table (`Compiled`), such as one look-up in the pupil's map, for each
//! instruction set, so that its fused multiply-adds are the processor's own.
//!
//! The attribute `#[cfg_attr(not(debug_assertions), inline(always))]` marks the functions below `instances` (the
//! smallest are `inline(always)` in every build). A vector operation uses a processor's instructions only inside a
//! function compiled for that processor, so that all of these functions must be inlined into the thin functions, or
//! into the separate function that `Lanes::apart` makes. With debug assertions they are called instead, with the same
//! bits: the debug information of functions of that size overflows LLVM's stack. Stable Rust has no alias for an
//! attribute.

mod apertures;
mod asphere;
mod carried;
mod clearance;
mod dispersion;
#[allow(unsafe_code)]
mod group;
#[allow(unsafe_code)]
mod instances;
mod optical_path;
mod outline;
mod ray_arrays;
mod ray_lanes;
mod rounding;
mod surface;
mod table;
mod trace;
mod unsymmetric;

pub use clearance::{ClearanceTracer, FilmRay};
pub use dispersion::Own;
pub use instances::KernelScalar;
pub use optical_path::PathKernel;
pub use ray_arrays::{LensRays, PlaneRays, RayBuffer, Traced};

pub(crate) use self::{asphere::Profile, outline::sides, ray_arrays::trace_array};
pub use self::{
    carried::Carried,
    group::Group,
    instances::{Grouping, InVectors, LensSteps, Optics, in_vectors, one_by_one},
    ray_arrays::{Approach, Arrays, from_plane},
    ray_lanes::{Crossing, End, Start},
    table::{Step, Table},
};
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    trace::{Blocked, Direction, Path},
};
use realistic_simd::{Available, Simd};

/// A lens compiled for tracing rays in one direction with numbers of type `S`: `f64` or `f32`.
///
/// A kernel is immutable and may be shared between threads.
#[derive(Clone, Debug)]
pub struct Kernel<S> {
    steps: LensSteps<S, Own>,
    path: Path<f64>,
    simd: Available,
}

impl<S: KernelScalar> Kernel<S> {
    /// Compiles a lens for the best available instructions ([`Simd::best`]).
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        Self::along(&Path::new(lens, direction, Refraction::Fused))
    }

    /// Compiles an existing path as [`Kernel::new`] does a lens. The path may have mirrors ([`Path::reflected`]).
    pub fn along(path: &Path) -> Self {
        Self::compile(path.clone(), Available::best())
    }

    /// Compiles a lens for the given instructions; `None` if the processor lacks them.
    pub fn with_simd(lens: &Lens, direction: Direction, simd: Simd) -> Option<Self> {
        let path = || Path::new(lens, direction, Refraction::Fused);
        simd.available().map(|simd| Self::compile(path(), simd))
    }

    fn compile(path: Path, simd: Available) -> Self {
        let table = Table::new(&path, S::AMPLIFICATION);
        Self { steps: LensSteps { table, carried: Own }, path, simd }
    }

    /// Returns the instructions in use.
    pub fn simd(&self) -> Simd {
        self.simd.simd()
    }

    /// Returns the proof that the processor has the instructions in use.
    pub fn available(&self) -> Available {
        self.simd
    }

    /// Returns the steps that rays are traced through.
    pub fn steps(&self) -> &LensSteps<S, Own> {
        &self.steps
    }

    /// Traces one ray from `point` (x, y in mm) on the plane z = `plane` (mm, lens space), with slopes dx/dz and
    /// dy/dz; `None` if the lens blocks it.
    #[inline]
    pub fn trace_one(&self, plane: f64, point: [S; 2], slopes: [S; 2]) -> Option<Traced<S>> {
        let [traced] =
            trace_array(plane, [point], [slopes], |from, to| self.trace(Grouping::One, Some(from), to));
        traced
    }

    /// Traces three rays as [`Kernel::trace_one`] does, in little more than the time of one: a ray and its two
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
        let [first, second, third, _] = trace_array(plane, [a, b, c, a], [s, t, u, s], trace);
        [first, second, third]
    }

    /// Traces many rays from a plane. Origin and direction of a blocked ray are 0.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn trace_batch(&self, from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>) {
        let n = from.checked_len();
        assert_eq!(n, to.checked_len(), "a batch needs as much room as it has rays");
        self.trace(Grouping::Wide, Some(from), to);
    }

    /// Traces many rays, each from anywhere before the first surface with a direction of any length but 0, and
    /// overwrites them with the results. Origin and direction of a blocked ray become 0.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn trace_in_place(&self, rays: &mut LensRays<'_, S>) {
        rays.checked_len();
        self.trace(Grouping::Wide, None, rays);
    }

    #[inline(always)]
    fn trace(&self, grouping: Grouping, from: Option<&PlaneRays<'_, S>>, to: &mut LensRays<'_, S>) {
        S::trace(self.simd, grouping, &mut Arrays { optics: &self.steps, from, to, optical_path: None });
    }

    /// Returns the reason why a ray is blocked, by the scalar walk. If the walk, in double precision, lets the ray
    /// through, the ray passes within rounding of the edge of a clear aperture, and the reason is [`Blocked::Clipped`].
    pub fn reason(&self, ray: Ray) -> Blocked {
        self.path.walk(ray).blocked.unwrap_or(Blocked::Clipped)
    }
}
