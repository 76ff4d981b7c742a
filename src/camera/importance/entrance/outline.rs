//! The outline of the rays that get from one spot of the scene to the film, found by tracing: along half-lines from a point
//! inside, the farthest ray that gets through. An outline nearby says where to look first.

use super::{
    super::fan::{Fan, SECTOR, SECTORS},
    detail::{Detail, WIDEST},
    fit::fit_bent,
    probe::{Place, Probe},
    spot::Spot,
};

/// Where rays are tried first along a half-line of which an outline nearby foretells the end, over that; and, last, as far as
/// the half-line goes.
const NEARBY: [f64; 10] = [0.0, 0.6, 0.85, 0.95, 1.0, 1.05, 1.15, 1.4, 2.0, f64::INFINITY];
/// Halvings that narrow an end down from there.
const NEARBY_HALVINGS: usize = 7;
/// The least that is foretold, over how far the half-line goes.
const LEAST: f64 = 0.02;
/// The grid over the front aperture, rays across, in which a first ray through is looked for, and then.
const GRIDS: [usize; 2] = [24, 80];
/// The same over an outline nearby, and how far it goes beyond that, over its half widths.
const GRID_NEARBY: usize = 16;
const AROUND_NEARBY: f64 = 1.5;
/// Columns in which an outline's height is looked for, over its half width.
const COLUMNS: [f64; 5] = [-0.7, -0.35, 0.0, 0.35, 0.7];
/// Points along a half-line within an outline, over how far that reaches.
const WITHIN: [f64; 3] = [0.0, 0.4, 0.75];
/// How far from the centre an outline may reach, over its half widths.
const FARTHEST: f64 = 4.0;

/// The rays of a spot that get through.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    pub fan: Fan,
    /// Points of the edge, and where their rays reach the film.
    pub edge: Vec<Place>,
    /// The same of points within, and of the edge.
    pub within: Vec<Place>,
}

impl Detail {
    /// Rays that a table takes at most.
    pub(super) fn rays_at_most(&self) -> u64 {
        // Also to the stop.
        let outline = |around: usize, first: usize| {
            let ends = 2 + COLUMNS.len() + around + 1;
            let [within, edge] = [(around / 2 + 1) * WITHIN.len(), around + 1];
            2 + first + ends * (NEARBY.len() + NEARBY_HALVINGS) + 2 * within + edge
        };
        let beside = GRID_NEARBY * GRID_NEARBY / 2;
        let anywhere: usize = GRIDS.iter().map(|across| across * across / 2).sum();
        let chief = (WIDEST / self.stride) as usize * outline(self.rough, beside);
        let (rows, nodes) = (self.rows + 1, self.nodes + 1);
        let looks = rows * (outline(self.rough, anywhere) + self.looks * outline(self.rough, beside));
        let tabulated = rows * nodes * outline(self.around, beside);
        let halfway = (rows * self.nodes + nodes * self.rows) * outline(self.between, beside);
        (chief + looks + tabulated + halfway + 2 * self.rounds * self.rays) as u64
    }
}

