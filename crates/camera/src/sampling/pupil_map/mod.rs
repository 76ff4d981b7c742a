//! The map from the unit disk to a lens's pupil, which takes rows to rows.
//!
//! A pencil is the bundle of rays through one point. Each ray is identified by a point (x, y) of a plane; for
//! a film point, x and y are the ray's slopes. The rays that pass the lens form the pupil. A point (X, Y) of
//! the unit disk maps to
//!
//! ```text
//! y = eta(Y),   x = m(Y) + g(Y) X,   area per area of the disk: eta'(Y) g(Y).
//! ```
//!
//! This is the Knothe-Rosenblatt rearrangement: it maps a row of the disk linearly to a row of the pupil, and
//! eta maps equal areas to equal areas. m is the middle of the pupil's row, and g is the ratio of this row's
//! half width to that of the disk's row. The density of the samples is exact for any eta, m and g: errors of
//! these functions block samples or miss light, but never make a picture brighter elsewhere. A round pupil is
//! mapped exactly, and any pupil whose rows are intervals is covered. If a pupil has several components, the
//! hull of each row is sampled, and samples in the gaps are blocked.
//!
//! eta, m and g are tabulated at knots t = 1 - (1 - k/32)² of |Y| and are linear between knots. Each node of
//! a fixed grid has such a table; between nodes, the tables are interpolated linearly. The grid has one or
//! two parameters. For a rotationally symmetric lens the first is the film radius; the film point is rotated
//! onto the x axis, and the disk's point by the same angle. The second, if there is one, is the wavelength or
//! the nearness of a scene point. Without symmetry, the two parameters are x and y of the film, without
//! rotation. For a fixed point of the disk, the ray is a continuous function of the grid's parameters.
//!
//! If light ends within the grid, the first parameter of the grid is s = 1 - sqrt(1 - h/end) instead of
//! h/end: toward the end, the height of a vanishing pupil is proportional to 1 - s and its width to (1 - s)².
//! g is stored divided by 1 - s.
//!
//! [docs/pupil.md](https://github.com/realistic-camera/realistic/blob/main/docs/pupil.md) explains the map
//! and its builder on one page. `pencil` is the interface to a lens, `search` finds a pupil and the ends of
//! its rows, `slice` makes the map of one pupil, and `grid` makes the maps of all nodes. This file contains
//! the table and the look-up in lanes, `inverse` the inverse map, and `film` and `spectral` the tables of a
//! camera.

mod film;
mod film_side;
mod grid;
mod inverse;
mod pencil;
mod rectangle;
mod search;
mod slice;
mod spectral;
mod threads;

pub(crate) use film::LanePupil;
pub use film::{BuildReport, GivenUp, WarpedPupil};
pub(crate) use film_side::{FilmRadii, PupilFilmSide, intervals};
pub use grid::MapFailure;
pub(crate) use grid::{Gap, Grid};
pub(crate) use pencil::{Family, Pencil};
pub(crate) use rectangle::RectanglePupil;
pub(crate) use spectral::{LaneSpectralPupil, SpectralPupil};

use self::slice::{CELLS, Slice, knot};
use realistic_base::numeric::Real;
use realistic_simd::{Cpu, Lanes, Scalar};

/// Pairs of numbers per cell: for each of eta, m and g, the value at |Y| = 1 and the slope with respect to
/// 1 - |Y|.
const PAIRS: usize = 3;
/// Number of pairs per half of a map, which extends from the disk's middle row to one end.
const HALF: usize = PAIRS * CELLS;

/// The maps of a grid, ready for look-ups.
#[derive(Clone, Debug)]
pub struct PupilMap {
    intervals: [usize; 2],
    dark_beyond: bool,
    is_tapered: bool,
    /// Whether the lower half of each map is the mirror image of the upper half; if so, it is not stored.
    is_symmetric: bool,
    /// The end of each column, and the difference to the end of the next column.
    ends: Vec<[f32; 2]>,
    /// The first parameter at the end of a grid with one column.
    end: f64,
    /// The maps, column by column; for each map the upper half, then the lower half.
    table: Vec<[f32; 2]>,
}

/// Constants of look-ups, in the precision of the lanes.
#[derive(Clone, Copy, Debug)]
pub struct MapConstants<S> {
    /// Number of intervals of the first parameter.
    along: S,
    /// The number of intervals, or its square if light ends within the grid.
    scale: S,
    per_end: S,
}

