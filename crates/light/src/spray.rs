//! The light of a lamp along a path, over a grid of cells, at any number of wavelengths.
//!
//! The landing point of a ray is a smooth function of the wavelength. Rays of the whole grid are therefore traced only
//! at some wavelengths, the nodes; at the other wavelengths, the landing points are interpolated by polynomials. The
//! remaining light is interpolated likewise, but between different nodes.
//!
//! The kernel also traces rays that pass outside the apertures, and reports how far outside they pass
//! ([`ClearanceTracer`]). Within a cell this excess is interpolated linearly from the rays of the neighbouring cells.
//! The area of the cell in which the excess is at most 0 is lit; this makes edges smooth. The excess has a kink at a
//! corner where the edges of two apertures meet. The corner moves with the wavelength, so cells along edges are traced
//! at all wavelengths. A cell whose own ray is lost for another reason is dark: light in such a cell enters at grazing
//! incidence, and fades out.

use super::{
    beam::{Beam, BeamGrid, Part},
    coated::LitPath,
    lamp::Lamp,
    shares::shares,
    sums::mix,
};
use realistic_trace::kernel::ClearanceTracer;

/// Landing point and power of the light of one cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Film point, mm; for a partly lit cell, the mean over the lit part of the cell.
    pub point: [f64; 2],
    /// Power, W, for a lamp that gives 1 W/m² at the lens on a plane perpendicular to its light.
    pub watts: f64,
}

/// The light of a lamp along one path: a grid of cells. The light of some cells reaches the plane of the film.
#[derive(Clone, Debug, Default)]
pub struct Spray {
    /// Number of cells along a side of the grid.
    pub side: usize,
    /// Landing of each cell, in `side` rows of `side` cells; `None` if the cell is dark.
    pub cells: Vec<Option<Landing>>,
}

impl Spray {
    /// Returns the power that reaches the plane of the film, W.
    pub fn watts(&self) -> f64 {
        self.landings().fold(0.0, |sum, landing| sum + landing.watts)
    }

    /// Iterates over the landings of the cells whose light reaches the plane of the film.
    pub fn landings(&self) -> impl Iterator<Item = &Landing> {
        self.cells.iter().flatten()
    }

    /// Returns the centroid, mm, of the light on the plane of the film, and the root-mean-square distance, mm, of the
    /// light from the centroid; `None` if there is no light.
    pub fn spot(&self) -> Option<([f64; 2], f64)> {
        let watts = self.watts();
        if watts <= 0.0 {
            return None;
        }
        let mean = |of: &dyn Fn(&Landing) -> f64| {
            self.landings().map(|landing| landing.watts * of(landing)).sum::<f64>() / watts
        };
        let center = [0, 1].map(|axis| mean(&|landing| landing.point[axis]));
        let square = mean(&|landing| (0..2).map(|axis| (landing.point[axis] - center[axis]).powi(2)).sum());
        Some((center, square.sqrt()))
    }
}

/// Number of cells along a side of the first grid in a search for the lit part of a path.
const COARSE: usize = 40;
/// Maximum number of cells along a side of finer grids, which are used if no cell is lit, or if the lit cells fill only
/// a small part of their bounding box. They still find an entrance pupil that is 1/150 as wide as the front surface.
const FINEST: usize = 160;
/// A single connected area lights at least one in this many cells of its bounding box; a disk lights three in four.
const FULL: usize = 4;
/// Number of lit cells that suffice to locate the lit part.
const ENOUGH: usize = 60;
/// Maximum number of searches; each is confined to the part that the previous search found.
const ROUNDS: usize = 4;

/// Tracers for one path of a lens that a lamp lights.
pub(super) struct PairTracers<'a> {
    /// Tracer of the whole path at each wavelength.
    pub tracers: &'a [ClearanceTracer],
    /// Tracers of the path up to the first mirror, at the first and the last wavelength; empty if the path has no
    /// mirror.
    pub approaches: &'a [ClearanceTracer],
    /// Indices of the wavelengths at which the whole grid is traced.
    pub nodes: &'a [usize],
    /// The path without its clear apertures, with the optical properties of its surfaces, at each wavelength at which
    /// light is traced.
    pub light: &'a [LitPath],
}

