//! The outline of one pencil's pupil: where half-lines from its middle, at equal angles in a frame that makes the pupil about
//! round, leave it.
//!
//! Every other half-line is traced; the edges along those amid are taken from cubics, or where they may have a kink are traced, too.
//! The edge along a half-line is found by how far rays are outside every aperture: by secants within a bracket, for many
//! half-lines side by side, for rays are traced in packets.

use std::{f64::consts::PI, sync::LazyLock};

use super::pencil::{Excess, LANES, Limit, Pencil};

/// Half-lines from one side of the plane of symmetry to the other, less one: more take more rays, fewer cut more off corners.
pub(crate) const HALF_LINES: usize = 72;
/// What a cubic may be off the chord between two half-lines, relative, for the edge along the one amid them to be taken from it:
/// more takes kinks for bends, which are off by up to three times that; less traces more.
const BENT: f64 = 2e-3;
/// Probe rays along a row of which nothing is known: fewer may miss a narrow pupil.
const PROBES: usize = 256;
/// [`Pencil::accuracy`] of the first row's edges, which say how far the image reaches.
const ROW_ACCURACY: f64 = 1e-4;
/// How much farther off the steepness of a neighbouring edge is taken to be than it was there, relative: more traces most edges
/// twice.
const NEIGHBOUR: f64 = 0.1;
/// Stride of the steps that halve the bracket: a larger one slows secants that hardly move.
const HALVING: u32 = 4;
/// How far from where it is expected an edge is looked for at once where there are lanes to spare, relative: more finds it less
/// closely, less misses it more often.
const EXPECTED: f64 = 0.05;
/// What the bend may be off by, over the width, where an outline is looked for: less looks for more of them again, more cuts more
/// corners off.
const ASKEW: f64 = 0.2;
/// How far beyond what gets through an edge is looked for after the first round where nothing leads to it, relative, and four times
/// as far after each one more: more overshoots, less takes more steps.
const FARTHER: f64 = 0.02;
/// Steps of a search at most: enough for the bracket of a ray that is lost, where there is no excess to go by.
const MOST_STEPS: u32 = 48;

/// What a pupil's bow moves a point at a distance from the plane of symmetry by: along the arc of a circle of curvature twice the
/// bow, to fourth order. The edges of crescents are images of round apertures.
pub(crate) fn bend(bow: f64, y: f64) -> f64 {
    let turn = bow * y;
    turn * y * (1.0 + turn * turn)
}

/// How a pencil's rays are named: those of the point (u, v) have x = center + width u + [`bend`], y = height v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub center: f64,
    pub width: f64,
    pub height: f64,
    pub bow: f64,
}

impl Frame {
    /// As high as a first row is wide.
    pub fn round([low, high]: [f64; 2]) -> Self {
        let width = (high - low) / 2.0;
        Self { center: f64::midpoint(low, high), width, height: width, bow: 0.0 }
    }

    pub fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let y = self.height * v;
        [self.center + self.width * u + bend(self.bow, y), y]
    }
}

/// The first row's edges, x at y = 0, from the middle of a guess; `None` where that does not get through.
pub(crate) fn first_row(pencil: &impl Pencil, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let middle = f64::midpoint(low, high);
    let hint = Edge::at((high - low) / 2.0);
    let search = || Search::new(hint, ROW_ACCURACY);
    let sides =
        edges(pencil, vec![search(), search()], |side, radius| [middle + [-radius, radius][side], 0.0]);
    Some([middle - sides[0]?.radius, middle + sides[1]?.radius])
}

