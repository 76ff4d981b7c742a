//! The outlines of film points' pupils, traced side by side: points of an edge about a centre, joined by smooth arcs, one
//! a limiting aperture, that meet in corners found exactly.

use std::f64::consts::PI;

use super::{
    arc::{Parabola, Piece, Point, direction, extend, piece},
    search::{Crossing, EdgeFinder, HalfLine},
    view::{Limit, View},
};

/// The half of a pupil's outline with sy >= 0.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// sx of the centre: the middle of the pupil's chord on the meridian.
    pub center: f64,
    /// From angle 0 to π without a gap; none is empty.
    pub pieces: Vec<Piece>,
    /// Where arcs meet: angle and distance from the centre.
    pub corners: Vec<(f64, f64)>,
}

/// Where to look for an outline.
pub(crate) struct Guess<'a> {
    pub view: View<'a>,
    /// sx of a point that lies inside.
    pub inside: f64,
    /// Angles at which the outline is to be traced, from 0 to π, and the distance expected there: as many for all
    /// outlines that are traced together.
    pub points: Vec<(f64, f64)>,
}

/// Interval of angles in which a corner is pinned down before the arcs are simply extended to meet.
const CORNER_BRACKET: f64 = 4e-2;
/// Searches a corner may cost.
const CORNER_STEPS: u32 = 8;
/// How far from where it is expected, relative, the edge may be found half way between a corner and the point next to it,
/// and how often the halves are looked at where it is farther.
const AS_EXPECTED: f64 = 5e-4;
const CORNER_LOOKS: u32 = 4;
/// How far an arc may be off between two points, relative, before it gets more points.
const OFF: f64 = 1e-3;
/// Share of the pupil that may be in doubt between two points that many points are put between no more.
const DOUBT: f64 = 1e-5;
/// The same in all: beyond, no fan fits.
const MOST_DOUBT: f64 = 1e-4;
/// Times that points may be made denser, and times until that needs a doubt.
const REFINEMENTS: u32 = 6;
const FREE_REFINEMENTS: u32 = 2;
/// Interval of angles within which an edge that leads from one distance to another jumps.
const JUMP: f64 = 3e-3;
/// Ends of arcs that do not meet are a jump where their ratio is that far from 1, else an arc is not known well.
const ENDS_APART: f64 = 0.015;
/// Distances are another where their ratio is that far from 1.
const APART: f64 = 0.05;

impl Outline {
    /// Traces the outlines of several pupils. `None` for one of which a half-line has no edge, or more than one.
    pub fn trace(finder: EdgeFinder<'_>, guesses: &[Guess<'_>]) -> Vec<Option<Self>> {
        let mut traces = Trace::begin(finder, guesses);
        for [step, stride] in [[4, usize::MAX], [2, 4], [1, 2]] {
            trace_between(finder, &mut traces, step, stride);
        }
        for trace in traces.iter_mut().flatten() {
            trace.order();
        }
        for round in 0..=REFINEMENTS {
            if !refine(finder, &mut traces, round) {
                break;
            }
        }
        find_corners(finder, &mut traces);
        look_beside_corners(finder, &mut traces);
        traces.into_iter().map(|trace| trace.filter(|trace| !trace.torn).map(Trace::outline)).collect()
    }

    /// Distance of the edge from the centre at `angle` in [0, π]. `cursor` is where the last
    /// search ended: angles that grow cost no search.
    pub fn radius(&self, angle: f64, cursor: &mut usize) -> f64 {
        self.inverse(angle, cursor).recip()
    }

    /// 1/distance, as [`Outline::radius`].
    pub fn inverse(&self, angle: f64, cursor: &mut usize) -> f64 {
        while *cursor > 0 && angle < self.pieces[*cursor].from {
            *cursor -= 1;
        }
        while *cursor + 1 < self.pieces.len() && angle > self.pieces[*cursor].to {
            *cursor += 1;
        }
        self.pieces[*cursor].inverse(angle)
    }
}

