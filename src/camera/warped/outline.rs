//! The outline of one film point's pupil: points of its edge about a centre, joined by smooth arcs, one
//! a limiting aperture, that meet in corners found exactly.

use std::f64::consts::PI;

use super::view::{Crossing, Limit, View};

/// A point of the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Angle about the centre from the sx axis, in [0, π] (beyond by mirrored points).
    pub angle: f64,
    /// 1/distance from the centre: a straight edge or a conic about its focus is a pure
    /// sinusoid in it.
    pub inverse: f64,
    limit: Limit,
}

/// The half of a pupil's outline with sy >= 0.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// sx of the centre: the middle of the pupil's chord on the meridian.
    pub center: f64,
    /// By angle; the ends are mirrored at 0 and π for the sake of interpolation. A corner stands
    /// twice, as the end of each of its arcs.
    points: Vec<Point>,
    /// Of the points, the one at angle 0 and the one at π.
    first: usize,
    last: usize,
    /// Where arcs meet: angle and distance from the centre.
    pub corners: Vec<(f64, f64)>,
}

/// Where to look for an outline.
pub(super) struct Guess<'a> {
    /// sx of a point that lies inside.
    pub inside: f64,
    /// Angles at which the outline is to be traced, from 0 to π, and the distance expected there.
    pub points: &'a [(f64, f64)],
}

/// Interval of angles in which a corner is pinned down before the arcs are simply extended to meet.
const CORNER_BRACKET: f64 = 2e-3;
/// Searches a corner may cost.
const CORNER_STEPS: u32 = 8;

impl Outline {
    /// Traces the outline of the pupil that `view` sees. `None` where a half-line has no edge.
    pub fn trace(view: &View<'_>, guess: &Guess<'_>) -> Option<Self> {
        let &(_, right) = guess.points.first()?;
        let &(_, left) = guess.points.last()?;
        let start = |radius| Crossing { radius, limit: Limit::Optics, steepness: 1.0 };
        let right = view.crossing(guess.inside, [1.0, 0.0], start(right))?;
        let left = view.crossing(guess.inside, [-1.0, 0.0], start(left))?;
        let center = guess.inside + (right.radius - left.radius) / 2.0;
        let half = f64::midpoint(right.radius, left.radius);
        let ends = [Crossing { radius: half, ..right }, Crossing { radius: half, ..left }];
        let inner = &guess.points[1..guess.points.len() - 1];
        let mut found = vec![(0.0, ends[0])];
        let mut previous = (guess.points[0].1, ends[0]);
        for &(angle, expected) in inner {
            // What the expectation was off by at the neighbour it is likely off by here.
            let radius = expected * previous.1.radius / previous.0;
            let hint = Crossing { radius, ..previous.1 };
            let crossing = view.crossing(center, direction(angle), hint)?;
            previous = (expected, crossing);
            found.push((angle, crossing));
        }
        found.push((PI, ends[1]));
        let mut outline = Self { center, points: Vec::new(), first: 0, last: 0, corners: Vec::new() };
        outline.mirror_start(&found);
        for pair in found.windows(2) {
            outline.push(pair[0]);
            if pair[0].1.limit != pair[1].1.limit {
                // Points ahead, for extending the arc that begins there.
                let ahead: Vec<_> = found.iter().filter(|p| p.0 >= pair[1].0).take(3).copied().collect();
                outline.find_corner(view, pair[0], &ahead, CORNER_STEPS)?;
            }
        }
        outline.push(found[found.len() - 1]);
        outline.last = outline.points.len() - 1;
        outline.mirror_end();
        Some(outline)
    }

    fn push(&mut self, (angle, crossing): (f64, Crossing)) {
        self.points.push(Point { angle, inverse: crossing.radius.recip(), limit: crossing.limit });
    }

    fn mirror_start(&mut self, found: &[(f64, Crossing)]) {
        let limit = found[0].1.limit;
        let arc = found[1..].iter().take(2).take_while(|p| p.1.limit == limit);
        let mirrored: Vec<_> = arc.map(|&(angle, crossing)| (-angle, crossing)).collect();
        mirrored.into_iter().rev().for_each(|point| self.push(point));
        self.first = self.points.len();
    }