/// Points between the nodes of a grid.
#[derive(Clone, Copy)]
pub struct GridLocation<L: Lanes> {
    /// Index of the preceding node, counted over all columns.
    node: L,
    /// Interpolation parameters in [0, 1]: toward the next node, and toward the next column.
    parts: [L; 2],
    /// 1 - s in intervals, by which stored widths are multiplied; 1 if widths do not taper.
    taper: L,
    /// Whether the point lies inside the grid.
    pub inside: L::Mask,
}

/// Lines of eta, m and g: the value at |Y| = 1 and the slope with respect to 1 - |Y|.
type Cell<L> = [[L; 2]; 3];

impl PupilMap {
    /// Packs the maps of a grid.
    pub fn new(grid: &Grid, is_symmetric: bool) -> Self {
        let last = grid.ends.len() - 1;
        let step = |column: usize| grid.ends[(column + 1).min(last)] - grid.ends[column];
        let mut ends: Vec<[f32; 2]> =
            (0..=last).map(|column| [grid.ends[column], step(column)].map(|end| end as f32)).collect();
        // Padding, because a look-up reads two pairs.
        ends.push([0.0; 2]);
        let per_interval = if grid.is_tapered { (grid.intervals[0] as f64).recip() } else { 1.0 };
        let mut table = Vec::with_capacity(grid.slices.len() * HALF);
        for slice in &grid.slices {
            let middle = slice.t.len() - 1 - CELLS;
            let halves = if is_symmetric { &[1_isize][..] } else { &[1, -1] };
            for &side in halves {
                for k in 0..CELLS {
                    table.extend(Self::cell(
                        slice,
                        [k, k + 1].map(|k| middle.wrapping_add_signed(side * k as isize)),
                        k,
                        per_interval,
                    ));
                }
            }
        }
        // Padding, because a look-up reads two pairs.
        table.push([0.0; 2]);
        Self {
            intervals: grid.intervals,
            dark_beyond: grid.dark_beyond,
            is_tapered: grid.is_tapered,
            is_symmetric,
            ends,
            end: grid.ends[0],
            table,
        }
    }

    /// Returns the cell between two neighbouring knots of a map, of which the first is knot `k` from the
    /// middle row.
    fn cell(slice: &Slice, [near, far]: [usize; 2], k: usize, width: f64) -> [[f32; 2]; PAIRS] {
        let [v, next] = [k, k + 1].map(|k| 1.0 - knot(k));
        let line = |numbers: &[f64], factor: f64| {
            let slope = (numbers[near] - numbers[far]) / (v - next);
            [factor * slope.mul_add(-next, numbers[far]), factor * slope]
        };
        [line(&slice.eta, 1.0), line(&slice.middle, 1.0), line(&slice.half, width)]
            .map(|pair| pair.map(|number| number as f32))
    }

    /// Returns the first parameter at the end of a grid with one parameter.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Whether no light gets through beyond the grid's end.
    pub fn is_dark_beyond(&self) -> bool {
        self.dark_beyond
    }

    /// Returns the number of pairs per map.
    fn stride(&self) -> usize {
        if self.is_symmetric { HALF } else { 2 * HALF }
    }

    /// Returns the constants of look-ups.
    pub fn constants<S: Scalar>(&self) -> MapConstants<S> {
        let along = self.intervals[0] as f64;
        let scale = if self.dark_beyond { along * along } else { along };
        MapConstants {
            along: S::from_f64(along),
            scale: S::from_f64(scale),
            per_end: S::from_f64(self.end.recip()),
        }
    }

