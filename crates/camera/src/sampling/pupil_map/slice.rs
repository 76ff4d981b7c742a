//! The map of one pupil, which takes rows of the unit disk to rows of the pupil.

use std::f64::consts::FRAC_PI_2;

use super::{
    pencil::Pencil,
    search::{Window, row_ends},
};
use realistic_optics::lens::pupil::SlopeDisk;

/// Number of cells from the disk's middle row to its end. Doubling it halves the light missed at the corners
/// of pupils and makes building take half as long again.
pub const CELLS: usize = 32;
/// Number of rows, from the middle to an end, in the integration of a pupil's area below each height. With
/// more rows, more samples pass.
const AREA_ROWS: usize = 24;
/// Accuracy of the ends of rows, relative to the pupil's size. A coarser accuracy misses more light; a finer
/// one takes more rays.
const ACCURACY: f64 = 1e-5;
/// Relative margin of a map around the pupil that was found, for corners between knots. A larger margin
/// blocks more samples; a smaller margin misses more light.
const MARGIN: f64 = 1e-4;
/// Smallest slope of eta and smallest half width of a row, relative to the pupil's size. It keeps densities
/// finite; samples in a row without width are blocked.
const LEAST: f64 = 1e-4;

/// Height of the map of a vanished pupil, relative to that of the preceding node. It keeps densities finite.
const VANISHED: f64 = 1e-9;

/// Returns t at knot `k`, counted from the disk's middle row. Knots are dense toward the end, where rows
/// become shorter.
pub fn knot(k: usize) -> f64 {
    1.0 - (1.0 - k as f64 / CELLS as f64).powi(2)
}

/// Returns the knots from 0 to 1, or from -1 to 1.
fn knots(is_symmetric: bool) -> Vec<f64> {
    let upper = (0..=CELLS).map(knot);
    if is_symmetric { upper.collect() } else { (1..=CELLS).rev().map(|k| -knot(k)).chain(upper).collect() }
}

/// Returns the fraction of the half disk that lies between the disk's middle row and the row at t.
fn share(t: f64) -> f64 {
    (t * chord(t) + t.clamp(-1.0, 1.0).asin()) / FRAC_PI_2
}

/// Returns the row below which the fraction `share` of the half disk lies. This is the inverse of [`share`],
/// found by Newton's method for the angle of the row. Starting from the middle row, the steps go outward and
/// never overshoot, because rows become shorter outward.
fn row_at(share: f64) -> f64 {
    let mut angle = 0.0_f64;
    for _ in 0..16 {
        let (sin, cos) = angle.sin_cos();
        let missing = FRAC_PI_2 * share.abs() - (angle + sin * cos);
        angle += missing / (2.0 * cos * cos).max(f64::MIN_POSITIVE);
    }
    angle.min(FRAC_PI_2).sin().copysign(share)
}

/// Returns half the length of the row of the unit disk at t.
fn chord(t: f64) -> f64 {
    (1.0 - t * t).max(0.0).sqrt()
}

/// The map of the disk's rows, which is linear in t between knots and takes (X, t) to (m(t) + g(t) X,
/// eta(t)).
#[derive(Clone, Debug)]
pub struct Slice {
    /// t at the knots.
    pub t: Vec<f64>,
    pub eta: Vec<f64>,
    /// m, the middle of each row.
    pub middle: Vec<f64>,
    /// g, the half width of each row divided by that of the disk's row.
    pub half: Vec<f64>,
}

/// The parts of a pupil that a map leaves out.
#[derive(Clone, Debug)]
pub struct Outside {
    /// Distances by which the pupil extends beyond the two ends of the row at each knot.
    sides: Vec<[f64; 2]>,
    /// Factors by which the lower and the upper rows have to be stretched.
    ends: [f64; 2],
}

