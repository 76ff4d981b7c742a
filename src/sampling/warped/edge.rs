//! Where half-lines leave a pupil. Many are searched side by side, for rays are traced in packets.
//!
//! Of a ray its excess is known, the largest of all apertures', and which aperture that is. So from either end of a bracket one
//! aperture is seen to cut the half-line, and of the others nothing is known but that they are farther from doing so:
//!
//! ```text
//! trace a ray where the edge is expected
//! until it is known:
//!     from the last ray that gets through, and from the first that does not: guess where the aperture that limits it cuts the
//!     half-line, with the ray of least excess that the same aperture limits, or with the steepness that is expected
//!     the nearer guess counts; if none lies in the bracket, and now and then, halve that; without a bracket look farther out
//! ```

use super::pencil::{Excess, Limit, Pencil};

/// How much farther off the steepness of a neighbouring edge is taken to be than it was there, relative: more traces most edges
/// twice.
const NEIGHBOUR: f64 = 0.1;
/// Stride of the steps that halve the bracket: a larger one slows secants that hardly move.
const HALVING: u32 = 4;
/// Rays that take hardly more time than one: two of the widest vectors, side by side.
const LANES: usize = 16;
/// How far from where it is expected an edge is looked for at once where there are lanes to spare, relative: more finds it less
/// closely, less misses it more often.
const EXPECTED: f64 = 0.05;
/// How far beyond what gets through an edge is looked for where nothing leads to it, relative: more overshoots, less takes more
/// steps.
const FARTHER: f64 = 0.02;
/// How much farther each time: more overshoots, less takes more steps.
const EACH_TIME: f64 = 4.0;
/// How near to an aperture's edge a ray has to get through for that to be the pupil's where others are lost, in units of the
/// accuracy: more takes for the pupil's what is lost, less takes more rays.
const NEAR: f64 = 5.0;
/// Steps of a search at most: enough for the bracket of a ray that is lost, where there is no excess to go by.
const MOST_STEPS: u32 = 48;

/// Where a half-line leaves the pupil.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Distance from where the half-line begins.
    pub radius: f64,
    /// d(excess)/d(radius), and how far off that may be, relative.
    pub steepness: f64,
    pub doubt: f64,
    /// What stops the rays beyond.
    pub limit: Limit,
}

impl Edge {
    /// One of which nothing more is known.
    pub fn at(radius: f64) -> Self {
        Self { radius, steepness: f64::NAN, doubt: f64::INFINITY, limit: Limit::Optics }
    }
}

/// A search along one half-line, whose beginning gets through.
pub(crate) struct Search {
    /// Where it is looked next: about the middle of `around`, or everywhere in it where there are lanes to spare.
    middle: f64,
    around: [f64; 2],
    /// The bracket: a ray inside gets through, one outside does not.
    inside: f64,
    outside: f64,
    /// The last two rays on either side of the edge, the newest first.
    rays: [[Option<(f64, Excess)>; 2]; 2],
    /// The edge that is expected.
    hint: Edge,
    /// Of the edge that is looked for, in units of its distance.
    accuracy: f64,
    steps: u32,
    found: Option<Edge>,
}

/// Where an aperture cuts a half-line.
struct Guess {
    edge: Edge,
    /// How far off that may be.
    off: f64,
}

impl Search {
    /// From an edge that is expected.
    pub fn new(hint: Edge, accuracy: f64) -> Self {
        Self {
            middle: hint.radius,
            around: [1.0 - EXPECTED, 1.0 + EXPECTED].map(|part| part * hint.radius),
            inside: 0.0,
            outside: f64::INFINITY,
            rays: [[None; 2]; 2],
            hint,
            accuracy: accuracy * hint.radius,
            steps: 0,
            found: None,
        }
    }

    /// Between a ray that gets through and one that does not.
    pub fn between(inside: f64, outside: f64, accuracy: f64) -> Self {
        let hint = Edge::at(f64::midpoint(inside, outside));
        Self { inside, outside, around: [inside, outside], ..Self::new(hint, accuracy) }
    }

