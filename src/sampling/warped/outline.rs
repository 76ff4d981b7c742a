//! The outline of one film point's pupil: points of its edge about a centre, joined by smooth arcs, one
//! a limiting aperture, that meet in corners found exactly.

use std::f64::consts::PI;

use super::{
    illinois::{Closing, illinois},
    search::{Crossing, EdgeFinder},
    view::Limit,
};

/// A point of the outline.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Angle about the centre from the sx axis, in [0, π] (beyond by mirrored points).
    angle: f64,
    /// 1/distance from the centre: a straight edge or a conic about its focus is a pure
    /// sinusoid in it.
    inverse: f64,
    limit: Limit,
}

/// The points of an outline while it is traced.
struct Trace<'a> {
    finder: EdgeFinder<'a>,
    center: f64,
    /// By angle; the ends are mirrored at 0 and π for the sake of interpolation. A corner stands
    /// twice, as the end of each of its arcs.
    points: Vec<Point>,
    corners: Vec<(f64, f64)>,
}

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

/// A stretch of an arc: 1/distance as a cubic in the angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub from: f64,
    pub to: f64,
    /// In powers of the angle less `from`.
    cubic: [f64; 4],
}

impl Piece {
    /// Distance of the edge from the centre.
    pub fn radius(&self, angle: f64) -> f64 {
        let t = angle - self.from;
        let [a, b, c, d] = self.cubic;
        (a + t * (b + t * (c + t * d))).recip()
    }
}

/// Where to look for an outline.
pub(crate) struct Guess<'a> {
    /// sx of a point that lies inside.
    pub inside: f64,
    /// Angles at which the outline is to be traced, from 0 to π, and the distance expected there.
    pub points: &'a [(f64, f64)],
}

/// Interval of angles in which a corner is pinned down before the arcs are simply extended to meet.
const CORNER_BRACKET: f64 = 4e-2;
/// Where a search for where two arcs meet ends: about as near as a corner has to be known.
const MEETING: Closing = Closing::Step { width: 1e-6, most: 30 };
/// Searches a corner may cost.
const CORNER_STEPS: u32 = 8;

impl Outline {
    /// Traces the outline of the pupil that `finder` searches. `None` where a half-line has no edge.
    pub fn trace(finder: EdgeFinder<'_>, guess: &Guess<'_>) -> Option<Self> {
        let &(_, right) = guess.points.first()?;
        let &(_, left) = guess.points.last()?;
        let start = |radius| Crossing { radius, limit: Limit::Optics, steepness: 1.0 };
        let both = [([1.0, 0.0], start(right)), ([-1.0, 0.0], start(left))];
        let [right, left] = finder.crossings(guess.inside, both.into_iter())?[..] else { return None };
        let center = guess.inside + (right.radius - left.radius) / 2.0;
        let half = f64::midpoint(right.radius, left.radius);
        let found = trace_between(
            finder,
            center,
            guess.points,
            [right, left].map(|c| Crossing { radius: half, ..c }),
        )?;
        let mut trace = Trace { finder, center, points: Vec::with_capacity(64), corners: Vec::new() };
        trace.mirror_start(&found);
        let first = trace.points.len();
        for (i, pair) in found.windows(2).enumerate() {
            trace.push(pair[0]);
            if pair[0].1.limit != pair[1].1.limit {
                let ahead = &found[i + 1..found.len().min(i + 4)];
                trace.find_corner(pair[0], ahead, CORNER_STEPS)?;
            }
        }
        trace.push(found[found.len() - 1]);
        let last = trace.points.len() - 1;
        trace.mirror_end();
        let piece = |i: usize| (trace.points[i].angle < trace.points[i + 1].angle).then(|| trace.piece(i));
        let pieces = (first..last).filter_map(piece).collect();
        Some(Self { center, pieces, corners: trace.corners })
    }