/// Weights of the nodes in the interpolation at a wavelength.
#[derive(Clone, Debug)]
pub(super) struct Mixture {
    /// Weights for landing points.
    pub landing: Vec<f64>,
    /// Weights for light.
    pub light: Vec<f64>,
}

impl Mixture {
    /// Returns the weights for a single node, at the wavelength itself.
    pub fn own() -> Self {
        Self { landing: vec![1.0], light: vec![1.0] }
    }
}

/// Traces the light of a lamp along a path, by a grid of `side` x `side` cells over the part of the light that gets
/// through. Passes the index of each wavelength and the spray at it to `found`. Sprays are empty if no such part is
/// found. `front` is the front sphere of the lens.
pub(super) fn sprays(
    pair: &PairTracers<'_>,
    lamp: Lamp,
    front: [f64; 2],
    side: usize,
    wavelengths: &[Mixture],
    mut found: impl FnMut(usize, &Spray),
) {
    let beam = Beam::new(lamp, front);
    let Some(part) = lit_part(pair, &beam) else {
        let none = Spray::default();
        return (0..wavelengths.len()).for_each(|k| found(k, &none));
    };
    let grid = BeamGrid { part, side };
    let whole = |k: &usize| SprayedRays::new(&pair.tracers[*k], &beam, grid, 0..side * side);
    let nodes: Vec<SprayedRays> = pair.nodes.iter().map(whole).collect();
    let [inside, edge] = sorted(&nodes, side);
    let along_edges = with_neighbours(&edge, side);
    let lit: Vec<usize> = inside.iter().chain(&edge).copied().collect();
    let points: Vec<[f64; 2]> = lit.iter().map(|cell| grid.center(*cell)).collect();
    // The factor 1e-6 converts mm² to m².
    let area = 1e-6 * grid.size().map(|size| size * beam.radius).iter().product::<f64>();
    let sent: Vec<f64> = points.iter().map(|point| area * beam.ray(*point).1).collect();
    // Shares are symmetric about the plane through the lamp and the axis, where the first coordinate of a point is 0.
    let mirrored: Vec<[f64; 2]> = points.iter().map(|[x, y]| [x.abs(), *y]).collect();
    let shares = shares(pair.light, &mirrored, |point| beam.ray(point).0);
    let landings: Vec<[Vec<f64>; 2]> = nodes
        .iter()
        .map(|node| [1, 2].map(|k| inside.iter().map(|cell| node.rays[*cell][k]).collect()))
        .collect();
    let mut spray = Spray { side, cells: vec![None; side * side] };
    let (mut x, mut y, mut share) = (Vec::new(), Vec::new(), Vec::new());
    for (k, Mixture { landing, light }) in wavelengths.iter().enumerate() {
        mix(&mut x, landing, landings.iter().map(|[x, _]| &x[..]));
        mix(&mut y, landing, landings.iter().map(|[_, y]| &y[..]));
        mix(&mut share, light, shares.iter().map(Vec::as_slice));
        let power = |i: usize| sent[i] * share[i].max(0.0);
        for (i, cell) in inside.iter().enumerate() {
            spray.cells[*cell] = Some(Landing { point: [x[i], y[i]], watts: power(i) });
        }
        let others;
        let own = match pair.nodes.iter().position(|node| *node == k) {
            Some(node) => &nodes[node],
            None => {
                others = SprayedRays::new(&pair.tracers[k], &beam, grid, along_edges.iter().copied());
                &others
            }
        };
        for (i, cell) in (inside.len()..).zip(&edge) {
            let lit = own.local(*cell).and_then(Local::lit);
            spray.cells[*cell] = lit.map(|(part, point)| Landing { point, watts: part * power(i) });
        }
        found(k, &spray);
    }
}

/// Returns the part of a beam from which rays reach the film, at the first or the last wavelength, with a margin.
///
/// Rays of a ghost first follow the direct path up to the farther mirror. The rays that reach this mirror fill one
/// connected area of the beam, which a coarse search finds. The rays that then reach the film fill rings and slivers
/// within that area, which are too narrow to be found in a search of the whole beam.
fn lit_part(pair: &PairTracers<'_>, beam: &Beam) -> Option<Part> {
    let whole = [[-1.0, 1.0]; 2];
    let part = if pair.approaches.is_empty() { whole } else { search(pair.approaches.iter(), beam, whole)? };
    search(ends(pair.tracers), beam, part)
}