impl Probe<'_> {
    /// A point of the first axis inside the outline, or the middle of what gets through where that has none there.
    fn inside(
        &self,
        spot: &Spot,
        [from, to, up]: [f64; 3],
        hints: &[f64],
        nearby: Option<&Fan>,
    ) -> Option<f64> {
        let places: Vec<[f64; 2]> = hints.iter().map(|hint| [*hint, 0.0]).collect();
        let landed = self.land(spot, &places);
        if let Some((hint, _)) = hints.iter().zip(landed).find(|(_, landed)| landed.is_some()) {
            return Some(*hint);
        }
        match nearby {
            Some(Fan { extent, .. }) => {
                let [wide, high] = extent.map(|extent| AROUND_NEARBY * extent);
                let middle = hints.first()?;
                let part = [(middle - wide).max(from), (middle + wide).min(to), high.min(up)];
                self.inside_grid(spot, part, GRID_NEARBY)
            }
            None => GRIDS.into_iter().find_map(|across| self.inside_grid(spot, [from, to, up], across)),
        }
    }

    /// The same by a grid over a part of the plane.
    fn inside_grid(&self, spot: &Spot, [from, to, up]: [f64; 3], across: usize) -> Option<f64> {
        let points: Vec<[f64; 2]> = (0..across / 2)
            .flat_map(|j| (0..across).map(move |i| (i, j)))
            .map(|(i, j)| {
                let part = (i as f64 + 0.5) / across as f64;
                [from + (to - from) * part, 2.0 * up * j as f64 / across as f64]
            })
            .collect();
        let landed = self.land(spot, &points);
        let through: Vec<[f64; 2]> = points
            .iter()
            .zip(landed)
            .filter(|(_, landed)| landed.is_some())
            .map(|(point, _)| *point)
            .collect();
        let lowest = through.iter().map(|point| point[1]).reduce(f64::min)?;
        let row: Vec<f64> = through.iter().filter(|point| point[1] == lowest).map(|point| point[0]).collect();
        let mean = row.iter().sum::<f64>() / row.len() as f64;
        row.into_iter().min_by(|a, b| (a - mean).abs().total_cmp(&(b - mean).abs()))
    }

    /// Along half-lines, the farthest rays that get through: how far, and where they reach the film. `None` where none does.
    fn farthest(&self, spot: &Spot, half_lines: &[HalfLine]) -> Vec<Option<(f64, [f64; 2])>> {
        let Detail { places, halvings, .. } = self.detail();
        let is_foretold = half_lines.iter().all(|line| line.foretold.is_some());
        let (count, halvings) =
            if is_foretold { (NEARBY.len(), NEARBY_HALVINGS) } else { (places + 1, halvings) };
        let first = |line: &HalfLine, i: usize| match line.foretold {
            Some(end) => (NEARBY[i] * end.max(LEAST * line.most)).min(line.most),
            None => line.most * i as f64 / places as f64,
        };
        let points: Vec<[f64; 2]> =
            half_lines.iter().flat_map(|line| (0..count).map(|i| line.at(first(line, i)))).collect();
        let landed = self.land(spot, &points);
        let mut brackets: Vec<Option<(f64, f64, [f64; 2])>> = half_lines
            .iter()
            .zip(landed.chunks_exact(count))
            .map(|(line, landed)| {
                let last = landed.iter().rposition(Option::is_some)?;
                let beyond = if last + 1 < count { first(line, last + 1) } else { 1.05 * line.most };
                Some((first(line, last), beyond, landed[last]?))
            })
            .collect();
        for _ in 0..halvings {
            let open = brackets.iter().zip(half_lines).filter_map(|(bracket, line)| {
                bracket.map(|(low, high, _)| line.at(f64::midpoint(low, high)))
            });
            let points: Vec<[f64; 2]> = open.collect();
            let landed = self.land(spot, &points);
            for ((low, high, at), landed) in brackets.iter_mut().flatten().zip(landed) {
                let middle = f64::midpoint(*low, *high);
                match landed {
                    Some(point) => (*low, *at) = (middle, point),
                    None => *high = middle,
                }
            }
        }
        // The outer end: rays get through up to somewhere between.
        brackets.into_iter().map(|bracket| bracket.map(|(_, high, at)| (high, at))).collect()
    }

    /// The outline of a spot by so many half-lines; `hints` are points of the first axis that may lie inside, and `nearby` is
    /// an outline like it. `None` where no ray gets through; with an outline nearby, none near the first hint.
    pub(super) fn outline(
        &self,
        spot: &Spot,
        around: usize,
        hints: &[f64],
        nearby: Option<&Fan>,
    ) -> Option<Outline> {
        let front @ [from, to, up] = self.front(spot);
        let start = self.inside(spot, front, hints, nearby)?;
        let aside = |toward: f64, most: f64| HalfLine {
            start: [start, 0.0],
            step: [toward, 0.0],
            most: most.max(0.0),
            foretold: nearby.map(|fan| fan.extent[0]),
        };
        let ends = self.farthest(spot, &[aside(1.0, to - start), aside(-1.0, start - from)]);
        let end = |i: usize| ends[i].map_or(0.0, |(far, _)| far);
        let (left, right) = (start - end(1), start + end(0));
        let width = (right - left) / 2.0;
        let center = f64::midpoint(left, right);
        let columns = COLUMNS.map(|at| HalfLine {
            start: [center + at * width, 0.0],
            step: [0.0, 1.0],
            most: up,
            foretold: nearby.map(|fan| fan.extent[1]),
        });
        let heights = self.farthest(spot, &columns);
        let height = heights.iter().flatten().map(|(far, _)| *far).fold(0.0, f64::max);
        if !(width > 0.0 && height > 0.0) {
            return None;
        }
        let extent = [width, height];
        let half_lines: Vec<HalfLine> = (0..=around)
            .map(|i| {
                let part = i as f64 / around as f64;
                let (sin, cos) = (std::f64::consts::PI * part).sin_cos();
                let step = [extent[0] * cos, extent[1] * sin];
                let toward = if cos > 0.0 { to - center } else { center - from };
                let most = (toward / step[0].abs()).min(up / step[1].abs()).clamp(0.0, FARTHEST);
                let foretold = nearby.map(|fan| between(&fan.reach, part));
                HalfLine { start: [center, 0.0], step, most, foretold }
            })
            .collect();
        let found = self.farthest(spot, &half_lines);
        let edge: Vec<Place> = half_lines
            .iter()
            .zip(&found)
            .filter_map(|(line, found)| found.map(|(far, at)| (line.at(far), at)))
            .collect();
        let reach: Vec<f64> = found.iter().map(|found| found.map_or(0.0, |(far, _)| far)).collect();
        let fan = Fan { center, extent, reach: corners(&reach) };
        let inner: Vec<[f64; 2]> = half_lines
            .iter()
            .zip(&reach)
            .step_by(2)
            .flat_map(|(line, reach)| WITHIN.map(|part| line.at(part * reach)))
            .collect();
        let landed = self.land(spot, &inner);
        let mut within: Vec<Place> =
            inner.into_iter().zip(landed).filter_map(|(point, landed)| Some((point, landed?))).collect();
        within.extend(&edge);
        Some(Outline { fan, edge, within })
    }
}

