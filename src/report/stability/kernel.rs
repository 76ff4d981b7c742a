//! The tracers that are put to the test, by name.

use super::case::BOUND;
use crate::{
    optics::{Lens, refraction::Refraction},
    trace::{Blocked, Direction, Path, Ray, Real},
};

/// A lens in the hands of one tracer: a ray in lens space in, the ray after the lens out.
pub type Traced = Box<dyn Fn(Ray) -> Result<Ray, Blocked> + Send + Sync>;

/// A way of tracing rays.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    /// The name that tables show.
    pub name: &'static str,
    /// The distance from 1 to the next larger number in what it computes with.
    pub epsilon: f64,
    /// What error / (condition x epsilon) may be.
    pub bound: f64,
    /// Makes a lens ready.
    pub prepare: fn(&Lens, Direction) -> Traced,
}

/// Every tracer, the most exact first.
pub const KERNELS: [Kernel; 5] = [
    walk::<f64>("f64", BOUND, |lens, direction| with::<f64>(lens, direction, Refraction::Fused)),
    walk::<f32>("f32", BOUND, |lens, direction| with::<f32>(lens, direction, Refraction::Fused)),
    walk::<f64>("f64 heckbert", BOUND, |lens, direction| with::<f64>(lens, direction, Refraction::Heckbert)),
    // Divides by n cos I and takes the difference of squares: not stable at grazing incidence.
    walk::<f64>("f64 whitted", 1e3, |lens, direction| with::<f64>(lens, direction, Refraction::Whitted)),
    walk::<f64>("f64 other", BOUND, |lens, direction| with::<f64>(lens, direction, Refraction::Other)),
];

const fn walk<R: Real>(name: &'static str, bound: f64, prepare: fn(&Lens, Direction) -> Traced) -> Kernel {
    Kernel { name, epsilon: R::EPSILON, bound, prepare }
}

fn with<R: Real + Send + Sync + 'static>(
    lens: &Lens,
    direction: Direction,
    refraction: Refraction,
) -> Traced {
    let path = Path::<R>::new(lens, direction, refraction);
    Box::new(move |ray| path.trace(ray))
}
