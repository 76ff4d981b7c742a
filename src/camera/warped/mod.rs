//! The warped pupil: lens samples drawn from the true pupil of each film point.
//!
//! The pupil of a film point at distance h from the axis, in slopes at the film and turned so that the
//! point lies on the +x axis, is the image of the unit disk under
//!
//! ```text
//! d -> C + M(direction of d) d        (complex numbers)
//! ```
//!
//! C = c h lies inside, and M takes each half-line from the disk's centre to one from C, its end to
//! the pupil's edge. M is tabulated so that equal areas of the disk go to equal areas of the pupil (an
//! equal-area fan), at knots in a pseudo-angle q and at film radii chosen so that interpolation
//! between them, linear in both, fits. Written in the film's own frame, at the film point p = h e,
//!
//! ```text
//! slope = c(h) p + M(q, h) d,   q = 1 - a/(|a| + |b|),   a + i b = d * conj(p),
//! ```
//!
//! with the conjugate of M where b < 0, the pupil being symmetric: turning the film point turns the
//! pupil under a disk that stays, so that for fixed lens numbers the slope is continuous over
//! the film, through the axis too, where M is the same in every direction. A round pupil is exactly
//! round. The map's Jacobian is |M|² + Im(conj(M) dM/dφ), with dq/dφ = |d|²/(|a| + |b|)²: the exact
//! density of what is drawn, whatever the table, so that the only bias is the share of the
//! pupil that the map does not reach.
//!
//! One evaluation takes two roots, two divisions, no trigonometry and four neighbouring pairs of
//! floats of one table. A block of them is three loops: places and arithmetic in vectors, and the
//! look-ups between them one by one.
//!
//! Where no such map fits (a pupil in pieces, with holes, or of an edge that no half-line meets once)
//! the table holds the rear element's disk, and what falls beside the pupil is blocked.

mod build;
mod outline;
mod row;
mod view;

use std::f64::consts::PI;

use self::{
    build::{Builder, FINE, Plan},
    row::{CELLS, Row},
};
use super::{Drawn, PupilDisk};
use crate::trace::Path;

/// The true pupil of every point of a film. Immutable once built.
#[derive(Clone, Debug)]
pub struct WarpedPupil {
    /// Film radius at the table's end, mm, and its reciprocal.
    end: f64,
    inverse_end: f64,
    /// Whether the pupil has vanished at the end; film radius is then tabulated in
    /// s = 1 - sqrt(1 - h/end), in which the shrinking outline is smooth.
    dark_beyond: bool,
    /// The row below each smallest interval of s.
    cells: Vec<u16>,
    /// Rows of [`STRIDE`]: s, 1/(next row's s - s), c, 0, then M's knots as pairs.
    table: Vec<f32>,
    cover: PupilDisk,
    build: BuildReport,
}

/// Floats a row.
const STRIDE: usize = HEADER + 2 * (CELLS + 1);
/// Floats before the knots.
const HEADER: usize = 4;

/// What building the table took, and what it could not fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// Film radii in the table.
    pub rows: usize,
    /// Rays traced.
    pub rays: u32,
    /// Share of the film radius over which the rear element's disk is used instead of an outline.
    pub covered: f64,
}

impl WarpedPupil {
    /// Tabulates the pupils of film points up to `reach` mm from the axis, on film at `film` (z in
    /// lens space). `cover` is a disk that holds them all; `drift` an estimate of the slope to the
    /// pupil's centre over the film radius, 1/mm.
    pub fn new(path: &Path, film: f64, reach: f64, cover: PupilDisk, drift: f64) -> Self {
        let builder = Builder::new(path, film, reach, cover, drift);
        let plan = builder.plan();
        Self::pack(plan, cover, builder.rays.get())
    }