/// The edges of what gets through nearest to the middle of a stretch of a row, by probe rays all along it.
pub(crate) fn row_in(pencil: &impl Pencil, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let at = |k: usize| low + (high - low) * (k as f64 + 0.5) / PROBES as f64;
    let points: Vec<[f64; 2]> = (0..PROBES).map(|k| [at(k), 0.0]).collect();
    let passes: Vec<bool> = pencil.excesses(&points).iter().map(Excess::passes).collect();
    let from_middle = |k: &usize| (2 * k + 1).abs_diff(PROBES);
    let nearest = (0..PROBES).filter(|&k| passes[k]).min_by_key(from_middle)?;
    let first = (0..nearest).rev().take_while(|&k| passes[k]).last().unwrap_or(nearest);
    let last = (nearest..PROBES).take_while(|&k| passes[k]).last().unwrap_or(nearest);
    let step = (high - low) / PROBES as f64;
    let searches = vec![Search::between(0.0, step), Search::between(0.0, step)];
    let sides = edges(pencil, searches, |side, radius| [[at(first) - radius, at(last) + radius][side], 0.0]);
    Some([at(first) - sides[0]?.radius, at(last) + sides[1]?.radius])
}

/// An outline, symmetric in v.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub frame: Frame,
    /// The frame that fits it.
    pub fitting: Frame,
    /// Along half-lines at equal angles from +u to -u.
    pub edges: Vec<Edge>,
}

/// The directions of the half-lines.
static DIRECTIONS: LazyLock<[[f64; 2]; HALF_LINES + 1]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let (sin, cos) = (PI * k as f64 / HALF_LINES as f64).sin_cos();
        if k == HALF_LINES { [-1.0, 0.0] } else { [cos, sin] }
    })
});

/// The direction of a half-line.
pub(crate) fn direction(k: usize) -> [f64; 2] {
    DIRECTIONS[k]
}

impl Outline {
    /// An ellipse.
    pub fn ellipse(frame: Frame) -> Self {
        Self { frame, fitting: frame, edges: vec![Edge::at(1.0); HALF_LINES + 1] }
    }

    /// The outline of a pencil from one that is expected, in the frame of that; `None` where a half-line has no edge.
    pub fn trace(pencil: &impl Pencil, expected: &Self) -> Option<Self> {
        let frame = expected.frame;
        let find = |outline: &mut [Edge], numbers: &[usize]| -> Option<()> {
            let searches = numbers.iter().map(|&k| Search::new(outline[k], pencil.accuracy())).collect();
            let point = |radius: f64, k: usize| frame.point(direction(k).map(|part| radius * part));
            let found = edges(pencil, searches, |number, radius| point(radius, numbers[number]));
            for (&k, found) in numbers.iter().zip(found) {
                outline[k] = found?;
            }
            Some(())
        };
        let mut outline = expected.edges.clone();
        find(&mut outline, &Vec::from_iter((0..=HALF_LINES).step_by(2)))?;
        let mut corners = Vec::new();
        for k in (1..HALF_LINES).step_by(2) {
            let smooth = amid(&outline, k);
            outline[k] = smooth.unwrap_or_else(|| onward(&outline, k));
            corners.extend(smooth.is_none().then_some(k));
        }
        find(&mut outline, &corners)?;
        Some(Self { frame, fitting: frame, edges: outline }.fitted())
    }

