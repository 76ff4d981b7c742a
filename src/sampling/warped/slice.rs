//! One radial slice of the table: the map of the unit disk onto the pupil of one film radius, which keeps area. An
//! outline in; the map's complex factors at the knots, and how well the mean of two neighbours would have done, out.

use std::f64::consts::PI;

use super::{
    outline::{Outline, Piece, direction},
    view::View,
};

/// Knots between the lens direction along the film point's and the opposite one, less one.
pub(crate) const CELLS: usize = 128;
/// The edge is traced at every knot whose number is a multiple of this.
pub(crate) const TRACE_EVERY: usize = 8;

/// How much larger than the outline the map is made, relative, for what interpolation leaves out.
const MARGIN: f64 = 6e-4;
/// Where the pupil has shrunk below this part of the one on the axis the margin grows as the
/// pupil's width shrinks: slices lie too far apart there, and little light is lost by rejections.
const VANISHING: f64 = 0.002;

/// The disk's directions at the knots: pseudo-angles q = 1 - cos/(|cos| + sin) in equal steps from
/// 0 to 2.
pub(crate) struct Knots {
    pub angles: Vec<f64>,
    pub directions: Vec<[f64; 2]>,
}

impl Knots {
    pub fn new() -> Self {
        let angle = |knot: usize| {
            let q = 2.0 * knot as f64 / CELLS as f64;
            (if q <= 1.0 { q } else { 2.0 - q }).atan2(1.0 - q)
        };
        let angles: Vec<f64> = (0..=CELLS).map(angle).collect();
        Self { directions: angles.iter().map(|&angle| direction(angle)).collect(), angles }
    }
}

/// The map at one film radius h: d -> C + M(direction of d) d, as complex numbers.
#[derive(Clone, Debug)]
pub(crate) struct Slice {
    /// Film radius, mm.
    pub height: f64,
    /// C/h, 1/mm: the pupil's centre lies at the slope c h along the film point's direction.
    pub center: f64,
    /// (1 - τ)/h², 1/mm²: in the film point's direction the map is narrowed to τ of its size.
    pub narrowing: f64,
    /// M at the knots.
    pub factors: Vec<[f64; 2]>,
    /// Area of the pupil, in slope².
    pub area: f64,
    /// Corners of its outline.
    pub corners: usize,
    /// How much larger than the pupil the map is, relative.
    pub margin: f64,
    /// Whether the pupil fills the map; else the map only covers it.
    pub fitted: bool,
}

impl Slice {
    /// A whole disk of slopes.
    pub fn disk(height: f64, center: f64, radius: f64, fitted: bool) -> Self {
        Self {
            height,
            center,
            narrowing: 0.0,
            factors: vec![[radius, 0.0]; CELLS + 1],
            area: PI * radius * radius,
            corners: 0,
            margin: 0.0,
            fitted,
        }
    }

    /// The map onto an outline that takes equal areas of the disk to equal areas, narrowed to the outline's width over
    /// its height where that lies between `least` and 1. The pupil on the axis has `axis_area`.
    pub fn fit(view: &View<'_>, outline: &Outline, knots: &Knots, axis_area: f64, least: f64) -> Self {
        let mut sectors = Vec::with_capacity(outline.pieces.len());
        let mut total = 0.0;
        for &piece in &outline.pieces {
            let sector = Sector::new(piece, total);
            total += sector.area;
            sectors.push(sector);
        }
        let area = 2.0 * view.width_scale * total;
        let margin = MARGIN * (VANISHING * axis_area / area).sqrt().clamp(1.0, MARGIN.recip());
        let mut number = 0;
        let mut radii = Vec::with_capacity(CELLS + 1);
        let mut angles = Vec::with_capacity(CELLS + 1);
        for (knot, &phi) in knots.angles.iter().enumerate() {
            let target = total * phi / PI;
            while number + 1 < sectors.len() && target > sectors[number].before + sectors[number].area {
                number += 1;
            }
            let angle = match knot {
                0 => 0.0,
                CELLS => PI,
                _ => sectors[number].angle(target),
            };
            radii.push(sectors[number].piece.radius(angle));
            angles.push(angle);
        }
        reach_corners(outline, &angles, &mut radii);
        let points = angles.iter().zip(&radii).map(|(&angle, radius)| direction(angle).map(|x| x * radius));
        let points: Vec<[f64; 2]> = points.collect();
        let highest = points.iter().fold(f64::MIN_POSITIVE, |most, point| most.max(point[1]));
        let width = (view.width_scale * points[0][0] / highest).clamp(least, 1.0);
        let scale = [view.width_scale / width * (1.0 + margin), 1.0 + margin];
        let factor = |([x, y], [cos, sin]): (&[f64; 2], &[f64; 2])| {
            let [x, y] = [x * scale[0], y * scale[1]];
            [x * cos + y * sin, y * cos - x * sin]
        };
        let height = view.height;
        Self {
            height,
            center: view.width_scale * outline.center / height,
            narrowing: (1.0 - width) / (height * height),
            factors: points.iter().zip(&knots.directions).map(factor).collect(),
            area,
            corners: outline.corners.len(),
            margin,
            fitted: true,
        }
    }

