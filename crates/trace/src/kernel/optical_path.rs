//! The optical path as data that rays carry, and the kernel that returns it with the rays. Single precision cannot resolve
//! the phase of light (it rounds 100 mm to about 4 nm), so the kernel is in double precision only.

use super::{
    carried::Carried,
    dispersion::Own,
    instances::{Grouping, KernelScalar, LensSteps, in_vectors},
    ray_arrays::{Arrays, LensRays, PlaneRays},
    ray_lanes::Crossing,
    table::Table,
};
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::{Direction, Path},
};
use realistic_simd::{Available, Cpu, Lanes};

/// Constants of the optical path: the sum over the steps of n² t, where t is the distance in units of V = n D.
#[derive(Clone, Debug)]
pub struct OpticalPath {
    /// n² before each step, relative to the medium before the first surface.
    squares: Box<[f64]>,
    /// n of the medium before the first surface.
    first: f64,
}

impl OpticalPath {
    fn new(path: &Path, table: &Table<f64>) -> Self {
        let first = path.steps()[0].n;
        let square = |&surface: &usize| (path.steps()[surface].n / first).powi(2);
        Self { squares: table.surfaces.iter().map(square).collect(), first }
    }
}

impl Carried<f64> for OpticalPath {
    type State<L: Lanes<Scalar = f64>> = L;
    type Media<L: Lanes<Scalar = f64>> = Own;

    #[inline(always)]
    fn start<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, _: L) -> L {
        L::splat(cpu, 0.0)
    }

    #[inline(always)]
    fn go_to<L: Lanes<Scalar = f64>>(&self, _: Cpu<L>, _: usize, _: &mut L) {}

    #[inline(always)]
    fn media<L: Lanes<Scalar = f64>>(&self, _: &L) -> Own {
        Own
    }

    #[inline(always)]
    fn depart<L: Lanes<Scalar = f64>>(&self, state: &mut L, lead: L) {
        *state = lead;
    }

    #[inline(always)]
    fn cross<L: Lanes<Scalar = f64>>(
        &self,
        cpu: Cpu<L>,
        number: usize,
        state: &mut L,
        crossing: &Crossing<L>,
    ) {
        *state = crossing.distance.mul_add(L::splat(cpu, self.squares[number]), *state);
    }

    #[inline(always)]
    fn optical_path<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, state: &L) -> Option<L> {
        Some(*state * L::splat(cpu, self.first))
    }
}

/// A lens compiled for tracing rays in double precision with their optical paths.
#[derive(Clone, Debug)]
pub struct PathKernel {
    steps: LensSteps<f64, OpticalPath>,
    simd: Available,
}

impl PathKernel {
    /// Compiles a lens for the best available instructions.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        Self::along(&Path::new(lens, direction, Refraction::Fused))
    }

    /// Compiles an existing path as [`PathKernel::new`] does a lens.
    pub fn along(path: &Path) -> Self {
        let table = Table::new(path, f64::AMPLIFICATION);
        let carried = OpticalPath::new(path, &table);
        Self { steps: LensSteps { table, carried }, simd: Available::best() }
    }

    /// Traces rays from a plane as [`Kernel::trace_batch`](super::Kernel::trace_batch) does. `optical_path` receives the
    /// optical path of each ray, mm, from its point on the plane to its point on the last surface; 0 for a blocked ray.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn trace_batch(
        &self,
        from: &PlaneRays<'_, f64>,
        to: &mut LensRays<'_, f64>,
        optical_path: &mut [f64],
    ) {
        assert_eq!(from.checked_len(), to.checked_len(), "a batch needs as much room as it has rays");
        self.trace(Some(from), to, optical_path);
    }

    /// Traces rays as [`Kernel::trace_in_place`](super::Kernel::trace_in_place) does. `optical_path` receives the optical
    /// path of each ray, mm, from its origin to its point on the last surface; 0 for a blocked ray.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn trace_in_place(&self, rays: &mut LensRays<'_, f64>, optical_path: &mut [f64]) {
        self.trace(None, rays, optical_path);
    }

    fn trace(&self, from: Option<&PlaneRays<'_, f64>>, to: &mut LensRays<'_, f64>, optical_path: &mut [f64]) {
        assert_eq!(to.checked_len(), optical_path.len(), "every ray has an optical path");
        let mut arrays = Arrays { optics: &self.steps, from, to, optical_path: Some(optical_path) };
        in_vectors(self.simd, Grouping::Wide, &mut arrays);
    }
}