    fn pack(plan: Plan, cover: PupilDisk, rays: u32) -> Self {
        let Plan { end, dark_beyond, intervals } = plan;
        let place = |at: usize| at as f64 / FINE as f64;
        let mut table: Vec<f32> = Vec::with_capacity((intervals.len() + 1) * STRIDE);
        let mut cells = vec![0_u16; FINE];
        let mut covered = 0.0;
        let mut joined: Option<bool> = None;
        for interval in &intervals {
            let [low, high] = &interval.rows;
            let width = place(interval.to) - place(interval.from);
            // A row serves the intervals on both its sides, unless only one of them is covered.
            if joined == Some(low.fitted) {
                table.truncate(table.len() - STRIDE);
            }
            let row = table.len() / STRIDE;
            cells[interval.from..interval.to].fill(row as u16);
            push(&mut table, low, place(interval.from), width.recip());
            push(&mut table, high, place(interval.to), 0.0);
            joined = Some(high.fitted);
            if !low.fitted {
                covered += (high.height - low.height) / end;
            }
        }
        let build = BuildReport { rows: table.len() / STRIDE, rays, covered };
        Self { end, inverse_end: end.recip(), dark_beyond, cells, table, cover, build }
    }

    /// What building the table took.
    pub fn build_report(&self) -> BuildReport {
        self.build
    }

    /// The film radius from which on no light arrives, mm, where that lies within reach.
    pub fn image_radius(&self) -> Option<f64> {
        self.dark_beyond.then_some(self.end)
    }

    /// The slope that the point `disk` of the unit disk stands for at a film point, mm; `None` where the
    /// film is dark.
    #[inline(always)]
    pub fn draw(&self, film: [f64; 2], disk: [f64; 2]) -> Option<Drawn> {
        let place = self.place(film, disk);
        if !place.inside {
            return if self.dark_beyond { None } else { Some(self.cover.draw(film, disk)) };
        }
        Some(self.drawn(&place, self.fetch(&place), film, disk))
    }

    /// [`WarpedPupil::draw`] of a block, the same to the last bit, in loops that are vectorised but for the table's
    /// look-ups. Where there is nothing to draw the area is NaN.
    #[inline(always)]
    pub(super) fn draw_block<const N: usize>(
        &self,
        film: &[[f64; N]; 2],
        disk: &[[f64; N]; 2],
        n: usize,
        places: &mut Places<N>,
        slopes: &mut [[f64; N]; 2],
        area: &mut [f64; N],
    ) {
        let n = n.min(N);
        let pair = |arrays: &[[f64; N]; 2], i: usize| [arrays[0][i], arrays[1][i]];
        let mut all_inside = true;
        for i in 0..n {
            let place = self.place(pair(film, i), pair(disk, i));
            all_inside &= place.inside;
            places.set(i, &place);
        }
        for i in 0..n {
            let numbers = self.fetch(&places.get(i));
            for (array, number) in places.fetched.iter_mut().zip(numbers) {
                array[i] = number;
            }
        }
        for i in 0..n {
            let numbers = std::array::from_fn(|k| places.fetched[k][i]);
            let drawn = self.drawn(&places.get(i), numbers, pair(film, i), pair(disk, i));
            [slopes[0][i], slopes[1][i]] = drawn.slopes;
            area[i] = drawn.area;
        }
        if all_inside {
            return;
        }
        const NONE: Drawn = Drawn { slopes: [0.0; 2], area: f64::NAN };
        for i in (0..n).filter(|&i| !(self.place(pair(film, i), pair(disk, i)).inside)) {
            let drawn = self.draw(pair(film, i), pair(disk, i)).unwrap_or(NONE);
            [slopes[0][i], slopes[1][i]] = drawn.slopes;
            area[i] = drawn.area;
        }
    }

