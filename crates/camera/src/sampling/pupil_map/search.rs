//! Searches in the plane of a pencil, for the rectangle that a pupil fills and for the ends of the pupil's
//! rows. Every step traces full vectors of rays. The magnitude of an excess matters only in steps before any
//! ray passes; after that, only its sign matters.

use super::pencil::Pencil;

/// Numbers of columns and rows of a mesh of rays. Finer meshes find thinner pupils but take longer.
const MESH: [usize; 2] = [23, 11];
/// A pupil's rectangle is known when the pupil fills 1/`FILLED` of a mesh in each direction. Larger shares
/// find thinner tips.
const FILLED: usize = 3;
/// Maximum number of meshes per search. Each mesh is about six times as fine as its predecessor.
const MESHES: usize = 14;
/// `LESS` is the fraction by which a finer mesh must reduce the smallest excess to count as progress. `IDLE`
/// is the number of consecutive meshes without progress that the search tolerates; more find narrower pupils.
const LESS: f64 = 1e-3;
const IDLE: usize = 2;
/// Numbers of columns and rows of the meshes in the search for a tip, and the number of these meshes. Each
/// mesh is seven times as fine in y as the previous one, so the last step is about 1e-6 of the pupil.
const TIP_MESH: [usize; 2] = [12, 8];
const TIP_MESHES: usize = 6;
/// Number of rays along a row at the start. More rays find narrower parts of the row.
const ALONG: usize = 13;
/// Maximum number of steps in the search for the end of a row, which usually takes six.
const STEPS: usize = 60;

/// A rectangle of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    pub x: [f64; 2],
    pub y: [f64; 2],
}

impl Window {
    /// Returns the centre.
    pub fn middle(&self) -> [f64; 2] {
        [self.x, self.y].map(|[low, high]| f64::midpoint(low, high))
    }
}

/// The traced ray that passes deepest inside the apertures or, if none passes, nearest to them.
#[derive(Clone, Copy, Debug)]
pub struct NearestPoint {
    pub at: [f64; 2],
    pub excess: f64,
}

/// A mesh of rays at the crossings of lines.
struct Mesh {
    x: Vec<f64>,
    y: Vec<f64>,
    excess: Vec<f64>,
}