    /// Where the next rays are to be traced, outward.
    fn looks(&self, count: usize) -> impl Iterator<Item = f64> + use<> {
        let (middle, [from, to]) = (self.middle, self.around);
        let at = move |k: usize| from + (to - from) * (k + 1) as f64 / (count + 1) as f64;
        (0..count).map(move |k| if count == 1 { middle } else { at(k) })
    }

    /// Learns what became of rays, outward; whether others are to be traced.
    fn learn(&mut self, rays: impl Iterator<Item = (f64, Excess)>) -> bool {
        for (radius, excess) in rays {
            let side = &mut self.rays[usize::from(!excess.passes())];
            *side = [Some((radius, excess)), side[0]];
            if !excess.passes() {
                self.outside = radius;
                break;
            }
            self.inside = radius;
        }
        let guesses = [0, 1].into_iter().filter_map(|side| self.guess(side));
        let guess = guesses.min_by(|a, b| a.edge.radius.total_cmp(&b.edge.radius));
        self.found = match &guess {
            Some(Guess { edge, off }) if *off <= self.accuracy_of(edge) && self.is_near_enough(edge) => {
                Some(*edge)
            }
            _ if self.outside - self.inside <= self.accuracy => Some(self.closed_in()),
            _ => None,
        };
        if self.found.is_some() {
            return false;
        }
        self.steps += 1;
        self.look_next(guess);
        self.steps < MOST_STEPS && self.middle.is_finite()
    }

    /// Where the aperture that limits the newest ray on one side cuts the half-line; `None` where that cannot be within the bracket,
    /// or is not to be said.
    fn guess(&self, side: usize) -> Option<Guess> {
        let (from, Excess { value, limit, .. }) = self.rays[side][0]?;
        let others = [self.rays[side][1], self.rays[1 - side][0], self.rays[1 - side][1]];
        let alike = others.iter().flatten().filter(|(at, other)| *at != from && other.limit == limit);
        let nearest = alike.min_by(|(_, a), (_, b)| a.value.abs().total_cmp(&b.value.abs()));
        let guess = |steepness: f64, other: Option<f64>| {
            let radius = from - value / steepness;
            let way = (radius - from).abs();
            let [near, doubt] = match other.map(|other| (radius - other).abs()) {
                // The steepness is off by its farther ray's part of the way, and so is the edge's distance from the nearer one.
                Some(other) => [way.min(other), way.max(other) / self.hint.radius.min(radius)],
                None if limit == self.hint.limit => [way, self.hint.doubt + NEIGHBOUR],
                None => [way, f64::INFINITY],
            };
            Guess { edge: Edge { radius, steepness, doubt, limit }, off: doubt * near }
        };
        let guess = match nearest {
            _ if limit == Limit::Optics => return None,
            Some(&(other, excess)) => guess((value - excess.value) / (from - other), Some(other)),
            // The expected aperture is hidden by this one, of which nothing is known.
            None if value <= 0.0 && limit != self.hint.limit => return None,
            None => guess(self.hint.steepness, None),
        };
        let Edge { radius, steepness, .. } = guess.edge;
        (steepness > 0.0 && radius >= self.inside && radius <= self.outside).then_some(guess)
    }

    /// Of an edge that is much nearer than expected by its own distance.
    fn accuracy_of(&self, edge: &Edge) -> f64 {
        self.accuracy * (edge.radius / self.hint.radius).min(1.0)
    }

    /// Whether rays outside an aperture are lost, too, so that its edge may not be the pupil's.
    fn is_lost(&self, limit: Limit) -> bool {
        self.rays.iter().flatten().flatten().any(|(_, ray)| ray.lost && ray.limit == limit)
    }

    /// Whether an aperture's edge is the pupil's.
    fn is_near_enough(&self, edge: &Edge) -> bool {
        edge.radius - self.inside <= NEAR * self.accuracy || !self.is_lost(edge.limit)
    }

    /// The edge of a bracket that is as narrow as it has to be.
    fn closed_in(&self) -> Edge {
        let limit = self.rays[1][0].map_or(self.hint.limit, |(_, excess)| excess.limit);
        let steepness = if limit == self.hint.limit { self.hint.steepness } else { f64::NAN };
        Edge { radius: self.inside, steepness, doubt: f64::INFINITY, limit }
    }