/// An outline while it is traced.
struct Trace<'a> {
    guess: &'a Guess<'a>,
    center: f64,
    /// At the angles of the guess.
    traced: Vec<Option<Crossing>>,
    /// By angle from 0 to π. A corner stands twice, as the end of each of its arcs.
    found: Vec<(f64, Crossing)>,
    /// Where an arc ends and the next begins: from `found` of this number to the next, and the searches that the corner
    /// may still cost.
    gaps: Vec<(usize, u32)>,
    corners: Vec<(f64, f64)>,
    /// Whether its points are close enough.
    smooth: bool,
    /// Whether arcs were found to end apart, or to jump: a half-line meets the edge more than once.
    torn: bool,
}

impl<'a> Trace<'a> {
    /// Finds both ends of each of the chords on the meridian.
    fn begin(finder: EdgeFinder<'_>, guesses: &'a [Guess<'a>]) -> Vec<Option<Self>> {
        let start = |radius| Crossing { radius, limit: Limit::Optics, steepness: 1.0 };
        let ends = guesses.iter().flat_map(|Guess { view, inside, points }| {
            let along = |direction, (_, radius): (f64, f64)| HalfLine {
                view,
                center: *inside,
                direction,
                guess: start(radius),
            };
            [along([1.0, 0.0], points[0]), along([-1.0, 0.0], points[points.len() - 1])]
        });
        let ends = finder.crossings(ends);
        let trace = |(guess, ends): (&'a Guess<'a>, &[Option<Crossing>])| {
            let &[Some(right), Some(left)] = ends else { return None };
            let radius = f64::midpoint(right.radius, left.radius);
            let mut traced = vec![None; guess.points.len()];
            traced[0] = Some(Crossing { radius, ..right });
            traced[guess.points.len() - 1] = Some(Crossing { radius, ..left });
            Some(Self {
                guess,
                center: guess.inside + (right.radius - left.radius) / 2.0,
                traced,
                found: Vec::with_capacity(32),
                gaps: Vec::new(),
                corners: Vec::new(),
                smooth: false,
                torn: false,
            })
        };
        guesses.iter().zip(ends.chunks_exact(2)).map(trace).collect()
    }

    /// Puts what was traced in order.
    fn order(&mut self) {
        let found = self.guess.points.iter().zip(&self.traced);
        self.found = found.filter_map(|(&(angle, _), edge)| edge.map(|edge| (angle, edge))).collect();
    }

    /// What was found of number `i`; mirrored at 0 and π beyond the ends.
    fn point(&self, i: isize) -> Point {
        let last = self.found.len() as isize - 1;
        let (angle, crossing) = self.found[(last - (last - i.abs()).abs()) as usize];
        Point::new(
            if i < 0 {
                -angle
            } else if i > last {
                2.0 * PI - angle
            } else {
                angle
            },
            crossing,
        )
    }

    /// How far each arc is off between its points, relative, to the next of each point but the last: from what its cubic
    /// through every second one misses the points between by. Where arcs meet 0, and where one has too few points.
    fn misses(&self) -> Vec<f64> {
        let mut misses = vec![0.0_f64; self.found.len() - 1];
        for i in 1..misses.len() {
            let own = self.point(i as isize);
            let [before, after] = [-1, 1].map(|step| self.point(i as isize + step));
            if before.limit != own.limit || after.limit != own.limit {
                continue;
            }
            // Where a straight line is good enough a cubic is.
            let part = (own.angle - before.angle) / (after.angle - before.angle);
            let straight = before.inverse + part * (after.inverse - before.inverse);
            if (straight - own.inverse).abs() < 8.0 * OFF * own.inverse {
                continue;
            }
            let [first, last] = [-3, 3].map(|step| self.point(i as isize + step));
            let stencil = [before, after, first, last];
            let [with_first, with_last] = [first, last].map(|point| point.limit == own.limit);
            // Errors of cubics go with the fourth power of the distance, of parabolas with the third.
            let (stencil, less) = match (with_first, with_last) {
                (true, true) => (&stencil[..], 16.0),
                (true, false) => (&stencil[..3], 8.0),
                (false, true) => (&[before, after, last][..], 8.0),
                (false, false) => continue,
            };
            let off = (extend(stencil, own.angle) / own.inverse - 1.0).abs() / less;
            for miss in &mut misses[i - 1..=i] {
                *miss = miss.max(off);
            }
        }
        misses
    }

    /// Whether the edge leads from one distance to another between the `i`th point and the next.
    fn leaps(&self, i: usize) -> bool {
        let [a, b] = [i, i + 1].map(|i| self.found[i].1.radius);
        (a - b).abs() > APART * a.max(b)
    }

    /// Between which points an arc is to be looked at closer, in a round of that number. Where there are none, notes
    /// whether too much is in doubt.
    fn doubtful(&mut self, round: u32) -> Vec<usize> {
        if self.smooth {
            return Vec::new();
        }
        let misses = self.misses();
        let square = |i: usize| self.found[i].1.radius.powi(2) + self.found[i + 1].1.radius.powi(2);
        let sector = |i: usize| square(i) * (self.found[i + 1].0 - self.found[i].0);
        let whole: f64 = (0..misses.len()).map(sector).sum();
        let doubt = |i: usize| 2.0 * misses[i] * sector(i) / whole;
        let wanted = |i: &usize| misses[*i] > OFF && (round < FREE_REFINEMENTS || doubt(*i) > DOUBT);
        let doubtful: Vec<usize> = (0..misses.len()).filter(wanted).collect();
        if doubtful.is_empty() || round == REFINEMENTS {
            self.smooth = true;
            let rough = (0..misses.len()).filter(|&i| misses[i] > OFF);
            self.torn = rough.map(doubt).sum::<f64>() > MOST_DOUBT;
            return Vec::new();
        }
        doubtful
    }

    fn half_line(&self, angle: f64, guess: Crossing) -> HalfLine<'a> {
        HalfLine { view: &self.guess.view, center: self.center, direction: direction(angle), guess }
    }

