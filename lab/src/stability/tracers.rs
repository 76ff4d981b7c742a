//! The tracers under test, each with its bound.

use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::{Direction, Ray, Real},
};

use crate::{
    methods::{Algorithm, METHODS, Method, Number, any_ray},
    reference::condition::Norm,
};

/// Default bound on error / (condition x epsilon). At an index step from 4, the highest index here, to 1, n'² - n² cos²
/// I has 16 times the rounding error of the result; at ordinary glass the ratio is below 1.
pub const BOUND: f64 = 16.0;

/// A tracing method under test.
#[derive(Clone, Copy, Debug)]
pub struct TracerUnderTest {
    /// Name in tables.
    pub name: &'static str,
    /// Machine epsilon of the method's number type.
    pub epsilon: f64,
    /// Bound on error / (condition x epsilon).
    pub bound: f64,
    /// Norm of the method's rounding of points.
    pub norm: Norm,
    /// Name of the first tracer that returns the same bits as this one, which may be this one itself.
    pub like: &'static str,
    method: &'static Method,
}

/// Bound of two of the lecture's methods, which are not backward stable at grazing incidence on a surface between
/// nearly equal media. Whitted's method divides by cos I and takes the difference of squares. Heckbert's method
/// computes cos I' from 1 - η² (1 - cos² I), where the rounding error of 1 - cos² I is ε however small the result: the
/// direction error is ε/(2 cos I'). A ray that such a surface does not bend has the condition number √5, from one
/// disturbance for the entry and two for the interface, so that the ratio is 0.22/cos I'. The bound corresponds to cos
/// I' = 2.2e-4, which about one in ten million random rays reaches. At an index step cos I' is equally ill-conditioned,
/// and every method's ratio is of order one.
const GRAZING_BOUND: f64 = 1e3;

/// Bound of the compiled kernels. They intersect a strongly curved surface without a division, so the distance has an
/// error of rounding size times the surface's radius. This holds up to a radius of 26 times the index and the clear
/// semi-diameter; beyond, they divide. The ratio reaches 19 in 10 000 random lenses, and 23 in 120 000 others, where it
/// exceeds 20 twice; in the named cases it stays below 7.
const KERNEL_BOUND: f64 = 24.0;

/// Returns the tracers that this processor can run.
pub fn tracers() -> Vec<TracerUnderTest> {
    METHODS.iter().filter_map(TracerUnderTest::of).collect()
}

impl TracerUnderTest {
    /// Returns the tracer of a method; `None` for a method that is not exact, duplicates another, or is not supported
    /// by this processor.
    fn of(method: &'static Method) -> Option<Self> {
        let (epsilon, one) = match method.number {
            Number::F32 => (<f32 as Real>::EPSILON, "one f32"),
            Number::F64 => (<f64 as Real>::EPSILON, "one f64"),
            Number::DoubleDouble => return None,
        };
        let (bound, norm, like) = match method.algorithm {
            Algorithm::Walk(Refraction::Whitted | Refraction::Heckbert) => {
                (GRAZING_BOUND, Norm::Own, method.name)
            }
            Algorithm::Walk(_) => (BOUND, Norm::Own, method.name),
            Algorithm::Batch(simd) if !simd.is_available() => return None,
            Algorithm::One | Algorithm::Batch(_) => (KERNEL_BOUND, Norm::Surface, one),
            Algorithm::Anywhere => (KERNEL_BOUND, Norm::Surface, method.name),
            _ => return None,
        };
        Some(Self { name: method.name, epsilon, bound, norm, like, method })
    }

    /// Returns, for rays that pass, the ray after the lens. `None` for a kernel if the rays come from a medium other
    /// than air, which no lens file describes and no kernel supports.
    pub fn trace(&self, lens: &Lens, direction: Direction, rays: &[Ray]) -> Option<Vec<Option<Ray>>> {
        let before = match direction {
            Direction::FilmToScene => lens.rear().n_film,
            Direction::SceneToFilm => lens.front().n_scene,
        };
        let fits = self.norm == Norm::Own || before == 1.0;
        let tracer = any_ray::tracer(self.method, lens, direction).ok().flatten().filter(|_| fits)?;
        Some(tracer.all(rays))
    }
}
