//! The outline of one pencil's pupil: where half-lines from its middle, at equal angles in a frame that makes the pupil about
//! round, leave it.

use std::{f64::consts::PI, sync::LazyLock};

use super::{
    search::{Edge, Search, edges},
    view::{Excess, Pencil},
};

/// Half-lines from one side of the plane of symmetry to the other, less one: more take more rays, fewer cut more off corners.
pub(crate) const HALF_LINES: usize = 72;
/// Looks along a row of which the middle does not get through, and within how many half widths of it.
const LOOKS: usize = 32;
const AROUND: f64 = 4.0;

/// How a pencil's rays are named: those of the point (u, v) have x = center + width u + bow y², y = height v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub center: f64,
    pub width: f64,
    pub height: f64,
    pub bow: f64,
}

impl Frame {
    pub fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let y = self.height * v;
        [self.center + self.width * u + self.bow * y * y, y]
    }
}

/// The first row's edges, x at y = 0, about a guess; `None` where nothing gets through nearby.
pub(crate) fn first_row(pencil: &impl Pencil, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
    let passes =
        |points: &[[f64; 2]]| -> Vec<bool> { pencil.excesses(points).iter().map(Excess::passes).collect() };
    if passes(&[[middle, 0.0]])[0] {
        let hint = Edge::at(half);
        let sides = edges(pencil, vec![Search::new(hint), Search::new(hint)], |side, radius| {
            [middle + [-radius, radius][side], 0.0]
        });
        return Some([middle - sides[0]?.radius, middle + sides[1]?.radius]);
    }
    row_in(pencil, 0.0, [middle - AROUND * half, middle + AROUND * half], LOOKS)
}

/// The edges of what gets through nearest to the middle of a stretch of a row, by looks all along it.
pub(crate) fn row_in(pencil: &impl Pencil, y: f64, [low, high]: [f64; 2], looks: usize) -> Option<[f64; 2]> {
    let at = |k: usize| low + (high - low) * (k as f64 + 0.5) / looks as f64;
    let points: Vec<[f64; 2]> = (0..looks).map(|k| [at(k), y]).collect();
    let passes: Vec<bool> = pencil.excesses(&points).iter().map(Excess::passes).collect();
    let from_middle = |k: &usize| (2 * k + 1).abs_diff(looks);
    let nearest = (0..looks).filter(|&k| passes[k]).min_by_key(from_middle)?;
    let first = (0..nearest).rev().take_while(|&k| passes[k]).last().unwrap_or(nearest);
    let last = (nearest..looks).take_while(|&k| passes[k]).last().unwrap_or(nearest);
    let step = (high - low) / looks as f64;
    let searches = vec![Search::between(0.0, step), Search::between(0.0, step)];
    let sides = edges(pencil, searches, |side, radius| [[at(first) - radius, at(last) + radius][side], y]);
    Some([at(first) - sides[0]?.radius, at(last) + sides[1]?.radius])
}