    /// Where the edge is expected at the `i`th angle, from what was found at multiples of `stride` on both sides: what
    /// the expectation is off by there it is likely off by between them.
    fn expected(&self, i: usize, stride: usize) -> Option<Crossing> {
        let points = &self.guess.points;
        let before = i - i % stride;
        let after = before.saturating_add(stride).min(points.len() - 1);
        let known = |k: usize| self.traced[k].map(|edge| (edge, edge.radius / points[k].1));
        let ((low, low_ratio), (high, high_ratio)) = (known(before)?, known(after)?);
        let part = (i - before) as f64 / (after - before) as f64;
        let radius = points[i].1 * (low_ratio + part * (high_ratio - low_ratio));
        let nearer = if part <= 0.5 { low } else { high };
        let steepness = if low.limit == high.limit {
            low.steepness + part * (high.steepness - low.steepness)
        } else {
            nearer.steepness
        };
        Some(Crossing { radius, steepness, ..nearer })
    }

    /// Points of one arc, at most three, from the `i`th of what was found backward or forward.
    fn arc(&self, i: usize, forward: bool) -> Arc {
        let limit = self.found[i].1.limit;
        let mut arc = Arc { points: [Point::new(self.found[i].0, self.found[i].1); 3], count: 0 };
        let left = if forward { self.found.len() - i } else { i + 1 };
        for k in 0..left.min(3) {
            let (angle, crossing) = self.found[if forward { i + k } else { i - k }];
            if crossing.limit != limit {
                break;
            }
            arc.points[k] = Point::new(angle, crossing);
            arc.count = k + 1;
        }
        arc
    }