    /// τ.
    pub fn width_scale(&self) -> f64 {
        1.0 - self.narrowing * self.height * self.height
    }

    /// The outline's point at a knot, about the slice's centre; x in units of τ.
    pub fn point(&self, knot: usize, direction: [f64; 2]) -> [f64; 2] {
        let ([re, im], [cos, sin]) = (self.factors[knot], direction);
        [re * cos - im * sin, re * sin + im * cos]
    }

    /// The slice that the table's interpolation makes half way between two.
    pub fn between(&self, other: &Self, height: f64) -> Self {
        let mean = |a: f64, b: f64| f64::midpoint(a, b);
        let part = (height - self.height) / (other.height - self.height);
        Self {
            height,
            center: self.center + part * (other.center - self.center),
            narrowing: mean(self.narrowing, other.narrowing),
            factors: self
                .factors
                .iter()
                .zip(&other.factors)
                .map(|(a, b)| [mean(a[0], b[0]), mean(a[1], b[1])])
                .collect(),
            area: mean(self.area, other.area),
            corners: self.corners.max(other.corners),
            margin: mean(self.margin, other.margin),
            fitted: self.fitted && other.fitted,
        }
    }

    /// Shares of the outline's area that this slice would miss, and that it would have too much, had it
    /// `part` of the difference that `shape` has from it. The outline's x counts in units of the shape's τ.
    pub fn misfit(&self, shape: &Self, outline: &Outline, knots: &Knots, part: f64) -> (f64, f64) {
        let (mut missed, mut excess) = (0.0, 0.0);
        let shift = shape.center * shape.height / shape.width_scale() - outline.center;
        let mut cursor = 0;
        for (knot, &direction) in knots.directions.iter().enumerate() {
            let [x, y] = shape.point(knot, direction);
            let x = x + shift;
            let edge = (1.0 + self.margin) * outline.radius(y.max(0.0).atan2(x), &mut cursor);
            let difference = part * (1.0 - (x * x + y * y) / (edge * edge)) - 2.0 * self.margin;
            let share = if knot == 0 || knot == CELLS { 0.5 } else { 1.0 } / CELLS as f64;
            missed += share * difference.max(0.0);
            excess += share * (-difference).max(0.0);
        }
        (missed, excess)
    }
}

/// Between two knots the map runs nearly straight and would cut a corner off: moves both knots out
/// until it no longer does.
fn reach_corners(outline: &Outline, angles: &[f64], radii: &mut [f64]) {
    for &(corner, radius) in &outline.corners {
        let knot = angles.partition_point(|&angle| angle <= corner).clamp(1, CELLS) - 1;
        let ([a, b], [r, s]) = ([angles[knot], angles[knot + 1]], [radii[knot], radii[knot + 1]]);
        // Where the chord crosses the corner's direction, by the areas of triangles.
        let chord = r * s * (b - a).sin() / (r * (corner - a).sin() + s * (b - corner).sin());
        let growth = radius / chord;
        if growth > 1.0 {
            radii[knot] *= growth;
            radii[knot + 1] *= growth;
        }
    }
}

/// A piece of the outline with what it encloses.
struct Sector {
    piece: Piece,
    /// radius²/2 at both ends and in the middle.
    density: [f64; 3],
    /// Area up to its beginning, and its own.
    before: f64,
    area: f64,
}

impl Sector {
    /// dA = radius²/2 d(angle), by Simpson's rule.
    fn new(piece: Piece, before: f64) -> Self {
        let Piece { from, to, .. } = piece;
        let density = [from, f64::midpoint(from, to), to].map(|angle| piece.radius(angle).powi(2) / 2.0);
        let area = (to - from) * (density[0] + 4.0 * density[1] + density[2]) / 6.0;
        Self { piece, density, before, area }
    }

    /// The angle up to which the outline encloses `target`.
    fn angle(&self, target: f64) -> f64 {
        let [a, m, b] = self.density;
        let width = self.piece.to - self.piece.from;
        let wanted = (target - self.before) / width;
        // The density as a parabola, a + p x + q x², x in [0, 1].
        let (p, q) = (4.0 * m - 3.0 * a - b, 2.0 * a + 2.0 * b - 4.0 * m);
        let mut x = ((target - self.before) / self.area).clamp(0.0, 1.0);
        for _ in 0..2 {
            let area = x * (a + x * (p / 2.0 + x * q / 3.0));
            x = (x - (area - wanted) / (a + x * (p + x * q))).clamp(0.0, 1.0);
        }
        self.piece.from + width * x
    }
}