    /// Locates values of the first parameter in a grid with one parameter.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn locate<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &MapConstants<L::Scalar>,
        first: L,
    ) -> GridLocation<L> {
        self.locate_scaled(cpu, constants, first * L::splat(cpu, constants.per_end))
    }

    /// Locates points in a grid with two parameters; the second parameter is counted in columns.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn locate_in_columns<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &MapConstants<L::Scalar>,
        first: L,
        column: L,
    ) -> GridLocation<L> {
        let [before, part] = self.column(cpu, column);
        let [[end, step, ..]] = L::look_up::<1, 1>(&self.ends, before.whole(), [0]);
        let location = self.locate_scaled(cpu, constants, first / part.mul_add(step, end));
        self.in_column(cpu, location, before, part)
    }

    /// Locates points as [`PupilMap::locate_in_columns`] does, in a grid whose columns all have the same end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn locate_in_rectangle<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &MapConstants<L::Scalar>,
        first: L,
        column: L,
    ) -> GridLocation<L> {
        let [before, part] = self.column(cpu, column);
        let location = self.locate(cpu, constants, first);
        self.in_column(cpu, location, before, part)
    }

    /// Returns the column before a point, and the point's fraction of the interval to the next one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn column<L: Lanes>(&self, cpu: Cpu<L>, column: L) -> [L; 2] {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let columns = self.intervals[1] as f64;
        // With this order of operands, NaN becomes 0.
        let column = column.larger(number(0.0)).smaller(number(columns));
        let before = column.smaller(number(columns - 1.0)).trunc();
        [before, column - before]
    }

    /// Moves locations of the first column to another one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn in_column<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        mut location: GridLocation<L>,
        before: L,
        part: L,
    ) -> GridLocation<L> {
        let nodes = L::splat(cpu, L::Scalar::from_f64((self.intervals[0] + 1) as f64));
        location.node = before.mul_add(nodes, location.node);
        location.parts[1] = part;
        location
    }

    /// Locates values of the first parameter, given as fractions of its end.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn locate_scaled<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &MapConstants<L::Scalar>,
        first: L,
    ) -> GridLocation<L> {
        let [along, scale] = [constants.along, constants.scale].map(|number| L::splat(cpu, number));
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let (mut s, mut taper) = (first * scale, one);
        if self.dark_beyond {
            let left = first.neg_mul_add(scale, scale).sqrt();
            s = along - left;
            taper = if self.is_tapered { left } else { one };
        }
        // `smaller` replaces NaN by its other operand.
        let node = s.smaller(along - one).trunc();
        GridLocation { node, parts: [s - node, zero], taper, inside: s.less(along) }
    }

    /// Looks up the cell at each location, `k` cells from the middle row.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cell_of<L: Lanes>(&self, cpu: Cpu<L>, location: &GridLocation<L>, k: L, is_lower: L::Mask) -> Cell<L> {
        let number = |number: usize| L::splat(cpu, L::Scalar::from_f64(number as f64));
        let stride = self.stride();
        let half = if self.is_symmetric { k } else { k + number(CELLS).or_zero(is_lower) };
        let at = location.node.mul_add(number(stride), half * number(PAIRS)).whole();
        let mut found = self.between::<L>(at, 0, location.parts[0]);
        if self.intervals[1] > 0 {
            let next = self.between::<L>(at, stride * (self.intervals[0] + 1), location.parts[0]);
            found = toward(location.parts[1], found, next);
        }
        let [[eta, eta_slope, middle, middle_slope], [half, half_slope, ..]] = found;
        [[eta, eta_slope], [middle, middle_slope], [half, half_slope]]
    }

    /// Returns the numbers of cells, interpolated between two nodes, that lie `first` pairs after the indices
    /// `at` of the table.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn between<L: Lanes>(&self, at: L::Places, first: usize, part: L) -> [[L; 4]; 2] {
        let next = first + self.stride();
        let [a, b, c, d] = L::look_up::<4, 1>(&self.table, at, [first, first + 2, next, next + 2]);
        toward(part, [a, b], [c, d])
    }

    /// Returns the images in the plane of points (X, Y) of the unit disk, and the area per sample divided by
    /// π.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn at<L: Lanes>(&self, cpu: Cpu<L>, location: &GridLocation<L>, [x, y]: [L; 2]) -> ([L; 2], L) {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let (cells, last) = (CELLS as f64, (CELLS - 1) as f64);
        let [cells, last] = [cells, last].map(|number| L::splat(cpu, L::Scalar::from_f64(number)));
        let is_lower = y.less(zero);
        let v = L::splat(cpu, L::Scalar::ONE) - y.abs();
        let k = v
            .larger(L::splat(cpu, L::Scalar::NO_SQUARE))
            .sqrt()
            .neg_mul_add(cells, cells)
            .smaller(last)
            .trunc();
        let [eta, middle, half] = self.cell_of(cpu, location, k, is_lower);
        let value = |[end, slope]: [L; 2]| v.mul_add(slope, end);
        let width = value(half) * location.taper;
        let height = value(eta);
        let height = if self.is_symmetric { L::select(is_lower, zero - height, height) } else { height };
        ([width.mul_add(x, value(middle)), height], width * eta[1].abs())
    }
}

/// Interpolates linearly between two sets of numbers, at the fraction `part`.
#[cfg_attr(not(debug_assertions), inline(always))]
fn toward<L: Lanes>(part: L, mut from: [[L; 4]; 2], to: [[L; 4]; 2]) -> [[L; 4]; 2] {
    for j in 0..2 {
        for k in 0..4 {
            from[j][k] = part.mul_add(to[j][k] - from[j][k], from[j][k]);
        }
    }
    from
}