/// Iterates over the first and the last item.
pub(super) fn ends<T>(all: &[T]) -> impl Iterator<Item = &T> + Clone {
    all.first().into_iter().chain(all.get(1..).and_then(<[T]>::last))
}

/// Narrows a part to the bounding box, with a margin, of the cells whose rays get through according to any of the
/// tracers.
fn search<'a>(
    tracers: impl Iterator<Item = &'a ClearanceTracer> + Clone,
    beam: &Beam,
    mut part: Part,
) -> Option<Part> {
    let tracer_count = tracers.clone().count();
    for _ in 0..ROUNDS {
        let mut side = COARSE;
        let (lit, [columns, rows]) = loop {
            let traced = |tracer: &ClearanceTracer| {
                SprayedRays::new(tracer, beam, BeamGrid { part, side }, 0..side * side)
                    .rays
                    .into_iter()
                    .enumerate()
            };
            let rays = tracers.clone().flat_map(traced);
            let lit: Vec<usize> = rays.filter(|(_, ray)| ray[0] <= 0.0).map(|(cell, _)| cell).collect();
            let box_of = [bounds(lit.iter().map(|i| i % side)), bounds(lit.iter().map(|i| i / side))];
            let cells: usize = box_of.iter().map(|[from, to]| (to + 1).saturating_sub(*from)).product();
            // A pupil behind a wide front surface is a small part of the grid, and rings and slivers light only some
            // cells. The grid is therefore refined if no cell is lit, or if the lit cells do not fill their box.
            if lit.len() * FULL >= cells * tracer_count && !lit.is_empty() || side >= FINEST {
                break (lit, box_of);
            }
            side *= 2;
        };
        if lit.is_empty() {
            return None;
        }
        let size = BeamGrid { part, side }.size();
        // A margin of a cell on every side: light may pass between the centres of two cells.
        let narrowed = |axis: usize, [from, to]: [usize; 2]| {
            let at = |cell: f64| (part[axis][0] + cell * size[axis]).clamp(-1.0, 1.0);
            [at(from as f64 - 1.0), at(to as f64 + 2.0)]
        };
        part = [narrowed(0, columns), narrowed(1, rows)];
        if lit.len() >= ENOUGH {
            break;
        }
    }
    Some(part)
}

/// Returns the minimum and the maximum of indices.
fn bounds(indices: impl Iterator<Item = usize>) -> [usize; 2] {
    indices.fold([usize::MAX, 0], |[least, greatest], index| [least.min(index), greatest.max(index)])
}

/// Rays through the centres of the cells of a grid.
struct SprayedRays {
    side: usize,
    /// The excess, in units of the semi-diameter, by which the ray of each cell passes outside the apertures, and the
    /// ray's film point, mm. The excess is at most 0 if the ray gets through, and infinite if the ray is lost for
    /// another reason or was not traced.
    rays: Vec<[f64; 3]>,
}

impl SprayedRays {
    /// Traces the rays of some cells.
    fn new(
        tracer: &ClearanceTracer,
        beam: &Beam,
        grid: BeamGrid,
        cells: impl Iterator<Item = usize> + Clone,
    ) -> Self {
        let side = grid.side;
        let lost = [f64::INFINITY, 0.0, 0.0];
        let mut rays = vec![lost; side * side];
        let mut traced = cells.clone();
        tracer.trace(cells.map(|cell| beam.ray(grid.center(cell)).0), |found| {
            let lands = found.and_then(|found| found.landing.map(|[x, y]| [found.ratio - 1.0, x, y]));
            if let Some(cell) = traced.next() {
                rays[cell] = lands.unwrap_or(lost);
            }
        });
        Self { side, rays }
    }

    /// Returns the ray of a cell; `None` if it is lost.
    fn ray(&self, cell: usize) -> Option<[f64; 3]> {
        Some(self.rays[cell]).filter(|ray| ray[0] < f64::INFINITY)
    }

