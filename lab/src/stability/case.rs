//! One case: a lens, rays, the exact answer, and the bound that every tracer has to keep.

use realistic::unstable::{
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
    /// Rays that were evaluated.
    pub rays: usize,
    /// Rays that were nearer to a decision than [`MARGIN`] epsilon, and left out.
    pub undecided: usize,
    /// What is not as it should be.
    pub failures: Vec<Failure>,
}

/// Why a ray fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Its error is more than its case's bound.
    Error,
    /// It passes for the tracer and not in truth, or the other way about.
    Fate,
    /// It is not finite, or its direction has not length 1.
    Unsound,
}

impl Reason {
    /// All with their names.
    pub const NAMES: [(&'static str, Self); 3] =
        [("error", Self::Error), ("fate", Self::Fate), ("unsound ray", Self::Unsound)];
}

/// A ray that fails.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The case by whose name [`rerun`](super::rerun) finds it.
    pub case: String,
    /// The ray's number in it.
    pub ray: usize,
    /// Why.
    pub reason: Reason,
    /// What was found.
    pub what: String,
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
        for (number, ((ray, trail), got)) in self.rays.iter().zip(trails).zip(outcomes).enumerate() {
            let mut found = Vec::new();
            if got.is_some_and(|ray| !is_sound(&ray)) {
                found.push((Reason::Unsound, "not finite, or without unit direction".to_owned()));
            }
            let condition = trail.condition(tracer.norm);
            let away = condition.margin / tracer.epsilon;
            if !(away > MARGIN) {
                result.undecided += 1;
            } else {
                result.rays += 1;
                match (got, trail.exact) {
                    (Some(got), Ok(exact)) => {
                        let start = ray.origin.iter().fold(size, |most: f64, x| most.max(x.abs()));
                        let ratio = result.add(&got, &exact, condition, tracer.epsilon, (exit, start));
                        // What is not a number fails, too.
                        if !(ratio <= tracer.bound) {
                            found.push((Reason::Error, format!("{ratio:.1} against {}", tracer.bound)));
                        }
                    }
                    (None, Ok(_)) => {
                        found.push((Reason::Fate, format!("blocked; passes by {away:.0} epsilon")))
                    }
                    (Some(_), Err(why)) => {
                        found.push((Reason::Fate, format!("passes; is {why} by {away:.0} epsilon")));
                    }
                    (None, Err(_)) => {}
                }
            }
            result.failures.extend(found.into_iter().map(|(reason, what)| Failure {
                case: self.name.clone(),
                ray: number,
                reason,
                what: format!("{what}; from {:?} along {:?} to {got:?}", ray.origin, ray.direction),
            }));
        }
        Some(result)
    }
}

impl CaseResult {
    /// A result of no rays yet, which holds.
    pub fn new(name: String, group: &'static str, tracer: &'static str, bound: f64) -> Self {
        Self {
            name,
            group,
            tracer,
            bound,
            worst_error_rad: 0.0,
            worst_error_mm: 0.0,
            condition: 0.0,
            ratio: 0.0,
            rays: 0,
            undecided: 0,
            failures: Vec::new(),
        }
    }

    /// Whether everything is as it should be.
    pub fn holds(&self) -> bool {
        self.failures.is_empty()
    }

    /// Why it fails, with how many rays: nothing where it holds.
    pub fn fails_because(&self) -> String {
        let count = |reason| self.failures.iter().filter(|failure| failure.reason == reason).count();
        let reasons = Reason::NAMES.map(|(name, reason)| (name, count(reason)));
        let found = reasons.iter().filter(|(_, count)| *count > 0);
        found.map(|(name, count)| format!("{name} ({count})")).collect::<Vec<_>>().join(", ")
    }

    /// Takes in the result of another part of the same case, or of another case of a group.
    pub(crate) fn merge(&mut self, part: &Self) {
        self.bound = self.bound.max(part.bound);
        self.worst_error_rad = self.worst_error_rad.max(part.worst_error_rad);
        self.worst_error_mm = self.worst_error_mm.max(part.worst_error_mm);
        self.condition = self.condition.max(part.condition);
        self.ratio = self.ratio.max(part.ratio);
        self.rays += part.rays;
        self.undecided += part.undecided;
        self.failures.extend(part.failures.iter().cloned());
    }

    /// Takes in a ray; its error over what its condition number expects.
    fn add(
        &mut self,
        got: &Ray,
        exact: &ExactRay,
        condition: &Condition,
        epsilon: f64,
        (exit, size): (f64, f64),
    ) -> f64 {
        let (rad, mm) = (exact.direction_error(got), exact.position_error(got, exit));
        self.worst_error_rad = self.worst_error_rad.max(rad);
        self.worst_error_mm = self.worst_error_mm.max(mm);
        self.condition = self.condition.max(condition.direction);
        // The point comes out in lens space, where its z is rounded to a double at the last vertex; and a
        // point on the vertex, which is exact, is one to the reference's own digits only.
        let expected_mm =
            epsilon * condition.position + f64::EPSILON * exit.abs() + DoubleDouble::EPSILON * size;
        let ratio = (rad / (epsilon * condition.direction)).max(mm / expected_mm);
        self.ratio = self.ratio.max(ratio);
        ratio
    }
}

/// Whether a ray that leaves is finite with a direction of length 1.
pub fn is_sound(ray: &Ray) -> bool {
    let [x, y, z] = ray.direction;
    ray.origin.iter().all(|x| x.is_finite()) && ((x * x + y * y + z * z) - 1.0).abs() < 8.0 * f64::EPSILON
}
