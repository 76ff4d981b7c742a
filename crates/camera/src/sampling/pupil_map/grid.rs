//! The maps at the nodes of a fixed grid. Each map is found separately and then widened so that it contains
//! the pupils at the centres of the adjacent cells.

use super::{
    pencil::{Family, Pencil},
    search::{NearestPoint, SearchEnd, Window, nearest, pupil},
    slice::{Outside, Slice},
    threads::made_of_each,
};
use realistic_base::numeric::STEPS;
use realistic_optics::lens::pupil::SlopeDisk;

/// Limit of the search for the end of the light, as a multiple of the largest first parameter. It exceeds 1
/// because a pupil that vanishes just beyond that parameter changes as fast as one that vanishes before it.
const BEYOND: f64 = 1.125;
/// Number of positions, from the axis to that limit, at which light is first searched for.
const POSITIONS: usize = 16;
/// Relative accuracy of the end of the light; the last ten thousandth contains hardly any light.
const END_ACCURACY: f64 = 1e-7;
/// Maximum number of steps of that search.
const END_STEPS: usize = 40;
/// Factor on the number of intervals if light ends within the grid, because narrow pupils change fast toward
/// the end.
const FINER: usize = 2;
/// Number of rays per cell, from all over the cover, that check that no light gets through beside the cell's
/// maps. More rays find smaller components.
const CHECKS: usize = 256;
/// Number of positions in a cell from which these rays begin.
const CHECKED: usize = 4;
/// Distance from a map, relative to the size of the map's rectangle, beyond which light beside the map
/// belongs to another component of the pupil and not to the pupil's edge.
const BESIDE: f64 = 0.1;
/// Distance from the disk's centre up to which light beside a map is explained by the error of the map's
/// edge.
const EDGE: f64 = 1.02;
/// Number of samples per cell in the estimate of the cell's acceptance.
const SAMPLES: usize = 64;
/// Acceptance below which a cell's gaps are reported.
const FULL: f64 = 0.9;
/// Fraction of the first parameter's end beyond which gaps are not reported, because less than a thousandth
/// of the light arrives there.
const LAST: f64 = 0.999;

/// The reason why the samples of a cell are blocked more often than elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapFailure {
    /// Light gets through beside the map; the cover is sampled instead.
    LightBeside,
    /// No light was found; the cover is sampled instead.
    NoLight,
    /// The pupil has gaps, holes or several components; the map contains them all.
    Gaps,
}

/// A cell of the grid whose samples are often blocked.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// The node at the cell's first corner: its interval and its column.
    pub cell: [usize; 2],
    pub reason: MapFailure,
    /// Share of the samples that pass the lens.
    pub acceptance: f64,
}

/// The maps of a family.
#[derive(Clone, Debug)]
pub struct Grid {
    /// The first parameter at the end of each column.
    pub ends: Vec<f64>,
    /// Whether no light gets through beyond the ends. If so, the first parameter is mapped to s.
    pub dark_beyond: bool,
    /// Whether the widths of rows shrink toward the ends in proportion to 1 - s, and are stored divided by
    /// 1 - s. Covers do not shrink.
    pub is_tapered: bool,
    /// Number of intervals of the first parameter and of the second.
    pub intervals: [usize; 2],
    /// The maps, one column after the other.
    pub slices: Vec<Slice>,
    pub gaps: Vec<Gap>,
}

/// Nodes and cells while a grid is built.
struct GridBuilder<'a, F> {
    family: &'a F,
    grid: Grid,
    /// Whether each node holds the cover.
    covered: Vec<bool>,
}

/// One column of a grid, before its maps are found.
#[derive(Clone)]
struct GridColumn {
    /// The first parameter at the end of the light or, if light does not end, at the end of the grid.
    end: f64,
    /// First parameters at which light was found, in outward order, each with a point of the pupil.
    lit: Vec<(f64, [f64; 2])>,
}

impl GridColumn {
    /// Adds a point of a pupil.
    fn add(&mut self, first: f64, at: [f64; 2]) {
        let index = self.lit.partition_point(|(lit, _)| *lit < first);
        self.lit.insert(index, (first, at));
    }