/// Returns `count` numbers at equal steps, both ends included.
fn even([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
}

impl Mesh {
    fn new(pencil: &impl Pencil, x: Vec<f64>, y: Vec<f64>) -> Self {
        let points: Vec<[f64; 2]> = y.iter().flat_map(|&y| x.iter().map(move |&x| [x, y])).collect();
        let excess = pencil.excesses(&points);
        Self { x, y, excess }
    }

    /// Returns a mesh over the whole cover, with lines at equal steps of asinh((x - guess)/size), which are
    /// dense around the guess.
    fn whole(pencil: &impl Pencil, is_symmetric: bool) -> Self {
        let (cover, guess) = (pencil.cover(), pencil.guess());
        let lines = |axis: usize, count: usize| -> Vec<f64> {
            let [low, high] = [-1.0, 1.0].map(|side| cover.center[axis] + side * cover.radius);
            let low = if axis == 1 && is_symmetric { 0.0 } else { low };
            let size =
                if guess.radius.is_finite() { guess.radius.clamp(0.0, cover.radius) } else { cover.radius };
            let size = size.max(1e-6 * cover.radius);
            let middle =
                if guess.center[axis].is_finite() { guess.center[axis].clamp(low, high) } else { low };
            let ends = [low, high].map(|end| ((end - middle) / size).asinh());
            even(ends, count).into_iter().map(|step| middle + size * step.sinh()).collect()
        };
        Self::new(pencil, lines(0, MESH[0]), lines(1, rows(is_symmetric)))
    }

    fn over(pencil: &impl Pencil, window: Window, is_symmetric: bool) -> Self {
        Self::new(pencil, even(window.x, MESH[0]), even(window.y, rows(is_symmetric)))
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.excess[j * self.x.len() + i]
    }

    /// Returns, for each direction, the first and the last line on which rays get through.
    fn passing(&self) -> Option<[[usize; 2]; 2]> {
        let mut ends: Option<[[usize; 2]; 2]> = None;
        for (number, _) in self.excess.iter().enumerate().filter(|(_, excess)| **excess <= 0.0) {
            let lines = [number % self.x.len(), number / self.x.len()];
            let ends = ends.get_or_insert(lines.map(|line| [line; 2]));
            for ([low, high], line) in ends.iter_mut().zip(lines) {
                (*low, *high) = ((*low).min(line), (*high).max(line));
            }
        }
        ends
    }

    /// Returns the column and row of the smallest excess.
    fn least(&self) -> [usize; 2] {
        let least = (0..self.excess.len()).min_by(|&p, &q| self.excess[p].total_cmp(&self.excess[q]));
        let least = least.unwrap_or(0);
        [least % self.x.len(), least / self.x.len()]
    }

    fn nearest(&self) -> NearestPoint {
        let [i, j] = self.least();
        NearestPoint { at: [self.x[i], self.y[j]], excess: self.at(i, j) }
    }

    /// Returns the interval from `beyond` lines before the first of two given lines to `beyond` lines after
    /// the last; where there are no more lines, extrapolates at equal steps.
    fn around(lines: &[f64], [low, high]: [usize; 2], beyond: usize) -> [f64; 2] {
        let last = lines.len() - 1;
        let line = |index: isize| {
            let inside = index.clamp(0, last as isize);
            let step = if index < 0 { lines[1] - lines[0] } else { lines[last] - lines[last - 1] };
            lines[inside as usize] + step * (index - inside) as f64
        };
        [line(low as isize - beyond as isize), line((high + beyond) as isize)]
    }

    /// Returns the next rectangle to search, which extends `beyond` lines beyond the given lines. On a side
    /// where a given line is already the outermost, the rectangle extends by the whole mesh.
    fn next(&self, [x, y]: [[usize; 2]; 2], beyond: usize, is_symmetric: bool) -> Window {
        let side = |lines: &[f64], [low, high]: [usize; 2]| {
            let last = lines.len() - 1;
            let [from, _] = Self::around(lines, [low, high], if low == 0 { last } else { beyond });
            let [_, to] = Self::around(lines, [low, high], if high == last { last } else { beyond });
            [from, to]
        };
        let [bottom, top] = side(&self.y, y);
        Window { x: side(&self.x, x), y: [if is_symmetric { bottom.max(0.0) } else { bottom }, top] }
    }
}

/// Returns the number of rows of a mesh; a mesh on both sides of the x axis has twice as many as one on a
/// single side.
fn rows(is_symmetric: bool) -> usize {
    if is_symmetric { MESH[1] } else { 2 * MESH[1] }
}

/// Finds the rectangle that the pupil fills, or the ray that comes closest to getting through.
pub fn pupil(pencil: &impl Pencil, is_symmetric: bool, seed: Option<Window>) -> Result<Window, NearestPoint> {
    let mesh = search(pencil, is_symmetric, seed);
    mesh.passing().map(|lines| with_tips(pencil, is_symmetric, &mesh, lines)).ok_or_else(|| mesh.nearest())
}

/// Finds the ray of a pencil that passes deepest inside the apertures or, if none passes, nearest to them.
pub fn nearest(pencil: &impl Pencil, is_symmetric: bool, seed: Option<Window>) -> NearestPoint {
    search(pencil, is_symmetric, seed).nearest()
}

/// Searches the whole plane for the pupil; if none is found, also searches around `seed`, the window of a
/// neighbour. Returns a mesh that the pupil fills, or a mesh around the ray that comes closest to getting
/// through.
fn search(pencil: &impl Pencil, is_symmetric: bool, seed: Option<Window>) -> Mesh {
    let found = zoom(pencil, is_symmetric, Mesh::whole(pencil, is_symmetric));
    let Some(seed) = seed.filter(|_| found.passing().is_none()) else { return found };
    let near = zoom(pencil, is_symmetric, Mesh::over(pencil, seed, is_symmetric));
    if near.nearest().excess <= found.nearest().excess { near } else { found }
}

/// Replaces a mesh by finer and finer meshes, around the rays that get through or around the smallest excess.
fn zoom(pencil: &impl Pencil, is_symmetric: bool, mut mesh: Mesh) -> Mesh {
    let (mut least, mut idle) = (f64::INFINITY, 0);
    for _ in 0..MESHES {
        let (lines, beyond) = if let Some(lines) = mesh.passing() {
            let [x, y] = lines;
            let fills = |[low, high]: [usize; 2], of: &[f64]| (high - low) * FILLED >= of.len() - 1;
            let is_cut = x[0] == 0
                || x[1] == mesh.x.len() - 1
                || y[1] == mesh.y.len() - 1
                || (!is_symmetric && y[0] == 0);
            if fills(x, &mesh.x) && fills(y, &mesh.y) && !is_cut {
                break;
            }
            (lines, 1)
        } else {
            let excess = mesh.nearest().excess;
            idle = if least - excess > LESS * excess { 0 } else { idle + 1 };
            least = least.min(excess);
            if !excess.is_finite() || idle > IDLE {
                break;
            }
            // The next mesh extends to twice the distance of the adjacent lines, because the minimum may lie
            // in a valley between lines.
            (mesh.least().map(|line| [line; 2]), 2)
        };
        mesh = Mesh::over(pencil, mesh.next(lines, beyond, is_symmetric), is_symmetric);
    }
    mesh
}

/// Returns the rectangle of a pupil, including its tips, given a mesh that the pupil fills.
fn with_tips(pencil: &impl Pencil, is_symmetric: bool, mesh: &Mesh, [x, y]: [[usize; 2]; 2]) -> Window {
    let row = |j: usize| {
        let passing = (0..mesh.x.len()).filter(|&i| mesh.at(i, j) <= 0.0);
        let ends = passing.fold([usize::MAX, 0], |[low, high], i| [low.min(i), high.max(i)]);
        Mesh::around(&mesh.x, ends, 1)
    };
    let line = |j: usize, next: isize| Mesh::around(&mesh.y, [j, j], 1)[usize::from(next > 0)];
    let top = tip(pencil, row(y[1]), [mesh.y[y[1]], line(y[1], 1)]);
    let bottom = if is_symmetric { 0.0 } else { tip(pencil, row(y[0]), [mesh.y[y[0]], line(y[0], -1)]) };
    Window { x: Mesh::around(&mesh.x, x, 1), y: [bottom, top] }
}

/// Returns the y beyond which no ray gets through. It lies between `lit`, a row on which some rays get
/// through, and `dark`, a row on which none was found; `x` is the interval around the rays that get through.
fn tip(pencil: &impl Pencil, mut x: [f64; 2], [mut lit, mut dark]: [f64; 2]) -> f64 {
    for _ in 0..TIP_MESHES {
        let mesh = Mesh::new(pencil, even(x, TIP_MESH[0]), even([lit, dark], TIP_MESH[1]));
        let last = mesh.passing().map(|[_, [_, last]]| last);
        let row = last.unwrap_or(0);
        let lines: Vec<usize> = match last {
            Some(last) => (0..TIP_MESH[0]).filter(|&i| mesh.at(i, last) <= 0.0).collect(),
            None => {
                vec![(0..TIP_MESH[0]).min_by(|&p, &q| mesh.at(p, 0).total_cmp(&mesh.at(q, 0))).unwrap_or(0)]
            }
        };
        x = Mesh::around(&mesh.x, [lines[0], lines[lines.len() - 1]], 2);
        let next = Mesh::around(&mesh.y, [row, row], 1)[1];
        (lit, dark) = (mesh.y[row], if row == TIP_MESH[1] - 1 { next + (next - lit) } else { next });
    }
    dark
}

/// Finds the ends of rows within the x range of a window: for each y, the first and the last x between which
/// rays get through, to within `accuracy`; `None` if no such ray was found.
pub fn row_ends(
    pencil: &impl Pencil,
    y: &[f64],
    [low, high]: [f64; 2],
    accuracy: f64,
) -> Vec<Option<[f64; 2]>> {
    /// A row under search, sampled by rays at equal steps. Records the rays that get through or, if none
    /// does, the ray that comes closest.
    struct FoundRow {
        from: f64,
        step: f64,
        excess: Vec<f64>,
    }
    let mut found: Vec<Option<FoundRow>> = y.iter().map(|_| None).collect();
    let mut open: Vec<(usize, [f64; 2])> = (0..y.len()).map(|j| (j, [low, high])).collect();
    for _ in 0..MESHES {
        let points: Vec<[f64; 2]> = open
            .iter()
            .flat_map(|&(j, range)| even(range, ALONG).into_iter().map(move |x| [x, y[j]]))
            .collect();
        let excess = pencil.excesses(&points);
        let mut next = Vec::new();
        for (&(j, [from, to]), excess) in open.iter().zip(excess.chunks(ALONG)) {
            let step = (to - from) / (ALONG - 1) as f64;
            if excess.iter().any(|&excess| excess <= 0.0) {
                found[j] = Some(FoundRow { from, step, excess: excess.to_vec() });
                continue;
            }
            // The minimum lies next to the lowest sample, because along a row an excess usually decreases and
            // then increases.
            let least = (0..ALONG).min_by(|&p, &q| excess[p].total_cmp(&excess[q])).unwrap_or(0);
            if excess[least].is_finite() && step > 1e-9 * (high - low) {
                let middle = from + step * least as f64;
                next.push((j, [middle - step, middle + step]));
            }
        }
        open = next;
        if open.is_empty() {
            break;
        }
    }
    let ends = |row: &FoundRow| {
        let passing: Vec<usize> = (0..ALONG).filter(|&i| row.excess[i] <= 0.0).collect();
        let x = |i: isize| row.from + row.step * i as f64;
        let excess = |i: isize| row.excess.get(i as usize).copied().unwrap_or(f64::NAN);
        let end = |i: usize, side: isize| {
            let (inside, outside) = (i as isize, i as isize + side);
            SearchEnd::new([x(inside), excess(inside)], [x(outside), excess(outside)])
        };
        [end(passing[0], -1), end(passing[passing.len() - 1], 1)]
    };
    let lit: Vec<usize> = (0..y.len()).filter(|&j| found[j].is_some()).collect();
    let mut all: Vec<(f64, SearchEnd)> = lit
        .iter()
        .flat_map(|&j| found[j].as_ref().map(ends).into_iter().flatten().map(move |end| (y[j], end)))
        .collect();
    narrow(pencil, &mut all, accuracy);
    let mut rows = vec![None; y.len()];
    for (&j, ends) in lit.iter().zip(all.chunks(2)) {
        rows[j] = Some([ends[0].1.outside[0], ends[1].1.outside[0]]);
    }
    rows
}

/// An end of a row, bracketed by an x at which a ray gets through and an x at which a ray does not. Each x is
/// stored with its excess, which is NaN if it is not known yet.
pub struct SearchEnd {
    pub inside: [f64; 2],
    pub outside: [f64; 2],
    /// Positive if the last step moved the outside bound, negative if it moved the inside bound.
    last: f64,
}

impl SearchEnd {
    pub fn new(inside: [f64; 2], outside: [f64; 2]) -> Self {
        Self { inside, outside, last: 0.0 }
    }

    pub fn width(&self) -> f64 {
        (self.outside[0] - self.inside[0]).abs()
    }

    /// Returns the x to trace next, by linear interpolation of the excesses, or halfway if an excess is
    /// unknown and at every third step.
    pub fn next(&self, step: usize) -> f64 {
        let ([from, inside], [to, outside]) = (self.inside, self.outside);
        if outside.is_nan() {
            return to;
        }
        let part = if step % 3 == 2 || !outside.is_finite() { 0.5 } else { inside / (inside - outside) };
        from + part.clamp(0.02, 0.98) * (to - from)
    }

    /// Updates the bracket with the excess at `x`. If the same bound stays for a second time, its excess is
    /// halved (the Illinois algorithm: M. Dowell and P. Jarratt 1971).
    pub fn learn(&mut self, x: f64, excess: f64) {
        if excess > 0.0 {
            if self.last > 0.0 {
                self.inside[1] /= 2.0;
            }
            (self.outside, self.last) = ([x, excess], 1.0);
        } else if self.outside[1].is_nan() {
            // The row continues beyond the searched part.
            let step = x - self.inside[0];
            (self.inside, self.outside) = ([x, excess], [x + 2.0 * step, f64::NAN]);
        } else {
            if self.last < 0.0 {
                self.outside[1] /= 2.0;
            }
            (self.inside, self.last) = ([x, excess], -1.0);
        }
    }
}

/// Narrows the brackets of the ends of rows down to an accuracy, all side by side.
fn narrow(pencil: &impl Pencil, ends: &mut [(f64, SearchEnd)], accuracy: f64) {
    for step in 0..STEPS {
        let open = |(_, end): &&mut (f64, SearchEnd)| end.width() > accuracy || end.outside[1].is_nan();
        let mut open: Vec<&mut (f64, SearchEnd)> = ends.iter_mut().filter(open).collect();
        if open.is_empty() {
            return;
        }
        let points: Vec<[f64; 2]> = open.iter().map(|(y, end)| [end.next(step), *y]).collect();
        for ((end, point), excess) in open.iter_mut().zip(&points).zip(pencil.excesses(&points)) {
            end.1.learn(point[0], excess);
        }
    }
}