    /// Chooses where the next rays are to be traced.
    fn look_next(&mut self, guess: Option<Guess>) {
        let is_bracketed = self.outside < f64::INFINITY;
        // The expected aperture cuts no nearer than where its excess would be that of the ray, which is the largest.
        let least = match self.rays[0][0] {
            Some((_, Excess { value, .. })) if self.hint.steepness > 0.0 => -value / self.hint.steepness,
            _ => 0.0,
        };
        let farther =
            self.inside + (least + FARTHER * self.hint.radius) * EACH_TIME.powi(self.steps as i32 - 1);
        let within = |at: f64| at.clamp(self.inside, self.outside);
        (self.middle, self.around) = match guess {
            Some(Guess { edge, off }) if !is_bracketed || !self.steps.is_multiple_of(HALVING) => {
                let inward = if self.is_lost(edge.limit) { 0.9 * NEAR * self.accuracy } else { 0.0 };
                let edge = edge.radius - inward;
                let edge = within(if is_bracketed { edge } else { edge.min(farther) });
                let off = off.min(if is_bracketed { self.outside } else { edge } - self.inside);
                (edge, [within(edge - off), within(edge + off)])
            }
            _ if is_bracketed => (f64::midpoint(self.inside, self.outside), [self.inside, self.outside]),
            _ => (farther, [self.inside, 2.0 * farther - self.inside]),
        };
        if self.middle == self.inside || self.middle == self.outside {
            self.middle = f64::midpoint(self.inside, self.outside.min(self.inside + 4.0 * self.accuracy));
        }
    }
}