    /// Returns the window in which to search for a pupil of about this size. The window lies on the line
    /// through the pupils of the two neighbours, and is larger the farther away they are.
    fn nearby<F: Family>(&self, first: f64, size: f64) -> Option<Window> {
        let next = self.lit.partition_point(|(lit, _)| *lit < first).min(self.lit.len().checked_sub(1)?);
        let ((a, from), (b, to)) = (self.lit[next.saturating_sub(1)], self.lit[next]);
        let part = if a < b { (first - a) / (b - a) } else { 0.0 };
        let offset = [to[0] - from[0], to[1] - from[1]];
        let reach = size + part.abs().min((1.0 - part).abs()) * offset[0].hypot(offset[1]);
        let [x, y] = [0, 1].map(|axis| [-reach, reach].map(|side| from[axis] + part * offset[axis] + side));
        Some(Window { x, y: if F::SYMMETRIC { [0.0, y[1]] } else { y } })
    }
}

impl Grid {
    /// Builds the grid of a family.
    pub fn new<F: Family>(family: &F) -> Self {
        let [_, columns] = family.intervals();
        let (column, reach): (Vec<usize>, f64) = ((0..=columns).collect(), family.reach());
        let ends = if F::ENDS { ends(family, &column, BEYOND * reach) } else { None };
        let Some(ends) = ends else {
            let open = GridColumn { end: reach, lit: Vec::new() };
            return GridBuilder::new(family, vec![open; columns + 1], false).built();
        };
        GridBuilder::new(family, ends, true).built()
    }

    /// Returns the index of a node.
    fn node(&self, [i, column]: [usize; 2]) -> usize {
        column * (self.intervals[0] + 1) + i
    }

    /// Returns the factor by which widths taper at a position, which is counted in intervals from the axis.
    fn taper(&self, position: f64) -> f64 {
        if self.is_tapered { 1.0 - position / self.intervals[0] as f64 } else { 1.0 }
    }

    /// Returns the first parameter at a position; the position is counted in intervals of both parameters.
    pub fn first(&self, [position, column]: [f64; 2]) -> f64 {
        let s = position / self.intervals[0] as f64;
        let low = (column as usize).min(self.ends.len() - 1);
        let high = (low + 1).min(self.ends.len() - 1);
        let end = self.ends[low] + (column - low as f64) * (self.ends[high] - self.ends[low]);
        end * if self.dark_beyond { s * (2.0 - s) } else { s }
    }

    /// Returns the interpolated map at a position within a cell.
    fn mixed(&self, corners: &[[usize; 2]], [position, column]: [f64; 2]) -> Slice {
        let part = |of: f64, node: usize| 1.0 - (of - node as f64).abs();
        let parts: Vec<(f64, &Slice)> = corners
            .iter()
            .map(|&[i, j]| (part(position, i) * part(column, j), &self.slices[self.node([i, j])]))
            .collect();
        Slice::mixed(&parts).widened(self.taper(position))
    }
}

/// Finds the ends of the light along all columns, moved outward until the lines between columns contain the
/// ends found halfway between them. `None` if light does not end along some column.
fn ends<F: Family>(family: &F, columns: &[usize], reach: f64) -> Option<Vec<GridColumn>> {
    let halves: Vec<usize> = (0..2 * columns.len() - 1).collect();
    let find = |&half: &usize| light(family, half as f64 / 2.0, reach);
    let found: Vec<GridColumn> = each(columns.len() - 1, &halves, find).into_iter().collect::<Option<_>>()?;
    let mut ends: Vec<GridColumn> = found.iter().cloned().step_by(2).collect();
    for (column, half) in found.iter().skip(1).step_by(2).enumerate() {
        let beyond = half.end / f64::midpoint(found[2 * column].end, found[2 * column + 2].end);
        for end in [column, column + 1] {
            ends[end].end = ends[end].end.max(found[2 * end].end * beyond);
        }
    }
    Some(ends)
}

/// Searches for the end of the light along a column. `None` if light continues beyond `reach`, or if there is
/// no light.
fn light<F: Family>(family: &F, column: f64, reach: f64) -> Option<GridColumn> {
    if nearest(&family.pencil(reach, column), F::SYMMETRIC, None).excess <= 0.0 {
        return None;
    }
    let mut known = GridColumn { end: reach, lit: Vec::new() };
    let mut probe = |first: f64| {
        let pencil = family.pencil(first, column);
        // Narrow pupils are found near the line through the lit points that are already known.
        let seed = known.nearby::<F>(first, pencil.guess().radius);
        let NearestPoint { at, excess } = nearest(&pencil, F::SYMMETRIC, seed);
        if excess <= 0.0 {
            known.add(first, at);
        }
        [first, excess]
    };
    let found: Vec<[f64; 2]> = (0..=POSITIONS).map(|k| probe(reach * k as f64 / POSITIONS as f64)).collect();
    let last = found.iter().rposition(|[_, excess]| *excess <= 0.0)?;
    let mut end = SearchEnd::new(found[last], *found.get(last + 1)?);
    for step in 0..END_STEPS {
        if end.width() <= END_ACCURACY * end.outside[0] {
            break;
        }
        let [first, excess] = probe(end.next(step));
        end.learn(first, excess);
    }
    known.end = end.outside[0];
    Some(known)
}

