//! Searches for the pupil's edge along half-lines, as many side by side as there are, of one film point or of several:
//! where they start in, distances of the edge and what limits there out.
//!
//! Not [`crate::numeric::root`]: the excess is the largest of one smooth function an aperture, which has kinks that a
//! secant over all of them falls for, and what neighbours know (the distance, and how steep their limit is) leaves
//! few rays to trace: 117 an outline of 17 half-lines, its corners and the looks for holes included. Side by side, because rays are traced in packets.

use std::cell::Cell;

use super::view::{Excess, Limit, Tracer, View};

/// A point of the edge along a half-line of slopes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Distance from the half-line's start, in slope.
    pub radius: f64,
    pub limit: Limit,
    /// d(excess)/d(ln radius) there; a hint for the next search.
    pub steepness: f64,
}

/// Relative accuracy of a crossing: the table's margin is sixty times as much.
const ACCURACY: f64 = 1e-5;
/// How far off a neighbour's steepness is taken to be, relative.
const NEIGHBOUR: f64 = 0.1;
/// The same of one that the same limit had anywhere else.
const ANYWHERE: f64 = 1.0;
/// Distance of a secant's two points, over the radius, up to which it is relied on. Its error is its step times its
/// span times half the relative curvature, and the height in an aperture is nearly linear in the slope.
const LAST_SPAN: f64 = 3e-2;
/// Limits that a search keeps what it knows of.
const LIMITS: usize = 4;
/// Steps that take any bracket to its last bits.
const MOST_STEPS: u32 = 120;

/// What a search knows of one limit.
#[derive(Clone, Copy)]
struct Known {
    limit: Limit,
    /// The last ray that this limit decided.
    radius: f64,
    value: f64,
    /// Where it alone would have the edge.
    edge: f64,
}

/// A half-line from a slope inside the pupil of one film point.
#[derive(Clone, Copy)]
pub(crate) struct HalfLine<'a> {
    pub view: &'a View<'a>,
    /// sx of where it starts; sy is 0 there.
    pub center: f64,
    /// A unit vector.
    pub direction: [f64; 2],
    /// About where the edge lies.
    pub guess: Crossing,
}

/// A search along one half-line. The excess is the largest of one smooth function a limit, so that each limit has its
/// own secant, and the edge is the nearest that one of them predicts.
struct Search<'a> {
    half_line: HalfLine<'a>,
    /// Where the next ray goes.
    radius: f64,
    /// The bracket.
    inside: f64,
    outside: f64,
    /// What stopped the ray at its outer end.
    limit: Limit,
    /// Of each limit that was met, the last ones.
    known: [Option<Known>; LIMITS],
    step: u32,
}

/// How a search goes on.
enum Next {
    Ray,
    Edge(Crossing),
    Nowhere,
}

impl<'a> Search<'a> {
    fn new(half_line: HalfLine<'a>) -> Self {
        Self {
            half_line,
            radius: half_line.guess.radius,
            inside: 0.0,
            outside: f64::INFINITY,
            limit: Limit::Optics,
            known: [None; LIMITS],
            step: 0,
        }
    }