    /// Where the arcs on both sides of the gap after the `i`th point meet, or its middle where they do not.
    fn meeting(&self, i: usize) -> Meeting {
        let points = [self.arc(i, false), self.arc(i + 1, true)];
        let arcs @ [begun, coming] = points.each_ref().map(|arc| Parabola::through(arc.points()));
        let (low, high) = (self.found[i].0, self.found[i + 1].0);
        let crosses = (begun.at(low) - coming.at(low)) * (begun.at(high) - coming.at(high)) < 0.0;
        let angle = if crosses { begun.meets(coming, low, high) } else { f64::midpoint(low, high) };
        let is_known = points.iter().all(|arc| arc.count > 1);
        Meeting { angle, crosses, is_known, arcs }
    }

    /// Closes the gaps that are narrow enough; angles and expectations for two searches in each of the others.
    fn close_gaps(&mut self) -> Vec<(f64, Crossing)> {
        let mut wanted = Vec::new();
        let mut open = Vec::new();
        // Points that come in after the `i`th move those after it.
        let mut moved = 0;
        for (i, steps) in std::mem::take(&mut self.gaps) {
            let i = i + moved;
            let Meeting { angle: meeting, crosses, is_known, arcs: [begun, coming] } = self.meeting(i);
            let ((low, from), (high, to)) = (self.found[i], self.found[i + 1]);
            let width = high - low;
            // Arcs that do not meet are followed to where one ends.
            let leaps = !crosses && self.leaps(i);
            if steps == 0 || width < if leaps { JUMP } else { CORNER_BRACKET } {
                self.torn |= leaps && width < JUMP;
                // Where the edge jumps they end apart, and the outer end is the corner.
                let ends = [begun, coming].map(|arc| arc.at(meeting).recip());
                let mean = 2.0 / (ends[0].recip() + ends[1].recip());
                let jumps = !crosses && is_known && (ends[0] / ends[1]).ln().abs() > ENDS_APART;
                let (ends, corner) = if jumps { (ends, ends[0].max(ends[1])) } else { ([mean; 2], mean) };
                self.corners.push((meeting, corner));
                let ends = [from, to]
                    .into_iter()
                    .zip(ends)
                    .map(|(end, radius)| (meeting, Crossing { radius, ..end }));
                self.found.splice(i + 1..i + 1, ends);
                moved += 2;
                continue;
            }
            // On both sides of where the arcs are expected to meet.
            let margin = if crosses { 0.45 * CORNER_BRACKET } else { width / 6.0 };
            let angles = [
                (meeting - margin).clamp(low + 0.1 * width, high - 0.3 * width),
                (meeting + margin).clamp(low + 0.3 * width, high - 0.1 * width),
            ];
            wanted.extend(angles.map(|angle| {
                let radius = begun.at(angle).max(coming.at(angle)).recip();
                (angle, Crossing { radius, ..if angle < meeting { from } else { to } })
            }));
            open.push((i, steps));
        }
        self.gaps = open;
        wanted
    }

    /// Takes in what was found by two searches in each gap.
    fn take_in(&mut self, found: &[(f64, Crossing)]) {
        let mut gaps = Vec::new();
        for (number, ((i, steps), pair)) in
            std::mem::take(&mut self.gaps).into_iter().zip(found.chunks_exact(2)).enumerate()
        {
            let i = i + 2 * number;
            self.found.splice(i + 1..i + 1, pair.iter().copied());
            let differs = |&k: &usize| self.found[k].1.limit != self.found[k + 1].1.limit;
            gaps.extend((i..i + 3).filter(differs).map(|k| (k, steps - 1)));
        }
        self.gaps = gaps;
    }

    /// The first wide stretch of an arc on each side of each corner: from which of what was found to the next.
    fn beside_corners(&self) -> Vec<usize> {
        let last = self.found.len() - 1;
        let is_corner = |i: usize| self.found[i].0 == self.found[i + 1].0;
        let is_wide = |&i: &usize| self.found[i + 1].0 - self.found[i].0 > CORNER_BRACKET;
        let mut beside: Vec<usize> = (0..last)
            .filter(|&i| is_corner(i))
            .flat_map(|i| {
                let before = (0..i).rev().take_while(|&k| !is_corner(k)).find(is_wide);
                let after = (i + 1..last).take_while(|&k| !is_corner(k)).find(is_wide);
                before.into_iter().chain(after)
            })
            .collect();
        beside.dedup();
        beside
    }

