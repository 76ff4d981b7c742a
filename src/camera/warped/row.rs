//! One film radius of the table: the map of the unit disk onto that pupil, which keeps area.

use std::f64::consts::PI;

use super::outline::{Outline, direction};

/// Knots between the lens direction along the film point's and the opposite one, less one.
pub(super) const CELLS: usize = 128;
/// Every so manieth knot's angle is traced.
pub(super) const TRACE_EVERY: usize = 4;

/// The disk's angle of a knot: pseudo-angles q = 1 - cos/(|cos| + sin) in equal steps from 0 to 2.
pub(super) fn knot_angle(knot: usize) -> f64 {
    let q = 2.0 * knot as f64 / CELLS as f64;
    let (cos, sin) = if q <= 1.0 { (1.0 - q, q) } else { (1.0 - q, 2.0 - q) };
    sin.atan2(cos)
}

/// The unit vectors of the knots' angles.
pub(super) fn knot_directions() -> Vec<[f64; 2]> {
    (0..=CELLS).map(|knot| direction(knot_angle(knot))).collect()
}

/// The map at one film radius h: d -> C + M(direction of d) d, as complex numbers.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Film radius, mm.
    pub height: f64,
    /// C/h, 1/mm: the pupil's centre lies at the slope c h along the film point's direction.
    pub center: f64,
    /// M at the knots.
    pub factors: Vec<[f64; 2]>,
    /// Area of the pupil, in slope².
    pub area: f64,
    /// Whether the pupil fills the map; else the map only covers it.
    pub fitted: bool,
}

impl Row {
    /// A whole disk of slopes.
    pub fn disk(height: f64, center: f64, radius: f64, fitted: bool) -> Self {
        Self { height, center, factors: vec![[radius, 0.0]; CELLS + 1], area: PI * radius * radius, fitted }
    }

    /// The map onto an outline that takes equal areas of the disk to equal areas.
    pub fn fit(height: f64, outline: &Outline) -> Self {
        let mut cursor = 0;
        // dA = radius²/2 d(angle), by Simpson's rule over each stretch.
        let mut pieces = Vec::new();
        let mut total = 0.0;
        for (from, to) in outline.stretches() {
            let middle = f64::midpoint(from, to);
            let density = [from, middle, to].map(|angle| {
                let inside = angle.clamp(from + 1e-12 * (to - from), to - 1e-12 * (to - from));
                outline.radius(inside, &mut cursor).powi(2) / 2.0
            });
            let area = (to - from) * (density[0] + 4.0 * density[1] + density[2]) / 6.0;
            pieces.push(Piece { from, to, density, before: total, area });
            total += area;
        }
        let mut piece = 0;
        cursor = 0;
        let mut angles = Vec::with_capacity(CELLS + 1);
        let factors: &mut Vec<[f64; 2]> = &mut Vec::with_capacity(CELLS + 1);
        for knot in 0..=CELLS {
            let phi = knot_angle(knot);
            let target = total * phi / PI;
            while piece + 1 < pieces.len() && target > pieces[piece].before + pieces[piece].area {
                piece += 1;
            }
            let angle = match knot {
                0 => 0.0,
                CELLS => PI,
                _ => pieces[piece].angle(target),
            };
            let radius = outline.radius(angle, &mut cursor);
            let [cos, sin] = direction(angle - phi);
            factors.push([radius * cos, radius * sin]);
            angles.push(angle);
        }
        let mut row = Self {
            height,
            center: outline.center / height,
            factors: std::mem::take(factors),
            area: 2.0 * total,
            fitted: true,
        };
        row.reach_corners(outline, &angles);
        row
    }

    /// Between two knots the map runs nearly straight and would cut a corner off: moves both knots
    /// out until it no longer does.
    fn reach_corners(&mut self, outline: &Outline, angles: &[f64]) {
        for &(corner, radius) in &outline.corners {
            let knot = angles.partition_point(|&angle| angle <= corner).clamp(1, CELLS) - 1;
            let [a, b] = [knot, knot + 1].map(|k| {
                let r = self.factors[k][0].hypot(self.factors[k][1]);
                let [x, y] = direction(angles[k]);
                [r * x, r * y]
            });
            // Where the chord from a to b crosses the corner's direction.
            let d = direction(corner);
            let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
            let chord = cross(a, b) / cross([b[0] - a[0], b[1] - a[1]], d).abs();
            let growth = radius / chord;
            if growth > 1.0 && growth < 1.5 {
                for k in [knot, knot + 1] {
                    self.factors[k] = self.factors[k].map(|x| x * growth);
                }
            }
        }
    }

    /// The outline's point at a knot, about the row's centre.
    pub fn point(&self, knot: usize, direction: [f64; 2]) -> [f64; 2] {
        let ([re, im], [cos, sin]) = (self.factors[knot], direction);
        [re * cos - im * sin, re * sin + im * cos]
    }

    /// The row that the table's interpolation makes half way between two.
    pub fn between(&self, other: &Self, height: f64) -> Self {
        let mean = |a: f64, b: f64| f64::midpoint(a, b);
        Self {
            height,
            center: mean(self.center, other.center),
            factors: self
                .factors
                .iter()
                .zip(&other.factors)
                .map(|(a, b)| [mean(a[0], b[0]), mean(a[1], b[1])])
                .collect(),
            area: mean(self.area, other.area),
            fitted: self.fitted && other.fitted,
        }
    }

    /// Shares of the outline's area that this row's shape misses, and that it has too much.
    pub fn misfit(&self, outline: &Outline, directions: &[[f64; 2]]) -> (f64, f64) {
        let (mut missed, mut excess) = (0.0, 0.0);
        let shift = self.center * self.height - outline.center;
        let mut cursor = 0;
        for knot in 0..=CELLS {
            let [x, y] = self.point(knot, directions[knot]);
            let x = x + shift;
            let edge = outline.radius(y.max(0.0).atan2(x), &mut cursor);
            let difference = 1.0 - (x * x + y * y) / (edge * edge);
            let share = if knot == 0 || knot == CELLS { 0.5 } else { 1.0 } / CELLS as f64;
            missed += share * difference.max(0.0);
            excess += share * (-difference).max(0.0);
        }
        (missed, excess)
    }
}

/// A stretch of the outline with its share of area.
struct Piece {
    from: f64,
    to: f64,
    /// radius²/2 at both ends and in the middle.
    density: [f64; 3],
    before: f64,
    area: f64,
}

impl Piece {
    /// The angle up to which the outline encloses `target`.
    fn angle(&self, target: f64) -> f64 {
        let [a, m, b] = self.density;
        let width = self.to - self.from;
        let wanted = (target - self.before) / width;
        // The density as a parabola, a + p x + q x², x in [0, 1].
        let (p, q) = (4.0 * m - 3.0 * a - b, 2.0 * a + 2.0 * b - 4.0 * m);
        let mut x = ((target - self.before) / self.area).clamp(0.0, 1.0);
        for _ in 0..3 {
            let area = x * (a + x * (p / 2.0 + x * q / 3.0));
            x = (x - (area - wanted) / (a + x * (p + x * q))).clamp(0.0, 1.0);
        }
        self.from + width * x
    }
}
