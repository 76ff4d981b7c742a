//! The outline of the rays that get from one spot of the scene to the film, found by tracing: along half-lines from a point
//! inside, the farthest ray that gets through.

use super::{
    super::fan::{Fan, Image, LEAST_BEND, MOST_BEND, SECTOR, SECTORS},
    spot::Spot,
};
use crate::{
    numeric::minimum,
    trace::kernel::{Kernel, RayBuffer},
};

/// Half-lines of an outline traced in full: two a sector.
const FULL: usize = 2 * SECTORS;
/// Half-lines of one that is only looked for.
const COARSE: usize = 8;
/// Places along a half-line where rays are tried first.
const PLACES: usize = 16;
/// Halvings that narrow the edge down from there.
const HALVINGS: u32 = 9;
/// Grids over the front aperture, rays across, in which a first ray through is looked for.
const GRIDS: [usize; 2] = [24, 80];
/// Rays that reach the film's plane farther from the axis than this, over the film's reach, are not looked for: some lenses
/// let rays through that leave them nearly along the film.
const STRAY: f64 = 2.0;
/// How far from the centre an outline may reach, over its half widths.
const FARTHEST: f64 = 4.0;

/// Rays from the scene to the film: film points of those that get through.
pub(in crate::camera::importance) struct Probe<'a> {
    pub kernel: &'a Kernel<f64>,
    /// The lens up to its stop, where it matters what points of that rays cross.
    pub to_stop: Option<&'a Kernel<f64>>,
    /// z of the film.
    pub film: f64,
    /// The farthest film point from the axis, mm.
    pub reach: f64,
    /// Whether the film has rays of these slopes at a point, mm.
    pub is_sampled: &'a dyn Fn([f64; 2], [f64; 2]) -> bool,
    /// z of the entrance pupil, if that lies in the lens.
    pub pupil: f64,
    /// z of the point of the axis that all spots are seen from where pupils stay about there: behind the front's rim.
    pub still: f64,
    /// z that no spot's point of the axis lies before.
    pub foremost: f64,
    /// Places of the front surface, height and z, mm.
    pub cap: Vec<[f64; 2]>,
    /// From anywhere on the planes to before the lens, mm.
    pub lead: f64,
}

/// What a ray through a point of the plane becomes: its film point.
type Landed = Option<[f64; 2]>;

/// The rays of a spot that get through.
#[derive(Clone, Debug)]
pub(in crate::camera::importance) struct Outline {
    pub fan: Fan,
    pub image: Image,
    /// Where rays cross the stop; of no meaning where that does not matter.
    pub stop: Image,
    /// The least distance from the axis at which its rays reach the film, mm, and no more.
    pub nearest: f64,
    /// Points of the edge, and where their rays reach the film.
    pub edge: Vec<([f64; 2], [f64; 2])>,
    /// The same of points within, and of the edge.
    pub within: Vec<([f64; 2], [f64; 2])>,
    /// Points within, and where their rays cross the stop.
    pub crossings: Vec<([f64; 2], [f64; 2])>,
}

