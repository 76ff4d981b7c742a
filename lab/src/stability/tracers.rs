//! The methods that are put to the test, with what each has to keep.

use realistic::{
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

/// A strongly curved surface is met without a division, which leaves the way to it an error of rounding times its
/// radius: up to 45 times the clear semi-diameter and the way there, beyond which the division is done. That is
/// what makes 15 at radii of 1000 mm and, where two such surfaces follow each other, 31 in 10 000 random lenses (103
/// in as many of an earlier generator); everything else stays below 10.
const KERNEL_BOUND: f64 = 128.0;

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
            // Divides by n cos I and takes the difference of squares: not stable at grazing incidence.
            Way::Walk(Refraction::Whitted) => (1e3, Norm::Own, method.name),
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