impl<'a, F: Family> GridBuilder<'a, F> {
    /// Finds the map at each node of a grid with the given ends.
    fn new(family: &'a F, ends: Vec<GridColumn>, dark_beyond: bool) -> Self {
        let [along, columns] = family.intervals();
        let mut grid = Grid {
            ends: ends.iter().map(|column| column.end).collect(),
            dark_beyond,
            is_tapered: dark_beyond,
            intervals: [if dark_beyond { FINER * along } else { along }, columns],
            slices: Vec::new(),
            gaps: Vec::new(),
        };
        let ends: Vec<(usize, GridColumn)> = ends.into_iter().enumerate().collect();
        let found = each(columns, &ends, |(column, known)| column_of(family, &grid, *column, known.clone()));
        let mut covered = Vec::new();
        for (column, slices) in found.into_iter().enumerate() {
            for (i, slice) in slices.into_iter().enumerate() {
                covered.push(slice.is_none());
                let slice = slice.unwrap_or_else(|| cover(family, &grid, [i, column]));
                grid.slices.push(slice);
            }
        }
        let mut builder = Self { family, grid, covered };
        if builder.covered.iter().any(|covered| *covered) {
            builder.end_taper();
        }
        builder
    }

    /// Stores widths without taper, because covers do not become narrower. This applies where light ends in a
    /// jump or in several components, and thus at a cover.
    fn end_taper(&mut self) {
        if !self.grid.is_tapered {
            return;
        }
        let along = self.grid.intervals[0];
        for node in 0..self.grid.slices.len() {
            let i = node % (along + 1);
            if self.covered[node] {
                continue;
            }
            if i == along {
                self.covered[node] = true;
                self.grid.slices[node] = cover(self.family, &self.grid, [i, node / (along + 1)]);
            } else {
                let taper = self.grid.taper(i as f64);
                self.grid.slices[node].half.iter_mut().for_each(|half| *half *= taper);
            }
        }
        self.grid.is_tapered = false;
    }

    /// Widens the maps so that they contain the pupils of their cells; a map for which this fails is replaced
    /// by the cover.
    fn built(mut self) -> Grid {
        let (cells, [along, columns]) = (self.cells(), self.grid.intervals);
        let found = each(columns, &cells, |&cell| self.outside(cell));
        let mut more: Vec<Outside> =
            self.grid.slices.iter().map(|slice| Outside::none(slice.t.len())).collect();
        for (cell, outside) in cells.iter().zip(&found) {
            for corner in self.corners(*cell) {
                more[self.grid.node(corner)].join(outside);
            }
        }
        for (node, more) in more.iter().enumerate().filter(|(node, _)| !self.covered[*node]) {
            let i = node % (along + 1);
            // At the end itself the taper is 0, so the taper half an interval before the end is used.
            let taper = self.grid.taper((i as f64).min(along as f64 - 0.5));
            self.grid.slices[node].take_in(more, taper);
            if F::SYMMETRIC && i == 0 {
                self.grid.slices[node] = self.grid.slices[node].rounded(true);
            }
        }
        // A cell is checked again if one of its corners has become a cover.
        let mut open = cells.clone();
        while !open.is_empty() {
            let given_up = each(columns, &open, |&cell| self.is_undescribed(cell));
            let before = self.covered.clone();
            if given_up.contains(&true) {
                self.end_taper();
            }
            for (cell, _) in open.iter().zip(&given_up).filter(|(_, is_given_up)| **is_given_up) {
                for corner in self.corners(*cell) {
                    let node = self.grid.node(corner);
                    if !self.covered[node] {
                        self.covered[node] = true;
                        self.grid.slices[node] = cover(self.family, &self.grid, corner);
                    }
                }
            }
            let is_new = |corner: &[usize; 2]| {
                let node = self.grid.node(*corner);
                self.covered[node] && !before[node]
            };
            let is_open = |cell: &[usize; 2]| self.corners(*cell).iter().any(is_new);
            open = cells.iter().copied().filter(is_open).collect();
        }
        let gaps = each(columns, &cells, |&cell| self.gap(cell));
        self.grid.gaps = gaps.into_iter().flatten().collect();
        self.grid
    }