impl Probe<'_> {
    /// Rays from a spot through points, ready to be traced.
    fn rays(&self, spot: &Spot, points: impl ExactSizeIterator<Item = [f64; 2]>) -> RayBuffer<f64> {
        let mut buffer = RayBuffer::new(points.len());
        for (i, point) in points.enumerate() {
            let (ray, _) = spot.ray(point, self.lead);
            buffer.put(i, ray.origin, ray.direction);
        }
        buffer
    }

    /// Traces rays from a spot.
    fn land(&self, spot: &Spot, points: &[[f64; 2]]) -> Vec<Landed> {
        let mut buffer = self.rays(spot, points.iter().copied());
        self.kernel.trace_in_place(&mut buffer.rays());
        (0..points.len()).map(|i| self.film_point(&buffer, i)).collect()
    }

    /// Where rays through these points cross the stop.
    fn crossings(
        &self,
        to_stop: &Kernel<f64>,
        spot: &Spot,
        points: &[([f64; 2], [f64; 2])],
    ) -> Vec<([f64; 2], [f64; 2])> {
        let mut buffer = self.rays(spot, points.iter().map(|(point, _)| *point));
        to_stop.trace_in_place(&mut buffer.rays());
        let crossing = |i: usize| {
            let [x, y, _] = buffer.get(i)?.ray().origin;
            Some((points[i].0, [x, y]))
        };
        (0..points.len()).filter_map(crossing).collect()
    }

    fn film_point(&self, buffer: &RayBuffer<f64>, i: usize) -> Landed {
        let ray = buffer.get(i)?.ray();
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        let slopes = [dx / dz, dy / dz];
        let point = [x + (self.film - z) * slopes[0], y + (self.film - z) * slopes[1]];
        let is_near = point[0].hypot(point[1]) <= STRAY * self.reach;
        (is_near && (self.is_sampled)(point, slopes)).then_some(point)
    }

    /// The part of the plane that the front surface covers, seen from a spot: along the first axis from, to, and along the
    /// second up to.
    fn front(&self, spot: &Spot) -> [f64; 3] {
        const AROUND: u32 = 24;
        let mut part = [f64::MAX, f64::MIN, 0.0];
        let ([cos, sin], most) = (direction(spot.angle()), 4.0 * self.lead);
        for [height, z] in &self.cap {
            for turn in 0..=AROUND {
                let [x, y] = direction(std::f64::consts::PI * f64::from(turn) / f64::from(AROUND));
                let (x, y, z) = (height * x, height * y, z - spot.reference);
                let (a, depth) = (x * cos - z * sin, x * sin + z * cos);
                // Points beside or behind the spot are seen at no end.
                let nearness = 1.0 - depth * spot.vergence;
                let scale = if nearness > 0.0 { nearness.recip() } else { f64::INFINITY };
                let (a, b) = ((a * scale).clamp(-most, most), (y * scale).clamp(-most, most));
                part = [part[0].min(a), part[1].max(a), part[2].max(b)];
            }
        }
        let margin = 0.02 * (part[1] - part[0]).max(part[2]);
        [part[0] - margin, part[1] + margin, part[2] + margin]
    }

    /// A point of the first axis inside the outline, or the middle of what gets through where that has none there, and how
    /// far it reaches.
    fn inside(&self, spot: &Spot, [from, to, up]: [f64; 3], hints: &[f64]) -> Option<f64> {
        let hints: Vec<[f64; 2]> = hints.iter().map(|hint| [*hint, 0.0]).collect();
        let landed = self.land(spot, &hints);
        if let Some((hint, _)) = hints.iter().zip(landed).find(|(_, landed)| landed.is_some()) {
            return Some(hint[0]);
        }
        GRIDS.into_iter().find_map(|across| {
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
            let row: Vec<f64> =
                through.iter().filter(|point| point[1] == lowest).map(|point| point[0]).collect();
            let mean = row.iter().sum::<f64>() / row.len() as f64;
            row.into_iter().min_by(|a, b| (a - mean).abs().total_cmp(&(b - mean).abs()))
        })
    }

    /// Along half-lines from `start` by `steps` of unit length up to `most` each, the farthest rays that get through: how
    /// far, and where they reach the film. `None` where none does.
    fn farthest(&self, spot: &Spot, half_lines: &[HalfLine]) -> Vec<Option<(f64, [f64; 2])>> {
        let place = |line: &HalfLine, i: usize| line.most * i as f64 / PLACES as f64;
        let points: Vec<[f64; 2]> =
            half_lines.iter().flat_map(|line| (0..=PLACES).map(|i| line.at(place(line, i)))).collect();
        let landed = self.land(spot, &points);
        let mut brackets: Vec<Option<(f64, f64, [f64; 2])>> = half_lines
            .iter()
            .zip(landed.chunks_exact(PLACES + 1))
            .map(|(line, landed)| {
                let last = landed.iter().rposition(Option::is_some)?;
                Some((place(line, last), place(line, last + 1), landed[last]?))
            })
            .collect();
        for _ in 0..HALVINGS {
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

    /// The outline of a spot; `hints` are points of the first axis that may lie inside. `None` where no ray gets through.
    pub fn outline(&self, spot: &Spot, hints: &[f64]) -> Option<Outline> {
        self.trace(spot, hints, FULL)
    }

    /// The same by a few half-lines, to see where it is.
    pub fn rough_outline(&self, spot: &Spot, hints: &[f64]) -> Option<Outline> {
        self.trace(spot, hints, COARSE)
    }

    fn trace(&self, spot: &Spot, hints: &[f64], count: usize) -> Option<Outline> {
        let front @ [from, to, up] = self.front(spot);
        let start = self.inside(spot, front, hints)?;
        let ends = self.farthest(
            spot,
            &[
                HalfLine { start: [start, 0.0], step: [1.0, 0.0], most: (to - start).max(0.0) },
                HalfLine { start: [start, 0.0], step: [-1.0, 0.0], most: (start - from).max(0.0) },
            ],
        );
        let end = |i: usize| ends[i].map_or(0.0, |(far, _)| far);
        let (left, right) = (start - end(1), start + end(0));
        let width = (right - left) / 2.0;
        let center = f64::midpoint(left, right);
        let columns = [-0.7, -0.35, 0.0, 0.35, 0.7];
        let columns =
            columns.map(|at| HalfLine { start: [center + at * width, 0.0], step: [0.0, 1.0], most: up });
        let heights = self.farthest(spot, &columns);
        let height = heights.iter().flatten().map(|(far, _)| *far).fold(0.0, f64::max);
        if !(width > 0.0 && height > 0.0) {
            return None;
        }
        let extent = [width, height];
        let half_lines: Vec<HalfLine> = (0..=count)
            .map(|i| {
                let [cos, sin] = direction(std::f64::consts::PI * i as f64 / count as f64);
                let step = [extent[0] * cos, extent[1] * sin];
                let toward = if cos > 0.0 { to - center } else { center - from };
                let most = (toward / step[0].abs()).min(up / step[1].abs()).clamp(0.0, FARTHEST);
                HalfLine { start: [center, 0.0], step, most }
            })
            .collect();
        let found = self.farthest(spot, &half_lines);
        let edge: Vec<([f64; 2], [f64; 2])> = half_lines
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
            .flat_map(|(line, reach)| [0.0, 0.4, 0.75].map(|part| line.at(part * reach)))
            .collect();
        let landed = self.land(spot, &inner);
        let mut within: Vec<([f64; 2], [f64; 2])> =
            inner.into_iter().zip(landed).filter_map(|(point, landed)| Some((point, landed?))).collect();
        within.extend(&edge);
        let image = fit(&fan, &within);
        let (crossings, stop) = match self.to_stop {
            Some(kernel) => {
                let crossings = self.crossings(kernel, spot, &within);
                let stop = fit(&fan, &crossings);
                (crossings, stop)
            }
            None => (Vec::new(), image),
        };
        Some(Outline { fan, image, stop, nearest: nearest(&image, &edge), edge, within, crossings })
    }
}

/// A half-line of the plane.
#[derive(Clone, Copy)]
struct HalfLine {
    start: [f64; 2],
    step: [f64; 2],
    most: f64,
}

impl HalfLine {
    fn at(&self, far: f64) -> [f64; 2] {
        [self.start[0] + far * self.step[0], self.start[1] + far * self.step[1]]
    }
}

fn direction(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}

/// The corners of the polygon that holds an edge found along evenly spread half-lines.
fn corners(found: &[f64]) -> [f64; SECTORS + 1] {
    /// What arcs between two half-lines bulge by, relative.
    const BULGE: f64 = 1.0008;
    let per_sector = found.len() / SECTORS;
    let last = found.len() - 1;
    let own = |knot: usize| {
        let at = knot as f64 / SECTORS as f64 * last as f64;
        let (low, part) = (at as usize, at.fract());
        found[low] + part * (found[(low + 1).min(last)] - found[low])
    };
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

/// The map from the plane to the film that fits these points best, and how far off it is.
fn fit(fan: &Fan, points: &[([f64; 2], [f64; 2])]) -> Image {
    let ends = [LEAST_BEND, MOST_BEND].map(|bend| bend / fan.farthest().powi(2));
    let bend = minimum(ends[0], ends[1], 0.02, |bend| fit_bent(fan, points, bend).spread);
    let [straight, bent] = [0.0, bend].map(|bend| fit_bent(fan, points, bend));
    if bent.spread < straight.spread { bent } else { straight }
}

/// The same with a given bend.
fn fit_bent(fan: &Fan, points: &[([f64; 2], [f64; 2])], bend: f64) -> Image {
    let count = points.len().max(1) as f64;
    let bent = |[a, b]: [f64; 2]| {
        let stretch = 1.0 + bend * fan.square([a, b]);
        [stretch * (a - fan.center), stretch * b]
    };
    let all = || points.iter().map(|(point, at)| (bent(*point), *at));
    let mean =
        |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| all().map(|(point, at)| of(point, at)).sum::<f64>() / count;
    let (middle, place) = (mean(&|point, _| point[0]), mean(&|_, at| at[0]));
    let ratio = |product: f64, square: f64| if square > 0.0 { product / square } else { 0.0 };
    let along = ratio(
        mean(&|point, at| (point[0] - middle) * (at[0] - place)),
        mean(&|point, _| (point[0] - middle).powi(2)),
    );
    let across = ratio(mean(&|point, at| point[1] * at[1]), mean(&|point, _| point[1] * point[1]));
    let image = Image { place: place - along * middle, along, across, bend, spread: 0.0 };
    let spread = points.iter().map(|(point, at)| image.off(fan, *point, *at)).fold(0.0, f64::max);
    Image { spread, ..image }
}

/// The least distance from the axis of what an outline's rays make on the film.
fn nearest(image: &Image, edge: &[([f64; 2], [f64; 2])]) -> f64 {
    /// What the half-lines from the middle may be apart there, over how far they reach.
    const APART: f64 = 0.2;
    let (mut least, mut longest) = (f64::INFINITY, 0.0_f64);
    for (_, [x, y]) in edge {
        let (dx, dy) = (x - image.place, *y);
        let square = dx * dx + dy * dy;
        let part = if square > 0.0 { (-image.place * dx / square).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min((image.place + part * dx).hypot(part * dy));
        longest = longest.max(square.sqrt());
    }
    (least - APART * longest).max(0.0)
}

impl Image {
    /// How far from where it is expected a ray through a point reaches the film.
    pub fn off(&self, fan: &Fan, [a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let stretch = 1.0 + self.bend * fan.square([a, b]);
        (self.place + self.along * stretch * (a - fan.center) - x).hypot(self.across * stretch * b - y)
    }
}
