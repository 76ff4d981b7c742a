//! The methods that are put to the test, with what each has to keep.

use realistic::unstable::{
    lens::{Lens, refraction::Refraction},
    trace::{Direction, Ray, Real},
};

use crate::{
    methods::{METHODS, Method, Number, Way, any_ray},
    reference::condition::Norm,
};

/// What error / (condition x epsilon) may be. A step of the index from 4, the highest here, to 1 forms
/// n'² - n² cos² I with 16 times the rounding of what is left; at ordinary glass the ratio is below 1.
pub const BOUND: f64 = 16.0;

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
    method: &'static Method,
}

/// Two of the lecture's methods are not backward stable at grazing incidence on a surface between nearly equal media.
/// Whitted's divides by cos I and takes the difference of squares. Heckbert's takes cos I' from 1 - η² (1 - cos² I), where
/// the rounding of 1 - cos² I is ε whatever is left: the direction is off by ε/(2 cos I'). A ray that such a surface does not
/// bend has the condition number √5, one for the entry and two for the interface, so that the ratio is 0.22/cos I'. The bound
/// stands for cos I' = 2.2e-4, which one ray in some ten million random ones comes down to. At a step of the index cos I'
/// is as ill-conditioned as that, and every method's ratio of order one.
const GRAZING_BOUND: f64 = 1e3;

/// A strongly curved surface is met without a division, which leaves the way to it an error of rounding times its
/// radius: up to 26 times the index and the clear semi-diameter, beyond which the division is done. That is what makes 19
/// in 10 000 random lenses and 23, twice over 20, in 120 000 others; the named cases stay below 7.
const KERNEL_BOUND: f64 = 24.0;

/// The tracers that this processor can run.
pub fn tracers() -> Vec<Tracer> {
    METHODS.iter().filter_map(Tracer::of).collect()
}

impl Tracer {
    /// What the method has to keep; `None` for what is no exact method, a second name of one, or not for this
    /// processor.
    fn of(method: &'static Method) -> Option<Self> {
        let (epsilon, one) = match method.number {
            Number::F32 => (<f32 as Real>::EPSILON, "one f32"),
            Number::F64 => (<f64 as Real>::EPSILON, "one f64"),
            Number::DoubleDouble => return None,
        };
        let (bound, norm, like) = match method.way {
            Way::Walk(Refraction::Whitted | Refraction::Heckbert) => (GRAZING_BOUND, Norm::Own, method.name),
            Way::Walk(_) => (BOUND, Norm::Own, method.name),
            Way::Batch(simd) if !simd.is_available() => return None,
            Way::One | Way::Batch(_) => (KERNEL_BOUND, Norm::Surface, one),
            Way::Anywhere => (KERNEL_BOUND, Norm::Surface, method.name),
            _ => return None,
        };
        Some(Self { name: method.name, epsilon, bound, norm, like, method })
    }

    /// The rays after the lens, where they get through. `None` for a kernel where rays come from anything but air, which
    /// no lens file makes and no kernel is made for.
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
