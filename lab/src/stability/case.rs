//! One case: a lens, rays, the exact answer, and the bound that every tracer has to keep.

use realistic::{
    lens::Lens,
    trace::{Direction, Ray, Real},
};

use super::tracers::Tracer;
use crate::reference::{
    DoubleDouble, ExactRay,
    condition::{Condition, Conditioned, Trail},
};

/// A lens and rays through it.
#[derive(Clone, Debug)]
pub struct Case {
    /// What is extreme about it.
    pub name: String,
    /// What kind of extreme it is.
    pub group: &'static str,
    /// The lens.
    pub lens: Lens,
    /// Where the rays go.
    pub direction: Direction,
    /// The rays, in lens space.
    pub rays: Vec<Ray>,
    /// The rays after the lens where a closed form gives them; else the reference does.
    pub closed_form: Option<Vec<ExactRay>>,
}

/// What became of a case with one tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseResult {
    /// The case.
    pub name: String,
    /// Its group.
    pub group: &'static str,
    /// The tracer's name.
    pub tracer: &'static str,
    /// What `ratio` may be at most.
    pub bound: f64,
    /// Largest error in direction, rad.
    pub worst_error_rad: f64,
    /// Largest error in position, mm.
    pub worst_error_mm: f64,
    /// The largest condition number in direction of the rays: see [`condition`](crate::reference::condition).
    pub condition: f64,
    /// The largest of error / (condition x epsilon) over the rays, in direction or position. Of order
    /// one: the tracer is backward stable.
    pub ratio: f64,
    /// Rays that pass for the tracer and not in truth, or the other way about, though no decision was
    /// within [`MARGIN`] epsilon.
    pub disagreements: usize,
    /// Rays that were evaluated.
    pub rays: usize,
    /// Rays that were nearer to a decision than that, and left out.
    pub undecided: usize,
    /// Whether ratio and disagreements are as they should be, and everything is finite.
    pub holds: bool,
}

/// A ray is evaluated where its decisions are at least this many epsilon away, in units of the disturbance
/// that rounding so far amounts to. Single precision was seen to decide wrongly up to 74 away, three times in a million
/// rays: where two weak surfaces meet at the vertex and cross near the edge of the aperture.
pub const MARGIN: f64 = 80.0;

impl Case {
    /// A case whose answer the reference gives.
    pub fn new(
        group: &'static str,
        name: impl Into<String>,
        lens: &Lens,
        direction: Direction,
        rays: Vec<Ray>,
    ) -> Self {
        Self { name: name.into(), group, lens: lens.clone(), direction, rays, closed_form: None }
    }

    /// The exact answers with their condition numbers.
    pub fn trails(&self) -> Vec<Trail> {
        let conditioned = Conditioned::new(&self.lens, self.direction);
        let mut trails: Vec<Trail> = self.rays.iter().map(|&ray| conditioned.follow(ray)).collect();
        for (trail, known) in trails.iter_mut().zip(self.closed_form.iter().flatten()) {
            trail.exact = Ok(*known);
        }
        trails
    }

    /// Puts a tracer to the test; `trails` are this case's own.
    /// `None` where it cannot trace this lens.
    pub fn run(&self, tracer: &Tracer, trails: &[Trail]) -> Option<CaseResult> {
        let outcomes = tracer.trace(&self.lens, self.direction, &self.rays)?;
        let exit = match self.direction {
            Direction::FilmToScene => self.lens.front().vertex,
            Direction::SceneToFilm => self.lens.rear().vertex,
        };
        let size: f64 =
            self.lens.surfaces.iter().map(|surface| surface.semi_diameter + surface.thickness).sum();
        let mut result = CaseResult::new(self.name.clone(), self.group, tracer.name, tracer.bound);
        for ((ray, trail), got) in self.rays.iter().zip(trails).zip(outcomes) {
            result.holds &= got.is_none_or(|ray| is_sound(&ray));
            let condition = trail.condition(tracer.norm);
            if !(condition.margin > MARGIN * tracer.epsilon) {
                result.undecided += 1;
                continue;
            }
            result.rays += 1;
            match (got, trail.exact) {
                (Some(got), Ok(exact)) => {
                    let start = ray.origin.iter().fold(size, |most: f64, x| most.max(x.abs()));
                    result.add(&got, &exact, condition, tracer.epsilon, (exit, start));
                }
                (None, Err(_)) => {}
                _ => result.disagreements += 1,
            }
        }
        result.evaluate();
        Some(result)
    }
}

impl CaseResult {
    /// A result of no rays yet.
    pub(super) fn new(name: String, group: &'static str, tracer: &'static str, bound: f64) -> Self {
        Self {
            name,
            group,
            tracer,
            bound,
            worst_error_rad: 0.0,
            worst_error_mm: 0.0,
            condition: 0.0,
            ratio: 0.0,
            disagreements: 0,
            rays: 0,
            undecided: 0,
            holds: true,
        }
    }

    /// Takes in the result of another part of the same case, or of another case of a group.
    pub(crate) fn merge(&mut self, part: &Self) {
        self.bound = self.bound.max(part.bound);
        self.worst_error_rad = self.worst_error_rad.max(part.worst_error_rad);
        self.worst_error_mm = self.worst_error_mm.max(part.worst_error_mm);
        self.condition = self.condition.max(part.condition);
        self.ratio = self.ratio.max(part.ratio);
        self.disagreements += part.disagreements;
        self.rays += part.rays;
        self.undecided += part.undecided;
        self.holds &= part.holds;
        self.evaluate();
    }

    fn evaluate(&mut self) {
        self.holds &= self.ratio <= self.bound && self.disagreements == 0;
    }

    fn add(
        &mut self,
        got: &Ray,
        exact: &ExactRay,
        condition: &Condition,
        epsilon: f64,
        (exit, size): (f64, f64),
    ) {
        let (rad, mm) = (exact.direction_error(got), exact.position_error(got, exit));
        self.worst_error_rad = self.worst_error_rad.max(rad);
        self.worst_error_mm = self.worst_error_mm.max(mm);
        self.condition = self.condition.max(condition.direction);
        // The point comes out in lens space, where its z is rounded to a double at the last vertex; and a
        // point on the vertex, which is exact, is one to the reference's own digits only.
        let expected_mm =
            epsilon * condition.position + f64::EPSILON * exit.abs() + DoubleDouble::EPSILON * size;
        self.ratio = self.ratio.max(rad / (epsilon * condition.direction)).max(mm / expected_mm);
    }
}

/// Whether a ray that leaves is finite with a direction of length 1.
pub fn is_sound(ray: &Ray) -> bool {
    let [x, y, z] = ray.direction;
    ray.origin.iter().all(|x| x.is_finite()) && ((x * x + y * y + z * z) - 1.0).abs() < 8.0 * f64::EPSILON
}
