//! The tracers that are put to the test, by name: a lens and a direction in, a function from rays to rays out.

use crate::subject::kernel_rays::KernelRays;
use realistic::{
    lens::{Lens, refraction::Refraction},
    trace::{
        Direction, Path, Ray, Real,
        kernel::{KernelScalar, Simd},
    },
};

use super::lenses::catalogue;
use crate::reference::condition::Norm;

/// What error / (condition x epsilon) may be. A step of the index from 4, the highest here, to 1 forms
/// n'² - n² cos² I with 16 times the rounding of what is left; at ordinary glass the ratio is below 1.
pub const BOUND: f64 = 16.0;

/// A lens in the hands of one tracer: rays in lens space in, the rays after the lens out, where they get
/// through.
pub type Traced = Box<dyn Fn(&[Ray]) -> Vec<Option<Ray>> + Send + Sync>;

/// A way of tracing rays.
#[derive(Clone, Copy, Debug)]
pub struct Tracer {
    /// The name that tables show.
    pub name: &'static str,
    /// The distance from 1 to the next larger number in what it computes with.
    pub epsilon: f64,
    /// What error / (condition x epsilon) may be.
    pub bound: f64,
    /// What it rounds points by.
    pub norm: Norm,
    /// Which of several that give the same bits this is the first of: its own name, or that one's.
    pub like: &'static str,
    /// Makes a lens ready; `None` where the processor lacks the instructions, or the tracer is not made for
    /// such a lens.
    pub prepare: fn(&Lens, Direction) -> Option<Traced>,
}

/// Every tracer, the most exact first.
const TRACERS: [Tracer; 15] = [
    walk::<f64>("walk f64", BOUND, |lens, to| walked::<f64>(lens, to, Refraction::Fused)),
    walk::<f32>("walk f32", BOUND, |lens, to| walked::<f32>(lens, to, Refraction::Fused)),
    walk::<f64>("heckbert", BOUND, |lens, to| walked::<f64>(lens, to, Refraction::Heckbert)),
    // Divides by n cos I and takes the difference of squares: not stable at grazing incidence.
    walk::<f64>("whitted", 1e3, |lens, to| walked::<f64>(lens, to, Refraction::Whitted)),
    walk::<f64>("other", BOUND, |lens, to| walked::<f64>(lens, to, Refraction::Other)),
    kernel::<f64>("kernel f64, one ray", ONE_F64, one::<f64>),
    kernel::<f64>("kernel f64, portable", ONE_F64, |lens, to| batch::<f64>(lens, to, Simd::Portable)),
    kernel::<f64>("kernel f64x4, avx2", ONE_F64, |lens, to| batch::<f64>(lens, to, Simd::Avx2)),
    kernel::<f64>("kernel f64x8, avx512", ONE_F64, |lens, to| batch::<f64>(lens, to, Simd::Avx512)),
    kernel::<f64>("kernel f64, anywhere", ANYWHERE_F64, anywhere::<f64>),
    kernel::<f32>("kernel f32, one ray", ONE_F32, one::<f32>),
    kernel::<f32>("kernel f32, portable", ONE_F32, |lens, to| batch::<f32>(lens, to, Simd::Portable)),
    kernel::<f32>("kernel f32x8, avx2", ONE_F32, |lens, to| batch::<f32>(lens, to, Simd::Avx2)),
    kernel::<f32>("kernel f32x16, avx512", ONE_F32, |lens, to| batch::<f32>(lens, to, Simd::Avx512)),
    kernel::<f32>("kernel f32, anywhere", ANYWHERE_F32, anywhere::<f32>),
];

/// The first of those that give the same bits.
const ONE_F64: &str = "kernel f64, one ray";
const ONE_F32: &str = "kernel f32, one ray";
const ANYWHERE_F64: &str = "kernel f64, anywhere";
const ANYWHERE_F32: &str = "kernel f32, anywhere";

/// A strongly curved surface is met without a division, which leaves the way to it an error of rounding times its
/// radius: up to 26 times the index and the clear semi-diameter, beyond which the division is done. That is what makes 18
/// in 10 000 random lenses and 23, once over 20 in 60 000, in 120 000 others; the named cases stay below 10.
const KERNEL_BOUND: f64 = 24.0;

/// The tracers that this processor can run.
pub fn tracers() -> Vec<Tracer> {
    let lens = catalogue("dgauss.50mm", 1.0);
    TRACERS.into_iter().filter(|tracer| (tracer.prepare)(&lens, Direction::FilmToScene).is_some()).collect()
}

const fn walk<R: Real>(
    name: &'static str,
    bound: f64,
    prepare: fn(&Lens, Direction) -> Option<Traced>,
) -> Tracer {
    Tracer { name, epsilon: R::EPSILON, bound, norm: Norm::Own, like: name, prepare }
}

const fn kernel<R: Real>(
    name: &'static str,
    like: &'static str,
    prepare: fn(&Lens, Direction) -> Option<Traced>,
) -> Tracer {
    Tracer { name, epsilon: R::EPSILON, bound: KERNEL_BOUND, norm: Norm::Surface, like, prepare }
}

fn walked<R: Lane>(lens: &Lens, direction: Direction, refraction: Refraction) -> Option<Traced> {
    let path = Path::<R>::new(lens, direction, refraction);
    Some(Box::new(move |rays| rays.iter().map(|&ray| path.trace(ray).ok()).collect()))
}

/// What kernels compute with.
trait Lane: KernelScalar + Real + Send + Sync + 'static {}
impl<S: KernelScalar + Real + Send + Sync + 'static> Lane for S {}

/// A kernel for a lens with air on the side that rays come from: the only kind that a lens file makes.
fn compiled<S: Lane>(lens: &Lens, direction: Direction, simd: Simd) -> Option<KernelRays<S>> {
    let before = match direction {
        Direction::FilmToScene => lens.rear().n_film,
        Direction::SceneToFilm => lens.front().n_scene,
    };
    if before == 1.0 { KernelRays::new(lens, direction, simd) } else { None }
}

/// Ray after ray.
fn one<S: Lane>(lens: &Lens, direction: Direction) -> Option<Traced> {
    let kernel = compiled::<S>(lens, direction, Simd::best())?;
    Some(Box::new(move |rays| rays.iter().map(|&ray| kernel.one(ray)).collect()))
}

/// All rays of a plane in one batch.
fn batch<S: Lane>(lens: &Lens, direction: Direction, simd: Simd) -> Option<Traced> {
    let kernel = compiled::<S>(lens, direction, simd)?;
    Some(Box::new(move |rays| kernel.batch(rays)))
}

/// All rays in one batch, each with its own origin.
fn anywhere<S: Lane>(lens: &Lens, direction: Direction) -> Option<Traced> {
    let kernel = compiled::<S>(lens, direction, Simd::best())?;
    Some(Box::new(move |rays| kernel.in_place(rays)))
}