impl Slice {
    /// Finds the map of the pupil within a window. `None` if no row has a width.
    pub fn new(pencil: &impl Pencil, is_symmetric: bool, window: Window) -> Option<Self> {
        let Window { x, y: [bottom, top] } = window;
        let (t, size) = (knots(is_symmetric), (x[1] - x[0]).min(top - bottom));
        // Integrates the area below each height by strips: the ratio of a strip's width to the disk's is
        // taken from the row in the middle of the strip.
        let (middle, first) = if is_symmetric { (0.0, 0.0) } else { (f64::midpoint(bottom, top), -1.0) };
        let reach = top - middle;
        let strips = if is_symmetric { AREA_ROWS } else { 2 * AREA_ROWS };
        // The height of strips decreases toward the ends, where rows become shorter.
        let edge = |strip: f64| (FRAC_PI_2 * (first + (1.0 - first) * strip / strips as f64)).sin();
        let rows: Vec<f64> = (0..strips).map(|strip| edge(strip as f64 + 0.5)).collect();
        let heights: Vec<f64> = rows.iter().map(|row| middle + reach * row).collect();
        let found = row_ends(pencil, &heights, x, 10.0 * ACCURACY * size);
        let ratio = |(ends, &row): (&Option<[f64; 2]>, &f64)| ends.map_or(0.0, |[a, b]| (b - a) / chord(row));
        let ratios: Vec<f64> = found.iter().zip(&rows).map(ratio).collect();
        let shares: Vec<f64> = (0..=strips).map(|strip| share(edge(strip as f64))).collect();
        let mut below = vec![0.0];
        for (ratio, ends) in ratios.iter().zip(shares.windows(2)) {
            below.push(below[below.len() - 1] + ratio * (ends[1] - ends[0]));
        }
        let total = below[strips];
        if total <= 0.0 {
            return None;
        }
        let height = |&t: &f64| {
            let target = total * if is_symmetric { share(t) } else { f64::midpoint(1.0, share(t)) };
            let strip = below.partition_point(|&area| area < target).clamp(1, strips) - 1;
            let excess = (target - below[strip]) / ratios[strip].max(f64::MIN_POSITIVE);
            middle + reach * row_at((shares[strip] + excess).min(shares[strip + 1]))
        };
        let mut eta: Vec<f64> = t.iter().map(height).collect();
        let last = eta.len() - 1;
        (eta[0], eta[last]) = (bottom, top);
        for k in 1..last {
            let least = eta[k - 1] + LEAST * reach * (t[k] - t[k - 1]);
            eta[k] = eta[k].max(least);
        }
        // Moves back the knots that were pushed beyond the end.
        for k in (0..last).rev() {
            eta[k] = eta[k].min(eta[k + 1] - LEAST * reach * (t[k + 1] - t[k]));
        }
        if is_symmetric {
            eta[0] = 0.0;
        }
        let mut slice = Self { middle: vec![0.0; t.len()], half: vec![0.0; t.len()], t, eta };
        slice.fit_rows(pencil, is_symmetric, x, ACCURACY * size)?;
        slice.half.iter_mut().for_each(|half| *half *= 1.0 + MARGIN);
        slice.stretch([1.0 + MARGIN; 2]);
        Some(slice)
    }

    /// Fits rows to the light at the heights of the knots. A row without light is a copy of the preceding
    /// row.
    fn fit_rows(
        &mut self,
        pencil: &impl Pencil,
        is_symmetric: bool,
        x: [f64; 2],
        accuracy: f64,
    ) -> Option<()> {
        let (first, last) = (usize::from(!is_symmetric), self.t.len() - 1);
        let found = row_ends(pencil, &self.eta[first..last], x, accuracy);
        let mut before = found.iter().copied().flatten().next()?;
        for (k, ends) in (first..last).zip(found) {
            before = ends.unwrap_or(before);
            let [from, to] = before;
            (self.middle[k], self.half[k]) = (f64::midpoint(from, to), 0.5 * (to - from) / chord(self.t[k]));
        }
        // Rows at a tip are extrapolated from the adjacent rows.
        let most = self.half.iter().copied().fold(0.0, f64::max);
        for (tip, next) in [(0, 1), (last, last - 1)] {
            if tip == last || !is_symmetric {
                let after = if next == 1 { 2 } else { next - 1 };
                self.middle[tip] = 2.0 * self.middle[next] - self.middle[after];
                self.half[tip] = self.half[next];
            }
        }
        self.half.iter_mut().for_each(|half| *half = half.max(LEAST * most));
        Some(())
    }

    /// Returns the map to a disk.
    pub fn of_disk(disk: SlopeDisk, is_symmetric: bool) -> Self {
        let SlopeDisk { center: [x, y], radius } = disk;
        let t = knots(is_symmetric);
        let eta = t.iter().map(|t| y + radius * t).collect();
        Self { eta, middle: vec![x; t.len()], half: vec![radius; t.len()], t }
    }