/// The edges along half-lines of a pencil, side by side; `None` where there is none, or where the first does not begin within the
/// pupil. `at` is the point of a half-line, by its number, at a distance.
pub(crate) fn edges(
    pencil: &impl Pencil,
    mut searches: Vec<Search>,
    at: impl Fn(usize, f64) -> [f64; 2],
) -> Vec<Option<Edge>> {
    let mut open: Vec<usize> = (0..searches.len()).collect();
    let (mut radii, mut points) = (Vec::new(), Vec::new());
    // Traced along with the first rays.
    let mut beginning = (!open.is_empty()).then(|| at(0, 0.0));
    while !open.is_empty() && !pencil.is_spent() {
        // Where few searches are left, each takes the lanes of others.
        let count = ((LANES - beginning.iter().count()) / open.len()).max(1);
        radii.clear();
        radii.extend(open.iter().flat_map(|&i| searches[i].looks(count)));
        points.clear();
        points.extend(radii.iter().enumerate().map(|(k, &radius)| at(open[k / count], radius)));
        points.extend(beginning);
        let mut excesses = pencil.excesses(&points);
        if beginning.take().is_some() && !excesses.pop().is_some_and(|excess| excess.passes()) {
            return searches.iter().map(|_| None).collect();
        }
        let mut rays = radii.chunks(count).zip(excesses.chunks(count));
        open.retain(|&i| {
            let (radii, excesses) = rays.next().expect("each search has its rays");
            searches[i].learn(radii.iter().copied().zip(excesses.iter().copied()))
        });
    }
    searches.into_iter().map(|search| search.found).collect()
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Apertures in front of each other: d(excess)/dx and where it is 0 of each, and from where on rays are lost.
    struct Row<const N: usize> {
        apertures: [[f64; 2]; N],
        lost_from: f64,
        rounds: Cell<u32>,
    }

    impl<const N: usize> Row<N> {
        fn new(apertures: [[f64; 2]; N]) -> Self {
            Self { apertures, lost_from: f64::INFINITY, rounds: Cell::new(0) }
        }

        /// The edge along +x, found from where it is expected.
        fn edge(&self, hint: Edge) -> Option<Edge> {
            edges(self, vec![Search::new(hint, 1e-4)], |_, radius| [radius, 0.0])[0]
        }
    }

    impl<const N: usize> Pencil for Row<N> {
        fn excesses(&self, points: &[[f64; 2]]) -> Vec<Excess> {
            self.rounds.set(self.rounds.get() + 1);
            let excess = |&[x, _]: &[f64; 2]| {
                // Somewhat bent, as excesses are.
                let value = |[steepness, cut]: [f64; 2]| steepness * (x - cut) * (0.7 + 0.3 * x);
                let values = self.apertures.iter().map(|&aperture| value(aperture)).enumerate();
                let (k, value) = values.max_by(|(_, a), (_, b)| a.total_cmp(b)).expect("an aperture");
                let lost = x >= self.lost_from;
                // What an aperture stops before it is lost is known to be outside of that.
                if lost && value <= 0.0 {
                    return Excess::of(None);
                }
                Excess { value, limit: Limit::Aperture(k), lost }
            };
            points.iter().map(excess).collect()
        }

        fn accuracy(&self) -> f64 {
            1e-4
        }

        fn is_spent(&self) -> bool {
            self.rounds.get() > 60
        }
    }

    /// An edge that is expected of an aperture.
    fn expected(radius: f64, steepness: f64, aperture: usize) -> Edge {
        Edge { radius, steepness, doubt: 0.0, limit: Limit::Aperture(aperture) }
    }

    #[test]
    fn an_edge_is_found_from_near_and_far_and_from_nothing() {
        for radius in [0.2, 0.9, 0.999, 1.0, 1.03, 4.0] {
            for hint in [Edge::at(radius), expected(radius, 0.7, 0), expected(radius, 0.7, 5)] {
                let row = Row::new([[0.8, 1.0]]);
                let found = row.edge(hint).expect("an edge");
                assert!((found.radius - 1.0).abs() < 1e-4 * radius.max(1.0), "{hint:?}: {found:?}");
                assert!(row.rounds.get() <= 8, "{hint:?}: {} rounds", row.rounds.get());
            }
        }
    }

    #[test]
    fn an_aperture_that_hides_the_expected_one_costs_few_rounds() {
        for hidden_by in [-1e-2, -1e-3, -1e-5] {
            // Hardly steeper outward than inward, as the rim of a fisheye's front.
            let row = Row::new([[0.9, 1.0], [1e-6, 1.0 - hidden_by / 1e-6]]);
            for radius in [0.95, 0.99, 1.01] {
                row.rounds.set(0);
                let found = row.edge(expected(radius, 0.8, 0)).expect("an edge");
                assert!((found.radius - 1.0).abs() < 1e-4, "{hidden_by} {radius}: {found:?}");
                assert!(row.rounds.get() <= 5, "{hidden_by} {radius}: {} rounds", row.rounds.get());
            }
        }
    }

    #[test]
    fn the_nearer_of_two_apertures_is_the_edge() {
        let row = Row::new([[0.3, 1.0], [2.0, 1.01]]);
        for aperture in [0, 1] {
            let found = row.edge(expected(1.02, 1.0, aperture)).expect("an edge");
            assert!((found.radius - 1.0).abs() < 1e-4 && found.limit == Limit::Aperture(0), "{found:?}");
        }
    }

    #[test]
    fn where_rays_are_lost_within_an_aperture_its_edge_is_not_the_pupils() {
        let row = Row { lost_from: 0.995, ..Row::new([[0.8, 1.0]]) };
        for radius in [0.9, 0.96, 0.994, 0.996, 0.999, 1.0, 1.01, 1.05] {
            for hint in [Edge::at(radius), expected(radius, 0.8, 0)] {
                row.rounds.set(0);
                let found = row.edge(hint).expect("an edge");
                assert!((0.0..2e-4).contains(&(0.995 - found.radius)), "{hint:?}: {found:?}");
            }
        }
        // Of rays that are lost beyond it, only.
        let row = Row { lost_from: 1.001, ..Row::new([[0.8, 1.0]]) };
        let found = row.edge(expected(1.02, 0.8, 0)).expect("an edge");
        assert!((found.radius - 1.0).abs() < 1e-4 && found.limit == Limit::Aperture(0), "{found:?}");
    }

    #[test]
    fn a_half_line_that_begins_outside_has_no_edge() {
        assert!(Row::new([[0.8, -0.1]]).edge(expected(1.0, 0.8, 0)).is_none());
    }
}