/// An outline, symmetric in v.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub frame: Frame,
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
        Self { frame, edges: vec![Edge::at(1.0); HALF_LINES + 1] }
    }

    /// The outline of a pencil, whose first row is known, from one that is expected; `None` where a half-line has no edge.
    pub fn trace(pencil: &impl Pencil, row: [f64; 2], expected: &Self) -> Option<Self> {
        let frame =
            Frame { center: f64::midpoint(row[0], row[1]), width: (row[1] - row[0]) / 2.0, ..expected.frame };
        let searches = expected.edges.iter().map(|&edge| Search::new(edge)).collect();
        let found = edges(pencil, searches, |k, radius| frame.point(direction(k).map(|part| radius * part)));
        let edges = found.into_iter().collect::<Option<Vec<Edge>>>()?;
        Some(Self { frame, edges })
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

    /// The frame that fits it: as high as it is, and with the bow that takes the parabola out of its middle,
    /// b = ∫∫ x y² dA / ∫∫ y⁴ dA. Both integrals are taken along the edge.
    pub fn fitting(&self) -> Frame {
        let frame = self.frame;
        let points: Vec<[f64; 2]> = self.points().collect();
        let highest = points.iter().fold(0.0_f64, |most, point| most.max(point[1]));
        let (mut products, mut fourths) = (0.0, 0.0);
        for pair in points.windows(2) {
            let step = pair[1][1] - pair[0][1];
            for [u, v] in [pair[0], pair[1]] {
                products += step * u * u * v * v / 4.0;
                fourths += step * u * v * v * v * v / 2.0;
            }
        }
        let more = frame.width / (frame.height * frame.height) * products / fourths;
        let bow = frame.bow + if more.is_finite() { more } else { 0.0 };
        Frame { height: frame.height * highest, bow, ..frame }
    }

    /// The one expected where the polynomial through some leads, each of which counts by its weight. Heights go by what is left
    /// of them over what pupils shrink by, `shrunk` at each and here.
    pub fn expected(known: &[(&Self, f64, f64)], shrunk: f64) -> Self {
        let last = known[known.len() - 1].0;
        let fitting: Vec<Frame> = known.iter().map(|(outline, ..)| outline.fitting()).collect();
        // Not below half of the last nor above twice that.
        let on = |numbers: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut newest) = (0.0, 0.0);
            for (number, (_, weight, _)) in numbers.zip(known) {
                (sum, newest) = (sum + weight * number, number);
            }
            sum.clamp(0.5 * newest, 2.0 * newest)
        };
        let heights = fitting.iter().zip(known).map(|(frame, (.., shrunk))| frame.height / shrunk);
        let frame = Frame {
            height: shrunk * on(&mut heights.into_iter()),
            bow: fitting.iter().zip(known).map(|(frame, (_, weight, _))| weight * frame.bow).sum(),
            ..last.frame
        };
        let scales: Vec<f64> = known
            .iter()
            .zip(&fitting)
            .map(|((outline, ..), fitting)| outline.frame.height / fitting.height)
            .collect();
        let edge = |k: usize| {
            let [cos, sin] = direction(k);
            let radius = |(outline, scale): (&Self, &f64)| {
                outline.edges[k].radius * (cos * cos + scale * scale * sin * sin).sqrt()
            };
            let mut radii = known.iter().map(|(outline, ..)| *outline).zip(&scales).map(radius);
            Edge { radius: on(&mut radii), ..last.edges[k] }
        };
        Self { frame, edges: (0..=HALF_LINES).map(edge).collect() }
    }

    /// The edge's distance from the middle in a direction of the frame, from 0 to π.
    pub fn radius(&self, angle: f64) -> f64 {
        let place = angle / PI * HALF_LINES as f64;
        let k = (place as usize).min(HALF_LINES - 1);
        let [near, far] = [0, 1].map(|next| self.edges[k + next].radius);
        near + (place - k as f64) * (far - near)
    }

    /// Moves the edge out where something else begins to limit it: by how far it lies outside the line from neighbour to
    /// neighbour, which is as far at least as a corner beside it does between the half-lines.
    pub fn hold_corners(&mut self) {
        let at = |k: isize| &self.edges[k.unsigned_abs().min(2 * HALF_LINES - k.unsigned_abs())];
        let widened = (0..=HALF_LINES as isize).map(|k| {
            let [before, own, after] = [k - 1, k, k + 1].map(at);
            let more = own.radius - f64::midpoint(before.radius, after.radius);
            let is_corner = before.limit != own.limit || own.limit != after.limit;
            own.radius + if is_corner { more.max(0.0) } else { 0.0 }
        });
        let widened: Vec<f64> = widened.collect();
        for (edge, radius) in self.edges.iter_mut().zip(widened) {
            edge.radius = radius;
        }
    }
}

/// Area between two half-lines, the distance going straight in the angle from one to the other.
pub(crate) fn sector(from: f64, to: f64) -> f64 {
    PI / HALF_LINES as f64 * (from * from + from * to + to * to) / 6.0
}