    /// What was found, in order, and mirrored at 0 and π for the sake of interpolation; and which of them are first and last
    /// of what was found.
    fn points(&self) -> (Vec<Point>, [usize; 2]) {
        let count = self.found.len();
        let mirrored = |point: Point, about: f64| Point { angle: 2.0 * about - point.angle, ..point };
        let (start, end) = (self.arc(0, true), self.arc(count - 1, false));
        let mut points = Vec::with_capacity(count + 4);
        points.extend(start.points().iter().skip(1).rev().map(|&point| mirrored(point, 0.0)));
        let first = points.len();
        points.extend(self.found.iter().map(|&(angle, crossing)| Point::new(angle, crossing)));
        let last = points.len() - 1;
        points.extend(end.points().iter().skip(1).map(|&point| mirrored(point, PI)));
        (points, [first, last])
    }

    /// The smooth pieces through all that was found.
    fn outline(mut self) -> Outline {
        self.corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (points, [first, last]) = self.points();
        let pieces = (first..last).filter(|&i| points[i].angle < points[i + 1].angle);
        Outline {
            center: self.center,
            pieces: pieces.map(|i| piece(&points, i)).collect(),
            corners: self.corners,
        }
    }
}

/// Where two arcs meet.
struct Meeting {
    angle: f64,
    /// Whether they do, or the angle is but the middle between them.
    crosses: bool,
    /// Whether more than a point is known of both arcs.
    is_known: bool,
    /// The arc before, and the one after.
    arcs: [Parabola; 2],
}

/// The end of an arc, from there on.
struct Arc {
    points: [Point; 3],
    count: usize,
}

impl Arc {
    fn points(&self) -> &[Point] {
        &self.points[..self.count]
    }
}

/// Finds the edge at every `step`th angle where it is not known yet; it is at multiples of `stride`, and at the ends. An
/// outline of which a half-line has no edge ends here.
fn trace_between(finder: EdgeFinder<'_>, traces: &mut [Option<Trace<'_>>], step: usize, stride: usize) {
    let mut places = Vec::new();
    let mut half_lines = Vec::new();
    for (number, trace) in traces.iter().enumerate() {
        let Some(trace) = trace else { continue };
        let last = trace.traced.len() - 1;
        for i in (step..last).step_by(step).filter(|&i| trace.traced[i].is_none()) {
            let Some(expected) = trace.expected(i, stride.min(last)) else { continue };
            places.push((number, i));
            half_lines.push(trace.half_line(trace.guess.points[i].0, expected));
        }
    }
    let edges = finder.crossings(half_lines.into_iter());
    for ((number, i), edge) in places.into_iter().zip(edges) {
        match (&mut traces[number], edge) {
            (Some(trace), Some(edge)) => trace.traced[i] = Some(edge),
            (trace, _) => *trace = None,
        }
    }
}

/// Finds the edge half way between points where an arc may be too far off, if there are any. An outline of which a
/// half-line has no edge ends here.
fn refine(finder: EdgeFinder<'_>, traces: &mut [Option<Trace<'_>>], round: u32) -> bool {
    let mut places = Vec::new();
    let mut half_lines = Vec::new();
    for (number, trace) in traces.iter_mut().enumerate() {
        let Some(trace) = trace else { continue };
        for i in trace.doubtful(round).into_iter().rev() {
            let (low, high) = (trace.found[i], trace.found[i + 1]);
            let radius = 2.0 / (low.1.radius.recip() + high.1.radius.recip());
            let angle = f64::midpoint(low.0, high.0);
            places.push((number, i + 1, angle));
            half_lines.push(trace.half_line(angle, Crossing { radius, ..low.1 }));
        }
    }
    let any = !half_lines.is_empty();
    let edges = finder.crossings(half_lines.into_iter());
    // From the last one of each on, so that places stay.
    for ((number, place, angle), edge) in places.into_iter().zip(edges) {
        match (&mut traces[number], edge) {
            (Some(trace), Some(edge)) => trace.found.insert(place, (angle, edge)),
            (trace, _) => *trace = None,
        }
    }
    any
}

