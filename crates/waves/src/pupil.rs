//! The rays of an object point that pass a lens, as nodes of a quadrature.
//!
//! The plane z = 0 is searched for points whose rays pass. They are bounded row by row, as in the pupil's map of the
//! camera: a row is one interval, or several where a lens has an obstruction. Each interval has the nodes of a
//! Gauss-Legendre rule, and so have the rows, over the angle θ for y = middle + half sin θ: the ends of the rows are then
//! smooth functions of θ, and the rule converges exponentially wherever the pupil's edge is smooth.

use std::f64::consts::FRAC_PI_2;

use crate::{object::ObjectPoint, quadrature::gauss_legendre};
use realistic_optics::lens::Lens;
use realistic_trace::kernel::{PathKernel, RayBuffer};

/// A ray behind the lens.
#[derive(Clone, Copy, Debug)]
pub struct Passed {
    /// The point on the last surface, image space, mm.
    pub origin: [f64; 3],
    /// Unit vector.
    pub direction: [f64; 3],
    /// Optical path to `origin`, mm.
    pub path: f64,
    /// Share of the light that a picture in the stop lets through.
    pub light: f64,
}

/// The rays of an object point through a lens.
pub struct Beam<'a> {
    pub kernel: &'a PathKernel,
    pub object: ObjectPoint,
}

impl Beam<'_> {
    /// Traces the rays through points of the plane z = 0; `None` for a blocked one.
    pub fn trace(&self, points: &[[f64; 2]]) -> Vec<Option<Passed>> {
        let mut found = Vec::with_capacity(points.len());
        for points in points.chunks(CHUNK) {
            let (mut rays, mut paths) = (RayBuffer::<f64>::new(points.len()), vec![0.0; points.len()]);
            for (i, &point) in points.iter().enumerate() {
                let ray = self.object.ray(point);
                rays.put(i, ray.origin, ray.direction);
            }
            self.kernel.trace_in_place(&mut rays.rays(), &mut paths);
            found.extend(paths.iter().enumerate().map(|(i, &path)| {
                let traced = rays.get(i)?;
                let ray = traced.ray();
                Some(Passed { origin: ray.origin, direction: ray.direction, path, light: traced.weight })
            }));
        }
        found
    }

    fn passes(&self, points: &[[f64; 2]]) -> Vec<bool> {
        self.trace(points).iter().map(Option::is_some).collect()
    }
}

/// Number of rays that are traced at a time.
const CHUNK: usize = 4096;
/// Number of cells along a side of a searched rectangle, and along a row.
const CELLS: usize = 96;
/// Least number of cells along a side of the rectangle that the pupil spans.
const SPANNED: usize = CELLS / 3;
/// Maximum number of times that the rectangle is narrowed.
const NARROWINGS: usize = 8;
/// Number of bisections, which leave an edge known to rounding.
const BISECTIONS: usize = 44;

/// A rectangle: the low and the high x, and those of y.
type Rectangle = [[f64; 2]; 2];

/// Returns nodes of the rays that pass, with their quadrature weights (areas of the plane z = 0, mm²), `across` in each of
/// `across` rows. `chief` is where the chief ray crosses the plane, if it is known. Empty if no ray is found that passes.
pub fn nodes(beam: &Beam<'_>, lens: &Lens, chief: Option<[f64; 2]>, across: usize) -> Vec<([f64; 2], f64)> {
    let Some(rectangle) = bounds(beam, lens, chief) else { return Vec::new() };
    let [xs, ys] = rectangle;
    let [bottom, top] = ends(beam, [xs, ys]);
    let (middle, half) = (f64::midpoint(bottom, top), (top - bottom) / 2.0);
    let rule = gauss_legendre(across);
    let rows: Vec<(f64, f64)> = (rule.iter())
        .map(|(part, weight)| {
            let angle = FRAC_PI_2 * part;
            (middle + half * angle.sin(), weight * FRAC_PI_2 * half * angle.cos())
        })
        .collect();
    let heights: Vec<f64> = rows.iter().map(|(y, _)| *y).collect();
    let mut nodes = Vec::with_capacity(across * across);
    for ((y, weight), intervals) in rows.iter().zip(intervals(beam, xs, &heights)) {
        for [low, high] in intervals {
            let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
            nodes
                .extend(rule.iter().map(|(part, share)| ([middle + half * part, *y], weight * share * half)));
        }
    }
    nodes
}

/// Returns a rectangle around the pupil that is not much larger.
fn bounds(beam: &Beam<'_>, lens: &Lens, chief: Option<[f64; 2]>) -> Option<Rectangle> {
    let front = lens.front();
    let mut all: Rectangle = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    // The rim of the first surface, wherever it lies along the axis.
    for z in front.sagitta_range() {
        for corner in 0..4 {
            let side =
                |bit: usize| if corner & bit == 0 { -front.semi_diameter } else { front.semi_diameter };
            let point = beam.object.seen_through([side(1), side(2), z]);
            for axis in 0..2 {
                all[axis] = [all[axis][0].min(point[axis]), all[axis][1].max(point[axis])];
            }
        }
    }
    // Around the chief ray, for a pupil smaller than the cells.
    let near = chief.map(|chief| {
        let size = (all[0][1] - all[0][0]).max(all[1][1] - all[1][0]) / CELLS as f64;
        chief.map(|part| [part - size, part + size])
    });
    let mut rectangle = [Some(all), near].into_iter().flatten().find_map(|tried| narrowed(beam, tried))?;
    for _ in 0..NARROWINGS {
        let before = rectangle;
        rectangle = narrowed(beam, before)?;
        let spans =
            |axis: usize| (rectangle[axis][1] - rectangle[axis][0]) / (before[axis][1] - before[axis][0]);
        if spans(0).min(spans(1)) > SPANNED as f64 / CELLS as f64 {
            break;
        }
    }
    Some(rectangle)
}