    fn mirror_end(&mut self) {
        let limit = self.points[self.last].limit;
        let mirrored: Vec<_> = self.points[..self.last]
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
    fn find_corner(
        &mut self,
        view: &View<'_>,
        from: (f64, Crossing),
        ahead: &[(f64, Crossing)],
        steps: u32,
    ) -> Option<()> {
        let to = ahead[0];
        let begun: Vec<Point> =
            self.points.iter().rev().take(3).take_while(|p| p.limit == from.1.limit).copied().collect();
        let coming: Vec<Point> = ahead
            .iter()
            .take_while(|p| p.1.limit == to.1.limit)
            .map(|&(angle, c)| Point { angle, inverse: c.radius.recip(), limit: c.limit })
            .collect();
        let gap = |angle: f64| extend(&begun, angle) - extend(&coming, angle);
        let (low, high) = (from.0, to.0);
        let crosses = gap(low) * gap(high) < 0.0;
        let meeting =
            if crosses { crate::numeric::root(low, high, gap) } else { f64::midpoint(low, high) };
        if steps == 0 || high - low < CORNER_BRACKET {
            let radius = f64::midpoint(extend(&begun, meeting), extend(&coming, meeting)).recip();
            self.corners.push((meeting, radius));
            self.push((meeting, Crossing { radius, ..from.1 }));
            self.push((meeting, Crossing { radius, ..to.1 }));
            return Some(());
        }
        // Off the meeting by a little, on the longer side, so that the bracket closes from both.
        let margin = 0.3 * CORNER_BRACKET;
        let angle = if crosses {
            let aim = if meeting - low > high - meeting { meeting - margin } else { meeting + margin };
            aim.clamp(low + 0.1 * (high - low), high - 0.1 * (high - low))
        } else {
            meeting
        };
        let hint = Crossing { radius: extend(&begun, angle).max(extend(&coming, angle)).recip(), ..from.1 };
        let crossing = view.crossing(self.center, direction(angle), hint)?;
        let middle = (angle, crossing);
        if crossing.limit == from.1.limit {
            self.push(middle);
            self.find_corner(view, middle, ahead, steps - 1)
        } else {
            let mut nearer = vec![middle];
            nearer.extend(ahead.iter().take(2).filter(|p| p.1.limit == crossing.limit));
            self.find_corner(view, from, &nearer, steps - 1)?;
            self.push(middle);
            if crossing.limit == to.1.limit { Some(()) } else { self.find_corner(view, middle, ahead, steps - 1) }
        }
    }

    /// Distance of the edge from the centre at `angle` in [0, π]. `cursor` is where the last
    /// search ended: angles that grow cost no search.
    pub fn radius(&self, angle: f64, cursor: &mut usize) -> f64 {
        let mut i = (*cursor).clamp(self.first, self.last - 1);
        while i > self.first && angle < self.points[i].angle {
            i -= 1;
        }
        while i + 1 < self.last && angle >= self.points[i + 1].angle {
            i += 1;
        }
        *cursor = i;
        // Four points of the same arc about the angle, or as many as there are.
        let belongs = |j: usize| {
            let limit = self.points[i + 1].limit;
            self.points[j].limit == limit
        };
        let (mut low, mut high) = (i, i + 1);
        if low > 0 && belongs(low - 1) && belongs(low) {
            low -= 1;
        }
        if high + 1 < self.points.len() && belongs(high + 1) {
            high += 1;
        }
        if high - low < 3 && low > 0 && belongs(low - 1) && belongs(low) {
            low -= 1;
        }
        if high - low < 3 && high + 1 < self.points.len() && belongs(high + 1) {
            high += 1;
        }
        extend(&self.points[low..=high], angle).recip()
    }

    /// The stretches between neighbouring points, as pairs of angles; none is empty.
    pub fn stretches(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.points[self.first..=self.last]
            .windows(2)
            .map(|pair| (pair[0].angle, pair[1].angle))
            .filter(|(from, to)| to > from)
    }
}

/// Unit vector of an angle.
pub(super) fn direction(angle: f64) -> [f64; 2] {
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