    fn cells(&self) -> Vec<[usize; 2]> {
        let [along, columns] = self.grid.intervals;
        (0..columns.max(1)).flat_map(|column| (0..along).map(move |i| [i, column])).collect()
    }

    /// Returns the nodes at the corners of a cell: two, or four if the grid has columns.
    fn corners(&self, [i, column]: [usize; 2]) -> Vec<[usize; 2]> {
        let columns = if self.grid.intervals[1] == 0 { column..=column } else { column..=column + 1 };
        columns.flat_map(|column| [[i, column], [i + 1, column]]).collect()
    }

    /// Returns a position within a cell, given as fractions of the cell from its first corner.
    fn position(&self, [i, column]: [usize; 2], [part, aside]: [f64; 2]) -> [f64; 2] {
        let aside = if self.grid.intervals[1] == 0 { 0.0 } else { aside };
        [i as f64 + part, column as f64 + aside]
    }

    /// Returns the map at a position within a cell, and the pencil there.
    fn within(&self, cell: [usize; 2], parts: [f64; 2]) -> (Slice, impl Pencil + '_) {
        let position = self.position(cell, parts);
        let slice = self.grid.mixed(&self.corners(cell), position);
        (slice, self.family.pencil(self.grid.first(position), position[1]))
    }

    /// Finds the parts of a cell's pupils that the cell's maps leave out: at the cell's centre by the ends of
    /// all rows, and at several positions by rays from all over the cover.
    fn outside(&self, cell: [usize; 2]) -> Outside {
        let (slice, pencil) = self.within(cell, [0.5; 2]);
        let seed = slice.window(F::SYMMETRIC);
        let mut outside = match pupil(&pencil, F::SYMMETRIC, Some(seed)) {
            Ok(window) => slice.outside(&pencil, F::SYMMETRIC, window),
            Err(_) => Outside::none(slice.t.len()),
        };
        for number in 0..CHECKED {
            let (slice, passing) = self.check(cell, number);
            let beside = BESIDE * slice.size();
            let is_left_out =
                |&point: &[f64; 2]| slice.radius(point) > EDGE && slice.distance(point) <= beside;
            for point in passing.into_iter().filter(is_left_out) {
                outside.add(&slice, point);
            }
        }
        outside
    }

    /// Whether the maps of a cell fail to describe the cell's pupils, because no sample gets through although
    /// light does, or because rays from all over the cover get through far from the maps.
    fn is_undescribed(&self, cell: [usize; 2]) -> bool {
        let is_missed = || !self.is_covered(cell) && self.acceptance(cell) == 0.0 && self.is_lit(cell);
        is_missed() || self.has_far_components(cell)
    }

    /// Whether light gets through at the centre of a cell.
    fn is_lit(&self, cell: [usize; 2]) -> bool {
        let (slice, pencil) = self.within(cell, [0.5; 2]);
        pupil(&pencil, F::SYMMETRIC, Some(slice.window(F::SYMMETRIC))).is_ok()
    }

    fn is_covered(&self, cell: [usize; 2]) -> bool {
        self.corners(cell).iter().any(|&corner| self.covered[self.grid.node(corner)])
    }

    fn has_far_components(&self, cell: [usize; 2]) -> bool {
        (0..CHECKED).any(|number| {
            let (slice, passing) = self.check(cell, CHECKED + number);
            let beside = BESIDE * slice.size();
            passing.into_iter().any(|point| slice.distance(point) > beside)
        })
    }

    /// Returns the map at one of the checked positions in a cell, and the rays from all over the cover that
    /// get through there.
    fn check(&self, cell: [usize; 2], number: usize) -> (Slice, Vec<[f64; 2]>) {
        let part = ((number % CHECKED) as f64 + 0.5) / CHECKED as f64;
        let (slice, pencil) = self.within(cell, [part, 0.5]);
        let SlopeDisk { center, radius } = pencil.cover();
        let at = |point: [f64; 2]| std::array::from_fn(|axis| center[axis] + radius * point[axis]);
        let points: Vec<[f64; 2]> = over_disk(CHECKS / CHECKED, number).into_iter().map(at).collect();
        let found = points.iter().zip(pencil.excesses(&points)).filter(|(_, excess)| *excess <= 0.0);
        (slice, found.map(|(point, _)| *point).collect())
    }