    /// Returns the map to the smallest disk about the origin that contains the rows of this map.
    pub fn rounded(&self, is_symmetric: bool) -> Self {
        let reach = |k: usize| (self.middle[k].abs() + self.half[k] * chord(self.t[k])).hypot(self.eta[k]);
        let radius = (0..self.t.len()).map(reach).fold(0.0, f64::max);
        Self::of_disk(SlopeDisk { center: [0.0; 2], radius }, is_symmetric)
    }

    /// Returns the weighted sum of maps.
    pub fn mixed(parts: &[(f64, &Self)]) -> Self {
        let mix = |of: fn(&Self) -> &Vec<f64>| -> Vec<f64> {
            let at = |k: usize| parts.iter().map(|(part, slice)| part * of(slice)[k]).sum();
            (0..of(parts[0].1).len()).map(at).collect()
        };
        Self {
            t: parts[0].1.t.clone(),
            eta: mix(|slice| &slice.eta),
            middle: mix(|slice| &slice.middle),
            half: mix(|slice| &slice.half),
        }
    }

    /// Multiplies the widths of rows by a factor.
    pub fn widened(mut self, factor: f64) -> Self {
        self.half.iter_mut().for_each(|half| *half *= factor);
        self
    }

    /// Returns the map of a pupil that has shrunk to a point, with the widths of this map.
    pub fn vanishing(&self, [x, y]: [f64; 2]) -> Self {
        let size = VANISHED * (self.eta[self.t.len() - 1] - self.eta[0]);
        let y = if self.middle_row() == 0 { 0.0 } else { y };
        let eta = self.t.iter().map(|t| y + size * t).collect();
        Self { eta, middle: vec![x; self.t.len()], ..self.clone() }
    }

    /// Returns the longer side of the map's rectangle.
    pub fn size(&self) -> f64 {
        let Window { x, y } = self.window(false);
        (x[1] - x[0]).max(y[1] - y[0])
    }

    /// Returns the rectangle that contains the map.
    pub fn window(&self, is_symmetric: bool) -> Window {
        let ends =
            |side: f64| self.middle.iter().zip(&self.half).map(move |(middle, half)| middle + side * half);
        let x = [ends(-1.0).fold(f64::MAX, f64::min), ends(1.0).fold(f64::MIN, f64::max)];
        Window { x, y: [if is_symmetric { 0.0 } else { self.eta[0] }, self.eta[self.t.len() - 1]] }
    }

    /// Stretches the rows below and above the disk's middle row away from that row.
    fn stretch(&mut self, [lower, upper]: [f64; 2]) {
        let middle = self.eta[self.middle_row()];
        for (eta, t) in self.eta.iter_mut().zip(&self.t) {
            *eta = middle + (*eta - middle) * if *t < 0.0 { lower } else { upper };
        }
    }

    /// Returns the knot at t = 0.
    fn middle_row(&self) -> usize {
        self.t.len() - 1 - CELLS
    }

    /// Finds the parts of a pupil that the map leaves out; the pupil fills `window`.
    pub fn outside(&self, pencil: &impl Pencil, is_symmetric: bool, window: Window) -> Outside {
        let last = self.t.len() - 1;
        let size = (window.x[1] - window.x[0]).min(window.y[1] - window.y[0]);
        let found = row_ends(pencil, &self.eta, window.x, ACCURACY * size);
        let side = |(k, ends): (usize, Option<[f64; 2]>)| {
            let reach = self.half[k] * chord(self.t[k]);
            ends.map_or([0.0; 2], |[from, to]| {
                [self.middle[k] - reach - from, to - self.middle[k] - reach].map(|beyond| beyond.max(0.0))
            })
        };
        let middle = self.eta[self.middle_row()];
        let end = |found: f64, own: f64| {
            if own == middle { 1.0 } else { ((found - middle) / (own - middle)).max(1.0) }
        };
        let ends = [
            if is_symmetric { 1.0 } else { end(window.y[0], self.eta[0]) },
            end(window.y[1], self.eta[last]),
        ];
        Outside { sides: found.into_iter().enumerate().map(side).collect(), ends }
    }