    /// Distance of the edge from the centre at `angle` in [0, π]. `cursor` is where the last
    /// search ended: angles that grow cost no search.
    pub fn radius(&self, angle: f64, cursor: &mut usize) -> f64 {
        while *cursor > 0 && angle < self.pieces[*cursor].from {
            *cursor -= 1;
        }
        while *cursor + 1 < self.pieces.len() && angle > self.pieces[*cursor].to {
            *cursor += 1;
        }
        self.pieces[*cursor].radius(angle)
    }
}

impl Trace<'_> {
    fn push(&mut self, (angle, crossing): (f64, Crossing)) {
        self.points.push(Point { angle, inverse: crossing.radius.recip(), limit: crossing.limit });
    }

    fn mirror_start(&mut self, found: &[(f64, Crossing)]) {
        let limit = found[0].1.limit;
        let arc = found[1..].iter().take(2).take_while(|p| p.1.limit == limit);
        let mirrored: Vec<_> = arc.map(|&(angle, crossing)| (-angle, crossing)).collect();
        mirrored.into_iter().rev().for_each(|point| self.push(point));
    }

    fn mirror_end(&mut self) {
        let Some((last, arc)) = self.points.split_last() else { return };
        let limit = last.limit;
        let mirrored: Vec<_> = arc
            .iter()
            .rev()
            .take(2)
            .take_while(|point| point.limit == limit)
            .map(|point| Point { angle: 2.0 * PI - point.angle, ..*point })
            .collect();
        self.points.extend(mirrored);
    }

    /// Adds what lies between the last point, `from`, and the first of `ahead`, whose limit is
    /// another.
    fn find_corner(&mut self, from: (f64, Crossing), ahead: &[(f64, Crossing)], steps: u32) -> Option<()> {
        let to = ahead[0];
        let begun: Vec<Point> =
            self.points.iter().rev().take(3).take_while(|p| p.limit == from.1.limit).copied().collect();
        let coming: Vec<Point> = ahead
            .iter()
            .take(3)
            .take_while(|p| p.1.limit == to.1.limit)
            .map(|&(angle, c)| Point { angle, inverse: c.radius.recip(), limit: c.limit })
            .collect();
        let gap = |angle: f64| extend(&begun, angle) - extend(&coming, angle);
        let (low, high) = (from.0, to.0);
        let width = high - low;
        let crosses = gap(low) * gap(high) < 0.0;
        let meeting = if crosses { illinois(low, high, MEETING, gap) } else { f64::midpoint(low, high) };
        if steps == 0 || width < CORNER_BRACKET {
            let radius = f64::midpoint(extend(&begun, meeting), extend(&coming, meeting)).recip();
            self.corners.push((meeting, radius));
            self.push((meeting, Crossing { radius, ..from.1 }));
            self.push((meeting, Crossing { radius, ..to.1 }));
            return Some(());
        }
        // On both sides of where the arcs are expected to meet.
        let margin = if crosses { 0.45 * CORNER_BRACKET } else { width / 6.0 };
        let angles = [
            (meeting - margin).clamp(low + 0.1 * width, high - 0.3 * width),
            (meeting + margin).clamp(low + 0.3 * width, high - 0.1 * width),
        ];
        let hint = |angle: f64| {
            let radius = extend(&begun, angle).max(extend(&coming, angle)).recip();
            (direction(angle), Crossing { radius, ..if angle < meeting { from.1 } else { to.1 } })
        };
        let crossings = self.finder.crossings(self.center, angles.into_iter().map(hint))?;
        let mut places = vec![from];
        places.extend(angles.into_iter().zip(crossings));
        places.extend_from_slice(ahead);
        for i in 0..angles.len() + 1 {
            if i > 0 {
                self.push(places[i]);
            }
            if places[i].1.limit != places[i + 1].1.limit {
                self.find_corner(places[i], &places[i + 1..], steps - 1)?;
            }
        }
        Some(())
    }

    /// The arc between the points `i` and `i + 1`, through four of its points or as many as there are.
    fn piece(&self, i: usize) -> Piece {
        let (from, to) = (self.points[i].angle, self.points[i + 1].angle);
        let belongs = |point: &&Point| point.limit == self.points[i].limit;
        // Points much closer to one another than the stretch is long would multiply their errors.
        let apart = 0.25 * (to - from);
        let spaced = |start: f64| {
            let mut last = start;
            move |point: &&Point| {
                let far = (point.angle - last).abs() >= apart;
                if far {
                    last = point.angle;
                }
                far
            }
        };
        let below: Vec<&Point> =
            self.points[..i].iter().rev().take_while(belongs).filter(spaced(from)).take(2).collect();
        let above: Vec<&Point> =
            self.points[i + 2..].iter().take_while(belongs).filter(spaced(to)).take(2).collect();
        // One on each side where the arc goes on to both, else two on the one.
        let (low, high) = (below.len().min(2 - above.len().min(1)), above.len().min(2 - below.len().min(1)));
        let stencil = [&self.points[i], &self.points[i + 1]];
        let stencil =
            stencil.into_iter().chain(below[..low].iter().copied()).chain(above[..high].iter().copied());
        // Newton's divided differences, then their products multiplied out about `from`.
        let mut node = [0.0; 4];
        let mut difference = [0.0; 4];
        let mut count = 0;
        for point in stencil {
            (node[count], difference[count]) = (point.angle - from, point.inverse);
            count += 1;
        }
        for order in 1..count {
            for k in (order..count).rev() {
                difference[k] = (difference[k] - difference[k - 1]) / (node[k] - node[k - order]);
            }
        }
        let mut cubic = [difference[3], 0.0, 0.0, 0.0];
        for k in (0..3).rev() {
            cubic = [
                difference[k] - node[k] * cubic[0],
                cubic[0] - node[k] * cubic[1],
                cubic[1] - node[k] * cubic[2],
                cubic[2] - node[k] * cubic[3],
            ];
        }
        Piece { from, to, cubic }
    }
}