    /// Returns the ray of a cell, and its change from cell to cell; `None` if the ray is lost.
    fn local(&self, cell: usize) -> Option<Local> {
        let own = self.ray(cell)?;
        let change = |[before, after]: [Option<usize>; 2]| {
            let [before, after] = [before, after].map(|cell| cell.and_then(|cell| self.ray(cell)));
            let cells = f64::from(u8::from(before.is_some()) + u8::from(after.is_some())).max(1.0);
            let (from, to) = (before.unwrap_or(own), after.unwrap_or(own));
            std::array::from_fn(|k| (to[k] - from[k]) / cells)
        };
        let [left, right, above, below] = neighbours(cell, self.side);
        Some(Local([own, change([left, right]), change([above, below])]))
    }
}

/// Returns the cells on the left and on the right of a cell, above and below it; `None` beyond the grid.
fn neighbours(cell: usize, side: usize) -> [Option<usize>; 4] {
    let (row, column) = (cell / side, cell % side);
    [
        (column > 0).then(|| cell - 1),
        (column + 1 < side).then(|| cell + 1),
        (row > 0).then(|| cell - side),
        (row + 1 < side).then(|| cell + side),
    ]
}

/// Returns the cells and their neighbours, without repetitions.
fn with_neighbours(cells: &[usize], side: usize) -> Vec<usize> {
    let beside = cells.iter().flat_map(|cell| neighbours(*cell, side).into_iter().flatten());
    let mut all: Vec<usize> = cells.iter().copied().chain(beside).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Returns two lists: the cells that are lit at all nodes, as all of their neighbours are, and the cells along edges.
fn sorted(nodes: &[SprayedRays], side: usize) -> [Vec<usize>; 2] {
    let count = |cell: usize| nodes.iter().filter(|node| node.rays[cell][0] <= 0.0).count();
    let lit: Vec<usize> = (0..side * side).map(count).collect();
    let mut sorted = [Vec::new(), Vec::new()];
    for cell in 0..side * side {
        let like = |other: &usize| lit[*other] == lit[cell];
        match lit[cell] {
            at if at == nodes.len() && neighbours(cell, side).iter().flatten().all(like) => {
                sorted[0].push(cell)
            }
            0 if neighbours(cell, side).iter().flatten().all(like) => {}
            // A cell whose ray is lost at every node is dark.
            _ if nodes.iter().any(|node| node.ray(cell).is_some()) => sorted[1].push(cell),
            _ => {}
        }
    }
    sorted
}

/// The ray of a cell, as in [`SprayedRays`], and its change from cell to cell along either axis.
#[derive(Clone, Copy)]
struct Local([[f64; 3]; 3]);

impl Local {
    /// Returns the lit share of the cell and the landing point of its centroid; `None` for a dark cell.
    fn lit(self) -> Option<(f64, [f64; 2])> {
        let Self([[excess, x, y], by_column, by_row]) = self;
        let slopes = [by_column[0], by_row[0]];
        // The area, and the first moments, of the region a p + b q <= s of the unit square.
        let steepest = slopes[0].abs().max(slopes[1].abs()).max(f64::MIN_POSITIVE);
        let [a, b] = slopes.map(|slope| slope.abs().max(FLAT * steepest));
        let s = f64::midpoint(a, b) - excess;
        if s >= a + b {
            return Some((1.0, [x, y]));
        }
        if s <= 0.0 {
            return None;
        }
        let over = |least: f64| (s - least).max(0.0);
        let area = (over(0.0).powi(2) - over(a).powi(2) - over(b).powi(2)) / (2.0 * a * b);
        // ∫ p (s - a p) dp over the part of 0 … 1 with s > a p.
        let inner = |a: f64, s: f64| {
            let (s, rest) = (s.max(0.0), (s - a).max(0.0));
            (s * (s * s - rest * rest) / 2.0 - (s.powi(3) - rest.powi(3)) / 3.0) / (a * a)
        };
        let moment = |a: f64, b: f64| (inner(a, s) - inner(a, s - b)) / b;
        // Centroid relative to the centre of the cell; p and q grow with the excess.
        let off = |moment: f64, slope: f64| 1.0_f64.copysign(slope) * (moment / area - 0.5);
        let (u, v) = (off(moment(a, b), slopes[0]), off(moment(b, a), slopes[1]));
        Some((area, [1, 2].map(|k| [x, y][k - 1] + u * by_column[k] + v * by_row[k])))
    }
}

/// Minimum ratio of the smaller to the larger slope of the excess, which prevents a division by 0. It changes the lit
/// share of a cell by at most half of this ratio.
const FLAT: f64 = 1e-3;