/// Finds the corners of outlines whose half-lines are all traced.
fn find_corners(finder: EdgeFinder<'_>, traces: &mut [Option<Trace<'_>>]) {
    for trace in traces.iter_mut().flatten() {
        let differs = |&i: &usize| trace.found[i].1.limit != trace.found[i + 1].1.limit;
        trace.gaps = (0..trace.found.len() - 1).filter(differs).map(|i| (i, CORNER_STEPS)).collect();
    }
    loop {
        let wanted: Vec<Vec<(f64, Crossing)>> =
            traces.iter_mut().map(|trace| trace.as_mut().map_or_else(Vec::new, Trace::close_gaps)).collect();
        if wanted.iter().all(Vec::is_empty) {
            return;
        }
        let half_lines: Vec<HalfLine<'_>> = traces
            .iter()
            .zip(&wanted)
            .flat_map(|(trace, wanted)| {
                let along = |&(angle, guess): &(f64, Crossing)| Some(trace.as_ref()?.half_line(angle, guess));
                wanted.iter().filter_map(along)
            })
            .collect();
        let mut edges = finder.crossings(half_lines.into_iter()).into_iter();
        for (trace, wanted) in traces.iter_mut().zip(&wanted) {
            let edges: Vec<Option<Crossing>> = edges.by_ref().take(wanted.len()).collect();
            let found: Vec<(f64, Crossing)> =
                wanted.iter().zip(&edges).filter_map(|(&(angle, _), &edge)| Some((angle, edge?))).collect();
            if found.len() < wanted.len() {
                *trace = None;
            } else if let Some(trace) = trace {
                trace.take_in(&found);
            }
        }
    }
}

/// Finds the edge half way between a corner and what was found next to it, and in both halves where it was not expected
/// there: arcs may turn sharply beside a corner, and end there. An edge that is not found leaves the arc as it is.
fn look_beside_corners(finder: EdgeFinder<'_>, traces: &mut [Option<Trace<'_>>]) {
    let mut stretches: Vec<Vec<usize>> =
        traces.iter().map(|trace| trace.as_ref().map_or_else(Vec::new, Trace::beside_corners)).collect();
    for _ in 0..CORNER_LOOKS {
        let mut wanted = Vec::new();
        for (number, (trace, stretches)) in traces.iter().zip(&mut stretches).enumerate() {
            let Some(trace) = trace.as_ref().filter(|_| !stretches.is_empty()) else { continue };
            let (points, [first, _]) = trace.points();
            for i in stretches.drain(..) {
                let piece = piece(&points, first + i);
                let angle = f64::midpoint(piece.from, piece.to);
                let expected = Crossing { radius: piece.radius(angle), ..trace.found[i].1 };
                wanted.push((number, trace.half_line(angle, expected), angle));
            }
        }
        if wanted.is_empty() {
            return;
        }
        let edges = finder.crossings(wanted.iter().map(|&(_, half_line, _)| half_line));
        for ((number, HalfLine { guess: expected, .. }, angle), edge) in wanted.into_iter().zip(edges) {
            let (Some(trace), Some(edge)) = (&mut traces[number], edge) else { continue };
            let is_off = (edge.radius / expected.radius - 1.0).abs() > AS_EXPECTED;
            if is_off || edge.limit == expected.limit {
                let place = trace.found.partition_point(|found| found.0 < angle);
                trace.found.insert(place, (angle, edge));
                if is_off {
                    stretches[number].extend([place - 1, place]);
                }
            }
        }
    }
}