/// Returns the part of a rectangle that contains all of its cells whose rays pass, with one cell around them.
fn narrowed(beam: &Beam<'_>, rectangle: Rectangle) -> Option<Rectangle> {
    let at = |axis: usize, i: usize| {
        let [low, high] = rectangle[axis];
        low + (high - low) * (i as f64 + 0.5) / CELLS as f64
    };
    let points: Vec<[f64; 2]> = (0..CELLS * CELLS).map(|k| [at(0, k % CELLS), at(1, k / CELLS)]).collect();
    let mut range: [Option<[usize; 2]>; 2] = [None; 2];
    for (k, _) in beam.passes(&points).into_iter().enumerate().filter(|(_, passes)| *passes) {
        for (range, i) in range.iter_mut().zip([k % CELLS, k / CELLS]) {
            *range = Some(range.map_or([i, i], |[low, high]| [low.min(i), high.max(i)]));
        }
    }
    let mut narrow = rectangle;
    for axis in 0..2 {
        let [low, high] = range[axis]?;
        let cell = (rectangle[axis][1] - rectangle[axis][0]) / CELLS as f64;
        narrow[axis] = [at(axis, low) - 1.5 * cell, at(axis, high) + 1.5 * cell];
    }
    Some(narrow)
}

/// Returns points of a row.
fn row([low, high]: [f64; 2], y: f64) -> Vec<[f64; 2]> {
    (0..=CELLS).map(|i| [low + (high - low) * i as f64 / CELLS as f64, y]).collect()
}

/// Returns the lowest and the highest y of rows with rays that pass.
fn ends(beam: &Beam<'_>, [xs, [bottom, top]]: Rectangle) -> [f64; 2] {
    let is_lit = |y: f64| beam.passes(&row(xs, y)).contains(&true);
    let height = |i: usize| bottom + (top - bottom) * i as f64 / CELLS as f64;
    let lit: Vec<usize> = (0..=CELLS).filter(|&i| is_lit(height(i))).collect();
    let [first, last] = [lit.first(), lit.last()].map(|i| i.copied().unwrap_or(CELLS / 2));
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(inside, outside);
            if is_lit(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    [edge(height(first), height(first.saturating_sub(1))), edge(height(last), height((last + 1).min(CELLS)))]
}

/// Returns, for each row, the intervals of x in which rays pass.
fn intervals(beam: &Beam<'_>, xs: [f64; 2], heights: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let mut rows: Vec<Vec<[f64; 2]>> = heights.iter().map(|&y| row(xs, y)).collect();
    let mut lit: Vec<Vec<bool>> = rows.iter().map(|row| beam.passes(row)).collect();
    // A short row between the points is searched where its neighbour toward the middle passes.
    let middle = heights.len() / 2;
    let outward =
        (0..middle).rev().map(|i| (i, i + 1)).chain((middle + 1..heights.len()).map(|i| (i, i - 1)));
    for (own, other) in outward {
        if lit[own].contains(&true) {
            continue;
        }
        let passing: Vec<f64> = (rows[other].iter().zip(&lit[other]))
            .filter(|(_, passes)| **passes)
            .map(|(point, _)| point[0])
            .collect();
        if let (Some(low), Some(high)) = (passing.first(), passing.last()) {
            let step = rows[other][1][0] - rows[other][0][0];
            rows[own] = row([low - step, high + step], heights[own]);
            lit[own] = beam.passes(&rows[own]);
        }
    }
    // All edges are bisected together: a point that passes, and one that does not.
    let mut edges: Vec<(usize, [f64; 2])> = Vec::new();
    for (number, (row, lit)) in rows.iter().zip(&lit).enumerate() {
        for i in 1..row.len() {
            if lit[i] != lit[i - 1] {
                let [inside, outside] = if lit[i] { [i, i - 1] } else { [i - 1, i] };
                edges.push((number, [row[inside][0], row[outside][0]]));
            }
        }
    }
    for _ in 0..BISECTIONS {
        let middles: Vec<[f64; 2]> =
            edges.iter().map(|(row, [a, b])| [f64::midpoint(*a, *b), heights[*row]]).collect();
        for ((_, edge), (middle, passes)) in edges.iter_mut().zip(middles.iter().zip(beam.passes(&middles))) {
            edge[usize::from(!passes)] = middle[0];
        }
    }
    let mut found: Vec<Vec<f64>> = vec![Vec::new(); heights.len()];
    for (row, [inside, _]) in edges {
        found[row].push(inside);
    }
    // Rows are bounded by points that do not pass, so that edges come in pairs.
    found.into_iter().map(|edges| edges.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()).collect()
}
