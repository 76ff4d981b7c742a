//! One radial slice of the table: the map of the unit disk onto the pupil of one film radius, which keeps area. An
//! outline in; the map's complex factors at the knots, and how well the mean of two neighbours would have done, out.

mod knots;
mod places;

pub(crate) use knots::{CELLS, Knots, TRACE_EVERY};
pub(crate) use places::Places;

use std::f64::consts::PI;

use self::knots::KNOTS;
use super::{outline::Outline, view::View};

/// How much larger than the outline the map is made, relative, for what interpolation leaves out.
const MARGIN: f64 = 6e-4;
/// Where the pupil has shrunk below this part of the one on the axis the margin grows as its width shrinks, for slices lie
/// too far apart there; at most so many times, and no more than this over √(1 - h²/H²), where it vanishes at H.
const SHRUNK: f64 = 0.002;
const VANISHING: f64 = 0.25;
const MOST_MARGIN: f64 = 7.0;

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
            factors: vec![[radius, 0.0]; KNOTS],
            area: PI * radius * radius,
            corners: 0,
            margin: 0.0,
            fitted,
        }
    }

    /// The map onto an outline that takes equal areas of the disk to equal areas, narrowed to the outline's width over
    /// its height where that is below 1; and where on the outline the knots lie. Where the pupil vanishes at H,
    /// `crescent` is √(1 - h²/H²), else 1. The pupil on the axis has `axis_area`.
    pub fn fit(
        view: &View<'_>,
        outline: &Outline,
        knots: &Knots,
        crescent: f64,
        axis_area: f64,
    ) -> (Self, Box<Places>) {
        let (places, total) = Places::of_equal_areas(outline, knots);
        let area = 2.0 * view.width_scale * total;
        let growth = (SHRUNK * axis_area / area).sqrt().min(VANISHING / crescent);
        let margin = MARGIN * growth.clamp(1.0, MOST_MARGIN);
        // Where the pupil vanishes that is about its width over its height. Half of it keeps τ above 0 between the slices,
        // too; where it does not vanish nothing is narrowed.
        let least = if crescent < 1.0 { crescent / 2.0 } else { 1.0 };
        let mut radii = places.radius;
        reach_corners(outline, &places, &mut radii);
        let points: Vec<[f64; 2]> =
            (0..KNOTS).map(|knot| places.direction(knot).map(|x| x * radii[knot])).collect();
        let highest = points.iter().fold(f64::MIN_POSITIVE, |most, point| most.max(point[1]));
        let width = (view.width_scale * points[0][0] / highest).clamp(least, 1.0);
        let scale = [view.width_scale / width * (1.0 + margin), 1.0 + margin];
        let factor = |([x, y], [cos, sin]): (&[f64; 2], &[f64; 2])| {
            let [x, y] = [x * scale[0], y * scale[1]];
            [x * cos + y * sin, y * cos - x * sin]
        };
        let height = view.height;
        let slice = Self {
            height,
            center: view.width_scale * outline.center / height,
            narrowing: (1.0 - width) / (height * height),
            factors: points.iter().zip(&knots.directions).map(factor).collect(),
            area,
            corners: outline.corners.len(),
            margin,
            fitted: true,
        };
        (slice, places)
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

    /// The slice that the table's interpolation makes at `part` of the way from this to another.
    pub fn toward(&self, other: &Self, part: f64, height: f64) -> Self {
        let at = |a: f64, b: f64| a + part * (b - a);
        Self {
            height,
            // Straight in h, not in s.
            center: self.center
                + (height - self.height) / (other.height - self.height) * (other.center - self.center),
            narrowing: at(self.narrowing, other.narrowing),
            factors: self
                .factors
                .iter()
                .zip(&other.factors)
                .map(|(a, b)| [at(a[0], b[0]), at(a[1], b[1])])
                .collect(),
            area: at(self.area, other.area),
            corners: self.corners.max(other.corners),
            margin: at(self.margin, other.margin),
            fitted: self.fitted && other.fitted,
        }
    }

    /// Shares of the outline's area that this slice would miss, and that it would have too much, had it
    /// `part` of the difference that `shape` has from it. The outline's x counts in units of the shape's τ; its knots
    /// lie at `places`.
    pub fn misfit(
        &self,
        shape: &Self,
        outline: &Outline,
        places: &Places,
        knots: &Knots,
        part: f64,
    ) -> (f64, f64) {
        let (mut missed, mut excess) = (0.0, 0.0);
        for (knot, ratio) in self.ratios(shape, outline, places, knots).into_iter().enumerate() {
            let difference = part * (1.0 - ratio * ratio) - 2.0 * self.margin;
            let share = if knot == 0 || knot == CELLS { 0.5 } else { 1.0 } / CELLS as f64;
            missed += share * difference.max(0.0);
            excess += share * (-difference).max(0.0);
        }
        (missed, excess)
    }

    /// At each knot how much larger `shape` has to be made, relative, to hold the outline, had it `part` of the difference;
    /// and the share of it that then lies outside. As in [`Slice::misfit`].
    pub fn growth(
        &self,
        shape: &Self,
        outline: &Outline,
        places: &Places,
        knots: &Knots,
        part: f64,
    ) -> (Vec<f64>, f64) {
        let ratios = self.ratios(shape, outline, places, knots);
        let needed: Vec<f64> =
            ratios.iter().map(|ratio| (part * (ratio.recip() - 1.0) - self.margin).max(0.0)).collect();
        // The neighbours, too: the shape is known at the knots only.
        let around = |knot: usize| &needed[knot.saturating_sub(1)..(knot + 2).min(needed.len())];
        let growth: Vec<f64> =
            (0..needed.len()).map(|knot| around(knot).iter().copied().fold(0.0, f64::max)).collect();
        let outside = growth.iter().zip(&ratios).map(|(growth, ratio)| {
            let reached = (1.0 + growth + self.margin) * (1.0 + part * (ratio - 1.0));
            (1.0 - reached.powi(-2)).max(0.0)
        });
        let outside = outside.sum::<f64>() / growth.len() as f64;
        (growth, outside)
    }

    /// At each knot the distance of `shape` from the outline's centre over that of the outline, made larger by the margin.
    fn ratios(&self, shape: &Self, outline: &Outline, places: &Places, knots: &Knots) -> [f64; KNOTS] {
        let shift = shape.center * shape.height / shape.width_scale() - outline.center;
        let mut points = [[0.0; KNOTS]; 2];
        for (knot, &direction) in knots.directions.iter().enumerate() {
            let [x, y] = shape.point(knot, direction);
            (points[0][knot], points[1][knot]) = (x + shift, y);
        }
        let mut polar = points;
        places.polar(&mut polar);
        let [angles, mut distances] = polar;
        let per_margin = (1.0 + self.margin).recip();
        let mut cursor = 0;
        for (knot, distance) in distances.iter_mut().enumerate() {
            let angle = angles[knot];
            let angle = if angle.is_nan() { points[1][knot].max(0.0).atan2(points[0][knot]) } else { angle };
            *distance *= per_margin * outline.inverse(angle, &mut cursor);
        }
        distances
    }

    /// Makes the map larger at the knots, relative.
    pub fn grow(&mut self, growth: &[f64]) {
        for (factor, growth) in self.factors.iter_mut().zip(growth) {
            *factor = factor.map(|x| x * (1.0 + growth));
        }
    }
}

/// Between two knots the map runs nearly straight and would cut a corner off: moves both knots out
/// until it no longer does.
fn reach_corners(outline: &Outline, places: &Places, radii: &mut [f64]) {
    let angles = &places.angle;
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