/// The half-lines of an outline, at the angles of `expected`, between the `ends`, which are known. Every fourth first;
/// what the expectation is off by there it is likely off by between them.
fn trace_between(
    finder: EdgeFinder<'_>,
    center: f64,
    expected: &[(f64, f64)],
    ends: [Crossing; 2],
) -> Option<Vec<(f64, Crossing)>> {
    let last = expected.len() - 1;
    let mut found: Vec<Option<Crossing>> = vec![None; expected.len()];
    (found[0], found[last]) = (Some(ends[0]), Some(ends[1]));
    let mut stride = last;
    for step in [4, 2, 1] {
        let places: Vec<usize> = (step..last).step_by(step).filter(|&i| found[i].is_none()).collect();
        let hint = |&i: &usize| {
            let before = i - i % stride;
            let after = (before + stride).min(last);
            let known = [before, after].map(|k| found[k].map(|edge| (edge, edge.radius / expected[k].1)));
            let [Some((low, low_ratio)), Some((high, high_ratio))] = known else {
                return (direction(expected[i].0), ends[0]);
            };
            let part = (i - before) as f64 / (after - before) as f64;
            let radius = expected[i].1 * (low_ratio + part * (high_ratio - low_ratio));
            let nearer = if part <= 0.5 { low } else { high };
            let steepness = if low.limit == high.limit {
                low.steepness + part * (high.steepness - low.steepness)
            } else {
                nearer.steepness
            };
            (direction(expected[i].0), Crossing { radius, steepness, ..nearer })
        };
        let half_lines: Vec<_> = places.iter().map(hint).collect();
        let edges = finder.crossings(center, half_lines.into_iter())?;
        for (place, edge) in places.into_iter().zip(edges) {
            found[place] = Some(edge);
        }
        stride = step;
    }
    expected.iter().zip(found).map(|(&(angle, _), edge)| Some((angle, edge?))).collect()
}

/// Unit vector of an angle.
pub(crate) fn direction(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}

/// Lagrange's polynomial through the points, for 1/radius.
fn extend(points: &[Point], angle: f64) -> f64 {
    let mut sum = 0.0;
    for (i, own) in points.iter().enumerate() {
        let mut term = own.inverse;
        for (j, other) in points.iter().enumerate() {
            if i != j {
                term *= (angle - other.angle) / (own.angle - other.angle);
            }
        }
        sum += term;
    }
    sum
}