    /// Where in the table a film point and a point of the disk lie.
    #[inline(always)]
    fn place(&self, [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Place {
        let t = (x * x + y * y).sqrt() * self.inverse_end;
        let s = if self.dark_beyond { 1.0 - (1.0 - t).sqrt() } else { t };
        // The disk's point in the frame of the film point, mirrored into the upper half.
        let (a, b) = (u * x + v * y, v * x - u * y);
        let inverse_span = (a.abs() + b.abs()).max(f64::MIN_POSITIVE).recip();
        let place = (1.0 - a * inverse_span) * (CELLS / 2) as f64;
        let knot = cell_of(place, CELLS);
        Place {
            inside: t < 1.0,
            s,
            cell: cell_of(s * FINE as f64, FINE),
            knot,
            offset: place - f64::from(knot),
            turn: (a * a + b * b) * inverse_span * inverse_span * (CELLS / 2) as f64,
            below: b < 0.0,
        }
    }

    /// The numbers of the table there: s and 1/width of the row, then of it and the next one the centre
    /// and the factors at two knots.
    #[inline(always)]
    fn fetch(&self, place: &Place) -> [f32; FETCHED] {
        let base = usize::from(self.cells[place.cell as usize]) * STRIDE;
        let rows = &self.table[base..base + 2 * STRIDE];
        let at = HEADER + 2 * place.knot as usize;
        let ([low, high], next) =
            ([&rows[at..at + 4], &rows[STRIDE + at..STRIDE + at + 4]], rows[STRIDE + 2]);
        [rows[0], rows[1], rows[2], next, low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]]
    }

    /// What these numbers make of them.
    #[inline(always)]
    fn drawn(&self, place: &Place, fetched: [f32; FETCHED], [x, y]: [f64; 2], [u, v]: [f64; 2]) -> Drawn {
        let Place { s, offset, turn, below, .. } = *place;
        let n = fetched.map(f64::from);
        let part = (s - n[0]) * n[1];
        let mix = |low: f64, high: f64| low + part * (high - low);
        let center = mix(n[2], n[3]);
        let [re0, im0, re1, im1] = [4, 5, 6, 7].map(|k| mix(n[k], n[k + 4]));
        let (re_step, im_step) = (re1 - re0, im1 - im0);
        let (re, im) = (re0 + offset * re_step, im0 + offset * im_step);
        let jacobian = re * re + im * im + (re * im_step - im * re_step) * turn;
        let im = if below { -im } else { im };
        Drawn { slopes: [center * x + re * u - im * v, center * y + re * v + im * u], area: PI * jacobian }
    }
}

/// Numbers of the table that a sample needs.
const FETCHED: usize = 12;

/// Where in the table a sample lies.
struct Place {
    /// Whether the table reaches so far.
    inside: bool,
    /// Along the film radius.
    s: f64,
    /// The number of its fine interval.
    cell: u32,
    /// The knot before the direction.
    knot: u32,
    /// From there to the direction, in knots.
    offset: f64,
    /// d(knots)/dφ.
    turn: f64,
    /// In the lower half, where the map is mirrored.
    below: bool,
}

/// Which of `cells` intervals of length 1 a number of [0, `cells`] lies in; at a border, either. Any of them for a
/// number outside and for NaN. In vectors, unlike a conversion, which has to care for NaN.
#[inline(always)]
fn cell_of(number: f64, cells: usize) -> u32 {
    // Numbers from 2^52 to 2^53 are whole, so that the sum's last bits are the number rounded.
    const SHIFT: f64 = 1.5 * (1_u64 << 52) as f64;
    ((number.max(0.0) - 0.5 + SHIFT).to_bits() as u32).min(cells as u32 - 1)
}

/// [`Place`] as structure of arrays, and the table's numbers there.
pub(super) struct Places<const N: usize> {
    s: [f64; N],
    cell: [u32; N],
    knot: [u32; N],
    offset: [f64; N],
    turn: [f64; N],
    below: [f32; N],
    fetched: [[f32; N]; FETCHED],
}

impl<const N: usize> Places<N> {
    pub fn new() -> Self {
        let (zero, single, whole) = ([0.0; N], [0.0; N], [0; N]);
        Self {
            s: zero,
            cell: whole,
            knot: whole,
            offset: zero,
            turn: zero,
            below: single,
            fetched: [single; FETCHED],
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, place: &Place) {
        self.s[i] = place.s;
        self.cell[i] = place.cell;
        self.knot[i] = place.knot;
        self.offset[i] = place.offset;
        self.turn[i] = place.turn;
        self.below[i] = if place.below { 1.0 } else { 0.0 };
    }

    #[inline(always)]
    fn get(&self, i: usize) -> Place {
        Place {
            inside: true,
            s: self.s[i],
            cell: self.cell[i],
            knot: self.knot[i],
            offset: self.offset[i],
            turn: self.turn[i],
            below: self.below[i] != 0.0,
        }
    }
}

fn push(table: &mut Vec<f32>, row: &Row, s: f64, inverse_width: f64) {
    table.extend([s as f32, inverse_width as f32, row.center as f32, 0.0]);
    table.extend(row.factors.iter().flatten().map(|&x| x as f32));
}