    /// Returns the share of samples at the centre of a cell that get through.
    fn acceptance(&self, cell: [usize; 2]) -> f64 {
        let (slice, pencil) = self.within(cell, [0.5; 2]);
        let points: Vec<[f64; 2]> = over_disk(SAMPLES, 0).into_iter().map(|point| slice.at(point)).collect();
        pencil.excesses(&points).into_iter().filter(|excess| *excess <= 0.0).count() as f64 / SAMPLES as f64
    }

    /// Describes the gap in a cell if many of the cell's samples are blocked.
    fn gap(&self, cell: [usize; 2]) -> Option<Gap> {
        let acceptance = self.acceptance(cell);
        let reason = match self.is_covered(cell) {
            true if acceptance == 0.0 => MapFailure::NoLight,
            true => MapFailure::LightBeside,
            false if acceptance > 0.0 && acceptance < FULL && !self.is_last(cell) => MapFailure::Gaps,
            false => return None,
        };
        Some(Gap { cell, reason, acceptance })
    }

    /// Whether a cell lies at the end of the light, where hardly any light arrives.
    fn is_last(&self, [i, column]: [usize; 2]) -> bool {
        let position = [i as f64, column as f64];
        self.grid.dark_beyond
            && self.grid.first(position)
                >= LAST * self.grid.first([self.grid.intervals[0] as f64, position[1]])
    }
}

/// Calls a function for each item. For a grid with two parameters it uses all cores, because a first ray
/// waits for the result. For the grid with one parameter, which every camera builds at its start, it uses
/// only the calling thread.
fn each<'a, T: Sync, R: Send>(columns: usize, items: &'a [T], make: impl Fn(&'a T) -> R + Sync) -> Vec<R> {
    if columns > 0 { made_of_each(items, make) } else { items.iter().map(make).collect() }
}

/// Returns points spread uniformly over the unit disk, different points for each `number`.
fn over_disk(count: usize, number: usize) -> Vec<[f64; 2]> {
    let point = |k: usize| {
        let radius = ((k as f64 + 0.5) / count as f64).sqrt();
        let turn = (STEPS[0] * (k + count * number) as f64).fract();
        let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
        [radius * cos, radius * sin]
    };
    (0..count).map(point).collect()
}

/// Returns the cover as the map of a node.
fn cover<F: Family>(family: &F, grid: &Grid, [i, column]: [usize; 2]) -> Slice {
    let position = [i, column].map(|node| node as f64);
    Slice::of_disk(family.pencil(grid.first(position), position[1]).cover(), F::SYMMETRIC)
}

/// Returns the maps of one column, with widths divided by the taper. A node beyond the end of the light gets
/// a vanishing map with the widths of the preceding node; a node where no light was found gets `None`.
fn column_of<F: Family>(family: &F, grid: &Grid, column: usize, mut known: GridColumn) -> Vec<Option<Slice>> {
    let mut slices: Vec<Option<Slice>> = Vec::with_capacity(grid.intervals[0] + 1);
    for i in 0..=grid.intervals[0] {
        let first = grid.first([i as f64, column as f64]);
        let last = known.lit.last().filter(|(lit, _)| grid.dark_beyond && *lit < first);
        let slice = if let Some((_, at)) = last {
            slices[i - 1].as_ref().map(|before| before.vanishing(*at))
        } else {
            let pencil = family.pencil(first, column as f64);
            let seed = known.nearby::<F>(first, pencil.guess().radius);
            let window = pupil(&pencil, F::SYMMETRIC, seed).ok();
            let slice = window.and_then(|window| {
                known.add(first, window.middle());
                Slice::new(&pencil, F::SYMMETRIC, window)
            });
            slice.map(|slice| slice.widened(grid.taper(i as f64).recip()))
        };
        slices.push(slice);
    }
    if F::SYMMETRIC
        && let Some(axis) = &slices[0]
    {
        slices[0] = Some(axis.rounded(F::SYMMETRIC));
    }
    slices
}