    /// The points (u, v) of the edge.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.edges.iter().enumerate().map(|(k, edge)| direction(k).map(|part| edge.radius * part))
    }

    /// The area of its upper half in u and v, distances from the middle being straight in the angle.
    pub fn half_area(&self) -> f64 {
        self.edges.windows(2).map(|pair| sector(pair[0].radius, pair[1].radius)).sum()
    }

    /// Its area.
    pub fn area(&self) -> f64 {
        2.0 * self.half_area() * self.frame.width * self.frame.height
    }

    /// With the frame that fits it: as high as it is, and with the bow that takes the bend out of its middle, by one step of
    /// Newton's method: ∫∫ x D dA / ∫∫ D² dA more, with x what is left of the bend and D what it changes by with the bow. Both
    /// integrals are taken along the edge.
    fn fitted(self) -> Self {
        let frame = self.frame;
        let points: Vec<[f64; 2]> = self.points().map(|[u, v]| [frame.width * u, frame.height * v]).collect();
        let height = points.iter().fold(0.0_f64, |most, point| most.max(point[1]));
        let [mut products, mut squares] = [0.0; 2];
        for pair in points.windows(2) {
            let step = pair[1][1] - pair[0][1];
            for [x, y] in [pair[0], pair[1]] {
                let change = y * y * (1.0 + 3.0 * (frame.bow * y).powi(2));
                products += step * x * x * change / 4.0;
                squares += step * x * change * change / 2.0;
            }
        }
        let more = products / squares;
        let bow = frame.bow + if more.is_finite() { more } else { 0.0 };
        // At most half a circle.
        let bow = bow.clamp(-0.5 / height, 0.5 / height);
        Self { fitting: Frame { height, bow, ..frame }, ..self }
    }

    /// The same found once more in the frame that fits it.
    pub fn found_again(&self, pencil: &impl Pencil) -> Option<Self> {
        Self::trace(pencil, &Self::ellipse(self.fitting))
    }

    /// Whether it is bent otherwise than its own frame, so that half-lines may have cut corners off.
    pub fn is_askew(&self) -> bool {
        let Frame { width, height, bow, .. } = self.fitting;
        (bow - self.frame.bow).abs() * height * height > ASKEW * width
    }

    /// The one expected of a first row where the polynomial through some leads, each of which counts by its weight. Heights go by
    /// what is left of them over what pupils shrink by, `shrunk` at each and here.
    pub fn expected(known: &[(&Self, f64, f64)], row: [f64; 2], shrunk: f64) -> Self {
        let last = known[known.len() - 1].0;
        // Not below half of the last nor above twice that.
        let on = |numbers: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut newest) = (0.0, 0.0);
            for (number, (_, weight, _)) in numbers.zip(known) {
                (sum, newest) = (sum + weight * number, number);
            }
            sum.clamp(0.5 * newest, 2.0 * newest)
        };
        let heights = known.iter().map(|(outline, _, shrunk)| outline.fitting.height / shrunk);
        let height = shrunk * on(&mut heights.into_iter());
        let bow = known.iter().map(|(outline, weight, _)| weight * outline.fitting.bow).sum();
        let frame = Frame { height, bow, ..Frame::round(row) };
        let scale = |outline: &Self| outline.frame.height / outline.fitting.height;
        let scales: Vec<f64> = known.iter().map(|(outline, ..)| scale(outline)).collect();
        let [wider, higher] = [frame.width / last.frame.width, frame.height / last.frame.height];
        let edge = |k: usize| {
            let [cos, sin] = direction(k);
            let radius = |(outline, scale): (&Self, &f64)| {
                outline.edges[k].radius * (cos * cos + scale * scale * sin * sin).sqrt()
            };
            let mut radii = known.iter().map(|(outline, ..)| *outline).zip(&scales).map(radius);
            let own = last.edges[k];
            // The frame's size is the radius's unit.
            let unit = ((wider * cos).powi(2) + (higher * sin).powi(2)).sqrt();
            Edge { radius: on(&mut radii), steepness: unit * own.steepness, ..own }
        };
        // The others are expected once these are found.
        let traced = |k: usize| if k.is_multiple_of(2) { edge(k) } else { last.edges[k] };
        Self { frame, fitting: frame, edges: (0..=HALF_LINES).map(traced).collect() }
    }

    /// The edge's distance from the middle in a direction of the frame, from 0 to π.
    pub fn radius(&self, angle: f64) -> f64 {
        let place = angle / PI * HALF_LINES as f64;
        let k = (place as usize).min(HALF_LINES - 1);
        let [near, far] = [0, 1].map(|next| self.edges[k + next].radius);
        near + (place - k as f64) * (far - near)
    }

    /// What limits it along each half-line and along those beside; `None` about a corner.
    pub fn limits(&self) -> Vec<Option<Limit>> {
        let about = |k: usize| [-1, 0, 1].map(|steps| beside(&self.edges, k, steps).limit);
        (0..=HALF_LINES).map(about).map(|limits| (limits == [limits[0]; 3]).then_some(limits[0])).collect()
    }

    /// Moves the edge out about corners, where nothing alone is among the `limits`: by how far it lies outside the line from
    /// neighbour to neighbour, which is as far at least as a corner beside it does between the half-lines.
    pub fn hold_corners(&mut self, limits: &[Option<Limit>]) {
        let widened = limits.iter().enumerate().map(|(k, limit)| {
            let [before, own, after] = [-1, 0, 1].map(|steps| beside(&self.edges, k, steps).radius);
            own + if limit.is_none() { (own - f64::midpoint(before, after)).max(0.0) } else { 0.0 }
        });
        let widened: Vec<f64> = widened.collect();
        for (edge, radius) in self.edges.iter_mut().zip(widened) {
            edge.radius = radius;
        }
    }
}