    /// Learns what became of the ray at `radius`. `hint` is a steepness that the ray's limit had elsewhere.
    fn learn(&mut self, excess: Excess, hint: Option<f64>) -> Next {
        let Self { half_line: HalfLine { guess, .. }, radius, .. } = *self;
        let Excess { value, limit, lost } = excess;
        if value <= 0.0 {
            self.inside = radius;
        } else {
            self.outside = radius;
            self.limit = limit;
        }
        let (inside, outside) = (self.inside, self.outside);
        let own = self.known.iter_mut().find(|known| known.is_some_and(|known| known.limit == limit));
        let last = own.and_then(Option::take).filter(|last| last.value != value);
        let (steepness, doubt) = match last {
            _ if limit == Limit::Optics => (f64::NAN, f64::INFINITY),
            Some(last) => {
                let span = (radius - last.radius).abs() / radius;
                let steepness = radius * (value - last.value) / (radius - last.radius);
                (steepness, if span <= LAST_SPAN { span } else { f64::INFINITY })
            }
            None if guess.limit == limit => (guess.steepness, NEIGHBOUR),
            None => hint.map_or((guess.steepness, f64::INFINITY), |hint| (hint, ANYWHERE)),
        };
        let step = value / steepness;
        let edge = radius - step * radius;
        let known = self.known.iter().flatten();
        let predicted = known.map(|known| known.edge).filter(|&edge| edge > inside && edge < outside);
        let others = predicted.fold(f64::INFINITY, f64::min);
        // Where rays are lost within the aperture, its own edge lies outside the bracket and is none of the pupil's.
        let is_between = edge > 0.0 && edge >= inside && edge <= others.min((1.0 + ACCURACY) * outside);
        if step.abs() * doubt <= ACCURACY && is_between && !lost {
            return Next::Edge(Crossing { radius: edge, limit, steepness });
        }
        if outside.is_finite() && outside - inside <= ACCURACY * outside {
            let steepness =
                if self.limit == limit && !steepness.is_nan() { steepness } else { guess.steepness };
            return Next::Edge(Crossing { radius: inside, limit: self.limit, steepness });
        }
        let free = self.known.iter().position(Option::is_none).unwrap_or(self.step as usize % LIMITS);
        self.known[free] = Some(Known { limit, radius, value, edge });
        let mut next = edge.min(others);
        // A ray that gets lost, too, does not show that those within the aperture get through.
        if lost {
            next *= 1.0 - 10.0 * ACCURACY;
        }
        // Where that leads nowhere, and now and then in any case, the bracket's middle.
        if !(next > inside && next < outside) || self.step % 8 == 7 {
            next = if outside.is_finite() { f64::midpoint(inside, outside) } else { 2.0 * radius };
        } else if outside == f64::INFINITY {
            next = next.min(4.0 * radius);
        }
        self.step += 1;
        if !(next > 0.0 && next.is_finite()) || self.step == MOST_STEPS {
            return Next::Nowhere;
        }
        self.radius = next;
        Next::Ray
    }
}

/// The steepness that each surface's aperture had where it last was the limit.
pub(crate) struct Hints(Vec<Cell<f64>>);

impl Hints {
    pub fn new(surfaces: usize) -> Self {
        Self(vec![Cell::new(f64::NAN); surfaces])
    }

    fn of(&self, limit: Limit) -> Option<f64> {
        let Limit::Aperture(surface) = limit else { return None };
        Some(self.0[surface].get()).filter(|steepness| !steepness.is_nan())
    }

    fn note(&self, edge: &Crossing) {
        if let Limit::Aperture(surface) = edge.limit {
            self.0[surface].set(edge.steepness);
        }
    }
}

/// What traces the rays of searches, and what they know from one another.
#[derive(Clone, Copy)]
pub(crate) struct EdgeFinder<'a> {
    pub tracer: &'a Tracer,
    pub hints: &'a Hints,
}

impl EdgeFinder<'_> {
    /// The edge along each of the half-lines; `None` where one has none, or the rays are spent.
    pub fn crossings<'b>(&self, half_lines: impl Iterator<Item = HalfLine<'b>>) -> Vec<Option<Crossing>> {
        let mut searches: Vec<Search<'b>> = half_lines.map(Search::new).collect();
        let mut edges = vec![None; searches.len()];
        let mut open: Vec<usize> = (0..searches.len()).collect();
        let mut found = Vec::with_capacity(open.len());
        while !open.is_empty() && !self.tracer.is_spent() {
            let rays = open.iter().map(|&i| {
                let Search { half_line: HalfLine { view, center, direction: [dx, dy], .. }, radius, .. } =
                    searches[i];
                view.ray([center + radius * dx, radius * dy])
            });
            self.tracer.excesses(rays, &mut found);
            let mut excesses = found.iter();
            open.retain(|&i| {
                match excesses.next().map(|&excess| searches[i].learn(excess, self.hints.of(excess.limit))) {
                    Some(Next::Ray) => true,
                    Some(Next::Edge(edge)) => {
                        self.hints.note(&edge);
                        edges[i] = Some(edge);
                        false
                    }
                    Some(Next::Nowhere) | None => false,
                }
            });
        }
        edges
    }
}
