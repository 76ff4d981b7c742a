//! The edge of a pupil along half-lines, by how far rays are outside every aperture: secants within a bracket, many half-lines
//! side by side, for rays are traced in packets.

use super::view::{Excess, Limit, Pencil};

/// Accuracy of an edge over its distance: less takes more rays, more light is missed.
const ACCURACY: f64 = 1e-4;
/// How far off the steepness that was measured at a neighbouring edge is taken to be, relative: more traces most edges twice.
const NEIGHBOUR: f64 = 0.1;
/// Stride of the steps that halve the bracket: a larger one slows secants that hardly move.
const HALVING: u32 = 4;
/// Steps of a search at most: enough for the bracket of a ray that is lost, where there is no excess to go by.
const MOST_STEPS: u32 = 48;

/// Where a half-line leaves the pupil.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Distance from where the half-line begins.
    pub radius: f64,
    /// d(excess)/d(radius), and whether it was measured there or taken over from a neighbour.
    pub steepness: f64,
    pub is_measured: bool,
    /// What stops the rays beyond.
    pub limit: Limit,
}

impl Edge {
    /// One of which nothing more is known.
    pub fn at(radius: f64) -> Self {
        Self { radius, steepness: f64::NAN, is_measured: false, limit: Limit::Optics }
    }
}

/// A search along one half-line, whose beginning gets through.
pub(crate) struct Search {
    /// Where it is looked next.
    radius: f64,
    /// The bracket: a ray inside gets through, one outside does not.
    inside: f64,
    outside: f64,
    /// The edge of a neighbour.
    hint: Edge,
    /// The ray before, and its excess.
    last: Option<(f64, Excess)>,
    /// What stopped the ray at the bracket's outer end.
    limit: Limit,
    steps: u32,
    found: Option<Edge>,
}

impl Search {
    /// From an edge that is expected.
    pub fn new(hint: Edge) -> Self {
        let radius = hint.radius;
        let limit = hint.limit;
        Self { radius, inside: 0.0, outside: f64::INFINITY, hint, last: None, limit, steps: 0, found: None }
    }

    /// Between a ray that gets through and one that does not.
    pub fn between(inside: f64, outside: f64) -> Self {
        Self { inside, outside, ..Self::new(Edge::at(f64::midpoint(inside, outside))) }
    }

    /// Learns what became of the ray at `radius`; whether another is to be traced.
    fn learn(&mut self, excess: Excess) -> bool {
        let (radius, Excess { value, limit, lost }) = (self.radius, excess);
        if excess.passes() {
            self.inside = radius;
        } else {
            (self.outside, self.limit) = (radius, limit);
        }
        let accuracy = ACCURACY * self.hint.radius;
        // How steep the excess is, and how well that is known: by the part of a step that it may be off.
        let last = self.last.filter(|(_, last)| last.limit == limit);
        let steepness = match last {
            _ if limit == Limit::Optics => f64::NAN,
            Some((from, last)) => (value - last.value) / (radius - from),
            None => self.hint.steepness,
        };
        let edge = radius - value / steepness;
        let doubt = match last {
            Some((from, _)) => (edge - from).abs() / self.hint.radius,
            None if self.hint.limit == limit && self.hint.is_measured => NEIGHBOUR,
            None => f64::INFINITY,
        };
        let fits = steepness > 0.0 && edge >= self.inside && edge <= self.outside;
        // Where rays are lost within the aperture, too, its edge is not the pupil's.
        if fits && !lost && (edge - radius).abs() * doubt <= accuracy {
            self.found = Some(Edge { radius: edge, steepness, is_measured: last.is_some(), limit });
            return false;
        }
        if self.outside - self.inside <= accuracy {
            let steepness = if self.limit == self.hint.limit { self.hint.steepness } else { f64::NAN };
            self.found = Some(Edge { radius: self.inside, steepness, is_measured: false, limit: self.limit });
            return false;
        }
        self.last = Some((radius, excess));
        self.steps += 1;
        let is_bracketed = self.outside < f64::INFINITY;
        self.radius = if fits && (!is_bracketed || !self.steps.is_multiple_of(HALVING)) {
            // A little inside, where the aperture's edge may be that of lost rays.
            let edge = if lost { edge - 5.0 * accuracy } else { edge };
            edge.clamp(0.5 * radius, 1.5 * radius + accuracy).clamp(self.inside, self.outside)
        } else if is_bracketed {
            f64::midpoint(self.inside, self.outside)
        } else {
            self.inside + self.hint.radius * 0.02 * 4_f64.powi(self.steps as i32)
        };
        if self.radius == self.inside || self.radius == self.outside {
            self.radius = f64::midpoint(self.inside, self.outside.min(self.inside + 4.0 * accuracy));
        }
        self.steps < MOST_STEPS && self.radius.is_finite()
    }
}

/// The edges along half-lines of a pencil, side by side; `None` where there is none. `at` is the point of a half-line, by its
/// number, at a distance.
pub(crate) fn edges(
    pencil: &impl Pencil,
    mut searches: Vec<Search>,
    at: impl Fn(usize, f64) -> [f64; 2],
) -> Vec<Option<Edge>> {
    let mut open: Vec<usize> = (0..searches.len()).collect();
    let mut points = Vec::with_capacity(open.len());
    while !open.is_empty() && !pencil.is_spent() {
        points.clear();
        points.extend(open.iter().map(|&i| at(i, searches[i].radius)));
        let mut excesses = pencil.excesses(&points).into_iter();
        open.retain(|&i| excesses.next().is_some_and(|excess| searches[i].learn(excess)));
    }
    searches.into_iter().map(|search| search.found).collect()
}