/// The edge some half-lines from one, which are mirrored about the plane of symmetry.
fn beside(edges: &[Edge], k: usize, steps: isize) -> &Edge {
    let k = k.wrapping_add_signed(steps) as isize;
    &edges[k.unsigned_abs().min(2 * HALF_LINES - k.unsigned_abs())]
}

/// The edge along a half-line by the cubic through the four about it; `None` where not one aperture limits them, or where there may
/// be a kink. Nobody asks how steep it is.
fn amid(edges: &[Edge], k: usize) -> Option<Edge> {
    let about @ [before_last, before, after, after_next] =
        [-3, -1, 1, 3].map(|steps| beside(edges, k, steps));
    let chord = f64::midpoint(before.radius, after.radius);
    let bent = (chord - f64::midpoint(before_last.radius, after_next.radius)) / 8.0;
    let limit = before.limit;
    let is_of_one = limit != Limit::Optics && about.iter().all(|edge| edge.limit == limit);
    (is_of_one && bent.abs() <= BENT * chord).then_some(Edge { limit, ..Edge::at(chord + bent) })
}

/// The edge that is expected along a half-line with a corner about it: the nearer of those to which either side leads.
fn onward(edges: &[Edge], k: usize) -> Edge {
    let lead = |side: isize| {
        let [near, far] = [side, 3 * side].map(|steps| beside(edges, k, steps));
        // Not farther than twice as far.
        let radius =
            (near.radius + (near.radius - far.radius) / 2.0).clamp(0.5 * near.radius, 2.0 * near.radius);
        Edge { radius, ..*near }
    };
    let [before, after] = [lead(-1), lead(1)];
    if before.radius < after.radius { before } else { after }
}

/// Area between two half-lines, the distance going straight in the angle from one to the other.
pub(crate) fn sector(from: f64, to: f64) -> f64 {
    PI / HALF_LINES as f64 * (from * from + from * to + to * to) / 6.0
}

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
    /// The bracket: how far a ray got through, and the nearest one that did not, with its excess.
    inside: f64,
    outer: Option<(f64, Excess)>,
    /// The last ray.
    last: Option<(f64, Excess)>,
    /// The edge that is expected.
    hint: Edge,
    /// [`Pencil::accuracy`].
    accuracy: f64,
    steps: u32,
    found: Option<Edge>,
}

impl Search {
    /// From an edge that is expected.
    pub fn new(hint: Edge, accuracy: f64) -> Self {
        Self {
            middle: hint.radius,
            around: [1.0 - EXPECTED, 1.0 + EXPECTED].map(|part| part * hint.radius),
            inside: 0.0,
            outer: None,
            last: None,
            hint,
            accuracy,
            steps: 0,
            found: None,
        }
    }

    /// Between a ray that gets through and one that does not.
    pub fn between(inside: f64, outside: f64) -> Self {
        let hint = Edge::at(f64::midpoint(inside, outside));
        let outer = Some((outside, Excess::of(None)));
        Self { inside, outer, around: [inside, outside], ..Self::new(hint, ROW_ACCURACY) }
    }

    /// Where the next rays are to be traced, outward.
    fn looks(&self, count: usize) -> impl Iterator<Item = f64> + use<> {
        let (middle, [from, to]) = (self.middle, self.around);
        let at = move |k: usize| from + (to - from) * (k + 1) as f64 / (count + 1) as f64;
        (0..count).map(move |k| if count == 1 { middle } else { at(k) })
    }