    /// Extends the map so that it contains the parts in `outside`; the map's widths will later be multiplied
    /// by `taper`.
    pub fn take_in(&mut self, outside: &Outside, taper: f64) {
        let chords: Vec<f64> = self.t.iter().map(|&t| chord(t)).collect();
        for (k, [left, right]) in outside.sides.iter().enumerate().filter(|(k, _)| chords[*k] > 0.0) {
            self.middle[k] += 0.5 * (right - left);
            self.half[k] += 0.5 * (right + left) / (chords[k] * taper);
        }
        self.stretch(outside.ends);
    }

    /// Returns the image of a point of the disk in the plane.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let t = if self.middle_row() == 0 { y.abs() } else { y };
        let k = self.t.partition_point(|&knot| knot <= t).clamp(1, self.t.len() - 1);
        let part = (t - self.t[k - 1]) / (self.t[k] - self.t[k - 1]);
        let at = |numbers: &[f64]| numbers[k - 1] + part * (numbers[k] - numbers[k - 1]);
        let eta = at(&self.eta);
        [at(&self.middle) + at(&self.half) * x, if t == y { eta } else { -eta }]
    }

    /// Returns the distance of a point of the plane from the row at its height or, beyond a tip, from the row
    /// at that tip.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let y = if self.middle_row() == 0 { y.abs() } else { y };
        let last = self.t.len() - 1;
        let inside = y.clamp(self.eta[0], self.eta[last]);
        let k = self.eta.partition_point(|&eta| eta <= inside).clamp(1, last);
        let part = (inside - self.eta[k - 1]) / (self.eta[k] - self.eta[k - 1]);
        let at = |numbers: &[f64]| numbers[k - 1] + part * (numbers[k] - numbers[k - 1]);
        let beyond = (x - at(&self.middle)).abs() - at(&self.half) * chord(at(&self.t));
        beyond.max(0.0).hypot(y - inside)
    }

    /// Returns the distance of a point's preimage from the disk's centre; it is more than 1 for a point
    /// outside the map.
    pub fn radius(&self, [x, y]: [f64; 2]) -> f64 {
        let y = if self.middle_row() == 0 { y.abs() } else { y };
        // Rows beyond the ends are extrapolated.
        let k = self.eta.partition_point(|&eta| eta <= y).clamp(1, self.t.len() - 1);
        let part = (y - self.eta[k - 1]) / (self.eta[k] - self.eta[k - 1]);
        let at = |numbers: &[f64]| numbers[k - 1] + part.clamp(0.0, 1.0) * (numbers[k] - numbers[k - 1]);
        let t = self.t[k - 1] + part * (self.t[k] - self.t[k - 1]);
        ((x - at(&self.middle)) / at(&self.half)).hypot(t)
    }
}

impl Outside {
    /// Returns an empty set, for a map with `knots` knots.
    pub fn none(knots: usize) -> Self {
        Self { sides: vec![[0.0; 2]; knots], ends: [1.0; 2] }
    }

    /// Adds a point of the pupil that the map leaves out.
    pub fn add(&mut self, slice: &Slice, [x, y]: [f64; 2]) {
        let y = if slice.middle_row() == 0 { y.abs() } else { y };
        let (middle, last) = (slice.eta[slice.middle_row()], slice.t.len() - 1);
        for (end, tip) in self.ends.iter_mut().zip([slice.eta[0], slice.eta[last]]) {
            if tip != middle {
                *end = end.max((y - middle) / (tip - middle));
            }
        }
        let k = slice.eta.partition_point(|&eta| eta <= y).clamp(1, last);
        for k in [k - 1, k] {
            let (away, reach) = (x - slice.middle[k], slice.half[k] * chord(slice.t[k]));
            for (side, beyond) in self.sides[k].iter_mut().zip([-away - reach, away - reach]) {
                *side = side.max(beyond);
            }
        }
    }

    /// Replaces each part by the larger of the two.
    pub fn join(&mut self, other: &Self) {
        for (own, other) in self.sides.iter_mut().flatten().zip(other.sides.iter().flatten()) {
            *own = own.max(*other);
        }
        for (own, other) in self.ends.iter_mut().zip(other.ends) {
            *own = own.max(other);
        }
    }
}