impl Outline {
    /// The least distance from the axis at which its rays reach the film, mm, and no more.
    pub fn nearest(&self) -> f64 {
        /// What the half-lines from the middle may be apart there, over how far they reach.
        const APART: f64 = 0.2;
        let place = fit_bent(&self.fan, &self.within, 0.0).place;
        let (mut least, mut longest) = (f64::INFINITY, 0.0_f64);
        for (_, [x, y]) in &self.edge {
            let (dx, dy) = (x - place, *y);
            let square = dx * dx + dy * dy;
            let part = if square > 0.0 { (-place * dx / square).clamp(0.0, 1.0) } else { 0.0 };
            least = least.min((place + part * dx).hypot(part * dy));
            longest = longest.max(square.sqrt());
        }
        (least - APART * longest).max(0.0)
    }
}

/// A half-line of the plane.
#[derive(Clone, Copy)]
struct HalfLine {
    start: [f64; 2],
    step: [f64; 2],
    most: f64,
    /// Where an outline nearby ends.
    foretold: Option<f64>,
}

impl HalfLine {
    fn at(&self, far: f64) -> [f64; 2] {
        [self.start[0] + far * self.step[0], self.start[1] + far * self.step[1]]
    }
}

/// A number at a part of the way from the first of some to the last.
fn between(numbers: &[f64], part: f64) -> f64 {
    let last = numbers.len() - 1;
    let at = part * last as f64;
    let (low, part) = (at as usize, at.fract());
    numbers[low] + part * (numbers[(low + 1).min(last)] - numbers[low])
}

/// The corners of the polygon that holds an edge found along evenly spread half-lines.
fn corners(found: &[f64]) -> [f64; SECTORS + 1] {
    /// What arcs between two half-lines bulge by, relative.
    const BULGE: f64 = 1.0008;
    let per_sector = found.len() / SECTORS;
    let own = |knot: usize| between(found, knot as f64 / SECTORS as f64);
    let mut reach: [f64; SECTORS + 1] = std::array::from_fn(own);
    if per_sector == 2 {
        for sector in 0..SECTORS {
            let [r, s] = [own(sector), own(sector + 1)];
            let chord = 2.0 * r * s * (SECTOR / 2.0).cos() / (r + s);
            let growth = if r + s > 0.0 { found[2 * sector + 1] / chord } else { 1.0 };
            if growth > 1.0 && growth.is_finite() {
                reach[sector] = reach[sector].max(r * growth);
                reach[sector + 1] = reach[sector + 1].max(s * growth);
            }
        }
    }
    // A sector must not be empty between two that are not.
    let least = 1e-3 * reach.iter().copied().fold(0.0, f64::max);
    reach.map(|reach| reach.max(least) * BULGE)
}