    /// Learns what became of rays, outward; whether others are to be traced.
    fn learn(&mut self, rays: impl Iterator<Item = (f64, Excess)>) -> bool {
        let mut earlier = [None; 2];
        for ray in rays {
            earlier = [self.last.replace(ray), self.outer];
            let (radius, excess) = ray;
            if !excess.passes() {
                self.outer = Some(ray);
                break;
            }
            self.inside = radius;
        }
        let inside = self.inside;
        let (outside, outer_limit) =
            self.outer.map_or((f64::INFINITY, self.hint.limit), |(radius, outer)| (radius, outer.limit));
        let Some((radius, Excess { value, limit, lost })) = self.last else { return false };
        // How steep the excess is; `doubt` is how far off that may be, relative, and so the edge by that part of the step to it.
        let before = earlier.into_iter().flatten().find(|(_, before)| before.limit == limit);
        let steepness = match before {
            _ if limit == Limit::Optics => f64::NAN,
            Some((from, before)) => (value - before.value) / (radius - from),
            // Another aperture than the one that is expected may hardly limit what it lets through.
            None if value <= 0.0 && limit != self.hint.limit => f64::NAN,
            None => self.hint.steepness,
        };
        let edge = radius - value / steepness;
        let fits = steepness > 0.0 && edge >= inside && edge <= outside;
        // What is nearer than expected is found to a part of its own distance.
        let about = if fits { edge } else { outside };
        let distance = about.min(self.hint.radius);
        let accuracy = self.accuracy * distance;
        let doubt = match before {
            Some((from, _)) => (edge - from).abs() / distance,
            None if self.hint.limit == limit => self.hint.doubt + NEIGHBOUR,
            None => f64::INFINITY,
        };
        // Where rays are lost within the aperture, too, its edge is not the pupil's.
        if fits && !lost && (edge - radius).abs() * doubt <= accuracy {
            self.found = Some(Edge { radius: edge, steepness, doubt, limit });
            return false;
        }
        if outside - inside <= accuracy {
            let steepness = if outer_limit == self.hint.limit { self.hint.steepness } else { f64::NAN };
            self.found = Some(Edge { radius: inside, steepness, doubt: f64::INFINITY, limit: outer_limit });
            return false;
        }
        self.steps += 1;
        let is_bracketed = outside < f64::INFINITY;
        (self.middle, self.around) = if fits && (!is_bracketed || !self.steps.is_multiple_of(HALVING)) {
            // A little inside, where the aperture's edge may be that of lost rays.
            let edge = if lost { edge - 5.0 * accuracy } else { edge };
            // Of an aperture that is far away no more is believed than twice the way.
            let edge = edge.min(2.0 * radius + accuracy).clamp(inside, outside);
            let off = (edge - radius).abs() * doubt.min(1.0);
            (edge, [edge - off, edge + off].map(|at| at.clamp(inside, outside)))
        } else if is_bracketed {
            (f64::midpoint(inside, outside), [inside, outside])
        } else {
            let farther = self.hint.radius * FARTHER * 4_f64.powi(self.steps as i32 - 1);
            (inside + farther, [inside, inside + 2.0 * farther])
        };
        if self.middle == inside || self.middle == outside {
            self.middle = f64::midpoint(inside, outside.min(inside + 4.0 * accuracy));
        }
        self.steps < MOST_STEPS && self.middle.is_finite()
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
        let count = ((LANES - beginning.iter().len()) / open.len()).max(1);
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
    use super::*;
    use std::cell::Cell;

    /// An outline of which one aperture limits all.
    fn outline(radius: impl Fn(f64) -> f64) -> Vec<Edge> {
        let edge =
            |k: usize| Edge { limit: Limit::Aperture(3), ..Edge::at(radius(k as f64 / HALF_LINES as f64)) };
        (0..=HALF_LINES).map(edge).collect()
    }

    #[test]
    fn the_edge_amid_others_is_that_of_their_cubic() {
        let cubic = |x: f64| 1.0 + 0.4 * x - 0.7 * x * x + 0.2 * x.powi(3);
        let edges = outline(cubic);
        for k in (3..HALF_LINES - 3).step_by(2) {
            let found = amid(&edges, k).expect("smooth").radius;
            assert!((found - cubic(k as f64 / HALF_LINES as f64)).abs() < 1e-15, "{k}: {found}");
        }
        // Beyond the plane of symmetry the outline is mirrored.
        let even = outline(|x| 1.0 + 0.05 * (std::f64::consts::PI * x).cos());
        for k in [1, HALF_LINES - 1] {
            let found = amid(&even, k).expect("smooth").radius;
            assert!((found - even[k].radius).abs() < 1e-6, "{k}: {found}");
        }
    }

    #[test]
    fn at_a_corner_or_a_kink_there_is_no_such_edge() {
        let k = HALF_LINES / 2 + 1;
        for steps in [-3, -1, 1, 3] {
            let mut edges = outline(|_| 1.0);
            assert!(amid(&edges, k).is_some());
            edges[k.wrapping_add_signed(steps)].limit = Limit::Aperture(4);
            assert!(amid(&edges, k).is_none(), "{steps}");
        }
        let kinked = outline(|x| 1.0 - (x - k as f64 / HALF_LINES as f64).abs());
        assert!(amid(&kinked, k).is_none());
        // The side that falls leads nearer.
        let falling = outline(|x| 1.0 - (x - 0.5).max(0.0));
        assert!(onward(&falling, k).radius <= falling[k].radius + 1e-12);
        let mut lost = outline(|_| 1.0);
        lost.iter_mut().for_each(|edge| edge.limit = Limit::Optics);
        assert!(amid(&lost, k).is_none());
    }

    /// A row of which the excess is known: by how much an aperture is missed, and which.
    struct Row<F> {
        excess: F,
        rounds: Cell<u32>,
    }

    impl<F: Fn(f64) -> (f64, usize)> Row<F> {
        fn new(excess: F) -> Self {
            Self { excess, rounds: Cell::new(0) }
        }

        /// The edge by as many searches as take all lanes: a ray for each in a round.
        fn edge(&self, hint: Edge) -> f64 {
            let searches = (0..LANES).map(|_| Search::new(hint, self.accuracy())).collect();
            let found = edges(self, searches, |_, radius| [radius, 0.0]);
            found[LANES - 1].expect("there is an edge").radius
        }
    }

    impl<F: Fn(f64) -> (f64, usize)> Pencil for Row<F> {
        fn excesses(&self, points: &[[f64; 2]]) -> Vec<Excess> {
            self.rounds.set(self.rounds.get() + 1);
            let excess = |&[x, _]: &[f64; 2]| {
                let (value, surface) = (self.excess)(x);
                Excess { value, limit: Limit::Aperture(surface), lost: false }
            };
            points.iter().map(excess).collect()
        }

        fn accuracy(&self) -> f64 {
            1e-4
        }

        fn is_spent(&self) -> bool {
            false
        }
    }

    #[test]
    fn an_edge_is_found_where_another_aperture_is_nearer_up_to_it() {
        for slack in [1e-5, 1e-4, 1e-3, 1e-2] {
            // The other hardly lets rays through, wherever they are.
            let row = Row::new(|x| {
                let (ending, grazed) = (0.6 * (x - 1.0), 1e-6 * x - slack);
                if ending > grazed { (ending, 1) } else { (grazed, 2) }
            });
            for expected in [0.95, 0.98, 0.999, 1.0, 1.001, 1.02, 1.05] {
                row.rounds.set(0);
                let hint = Edge { radius: expected, steepness: 0.6, doubt: 0.01, limit: Limit::Aperture(1) };
                let found = row.edge(hint);
                assert!((found - 1.0).abs() < 2e-4, "{slack}, {expected}: {found}");
                let rounds = row.rounds.get();
                assert!(rounds <= 4, "{slack}, {expected}: {rounds} rounds");
            }
        }
    }

    #[test]
    fn an_edge_much_nearer_than_expected_is_found_as_closely() {
        for nearer in [3.0, 10.0, 30.0, 100.0] {
            // Bent, as excesses are.
            let row = Row::new(|x: f64| (x * x.hypot(1.0) / 2_f64.sqrt() - 1.0, 1));
            let found = row.edge(Edge::at(nearer));
            assert!((found - 1.0).abs() < 1e-4, "{nearer}: {found}");
        }
    }
}
