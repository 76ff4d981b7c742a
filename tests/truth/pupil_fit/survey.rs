//! The true pupil of a film point, by brute force: whether any light passes, the number of components, and whether it
//! is star-shaped.

use super::Case;

/// Cells across the square that contains the pupil; half as many down, since the pupil is symmetric about the x axis.
const ACROSS: usize = 160;
const DOWN: usize = ACROSS / 2;
/// Points tried as the centre of a star-shaped pupil.
const CENTERS: usize = 24;
/// Half-lines from each centre, over half a turn.
const HALF_LINES: usize = 180;

/// A pupil as a grid of open and blocked cells.
#[derive(Clone, Debug)]
pub struct Survey {
    cells: Vec<bool>,
    /// In slopes: the sx of the first column's left side, and a cell's width.
    left: f64,
    cell: f64,
}

/// The classification of a pupil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pupil {
    /// No ray of the survey passes.
    Dark,
    /// One component; from some point, every half-line leaves it once.
    StarShaped,
    /// One component of another shape, or with a hole.
    OtherShape,
    /// More than one component.
    Disconnected,
}

impl Survey {
    /// Surveys the pupil of the film point (`height`, 0).
    pub fn of(case: &Case, height: f64) -> Self {
        let cover = case.cover.seen_from([height, 0.0]);
        let mut survey = Self::within(case, height, cover.center[0], cover.radius);
        // Zoom in if the pupil is small.
        for _ in 0..4 {
            let Some([left, right, top]) = survey.bounds() else { break };
            let half = ((right - left) / 2.0).max(top) + survey.cell;
            if half > 0.8 * survey.half() {
                break;
            }
            survey = Self::within(case, height, f64::midpoint(left, right), half);
        }
        survey
    }

    fn within(case: &Case, height: f64, center: f64, half: f64) -> Self {
        let (left, cell) = (center - half, 2.0 * half / ACROSS as f64);
        let passes = |i: usize| {
            let [x, y] = [i % ACROSS, i / ACROSS].map(|k| (k as f64 + 0.5) * cell);
            case.passes([height, 0.0], [left + x, y])
        };
        Self { cells: (0..ACROSS * DOWN).map(passes).collect(), left, cell }
    }

    fn half(&self) -> f64 {
        self.cell * DOWN as f64
    }

    /// Returns the least and greatest sx and the greatest sy of the open cells.
    fn bounds(&self) -> Option<[f64; 3]> {
        let lit = (0..self.cells.len()).filter(|&i| self.cells[i]);
        let [first, last, top] = lit.fold([ACROSS, 0, 0], |[first, last, top], i| {
            [first.min(i % ACROSS), last.max(i % ACROSS + 1), top.max(i / ACROSS + 1)]
        });
        let x = |column: usize| self.left + self.cell * column as f64;
        (first < last).then(|| [x(first), x(last), self.cell * top as f64])
    }

    /// Returns the share of open cells that lie more than two cells outside the map of the film point (`height`, 0).
    pub fn beside_the_map(&self, case: &Case, height: f64) -> f64 {
        const SECTORS: usize = 720;
        let point = [height, 0.0];
        let at = |disk: [f64; 2]| case.pupil.sample(point, disk).map(|sample| sample.slopes);
        let Some(center) = at([0.0; 2]) else { return 1.0 };
        // Largest distance of the map's edge from the centre, by angle.
        let mut farthest = [0.0_f64; SECTORS];
        for i in 0..4 * SECTORS {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / (4 * SECTORS) as f64).sin_cos();
            let Some([x, y]) = at([cos, sin]) else { return 1.0 };
            let (x, y) = (x - center[0], y - center[1]);
            let angle = y.atan2(x) / std::f64::consts::TAU + 1.0;
            let sector = (angle * SECTORS as f64) as usize;
            for neighbour in [sector, sector + 1, sector + SECTORS - 1] {
                farthest[neighbour % SECTORS] = farthest[neighbour % SECTORS].max(x.hypot(y));
            }
        }
        let (mut lit, mut beside) = (0, 0);
        for i in (0..self.cells.len()).filter(|&i| self.cells[i]) {
            let [x, y] = [i % ACROSS, i / ACROSS].map(|k| (k as f64 + 0.5) * self.cell);
            let x = self.left + x - center[0];
            let angle = y.atan2(x) / std::f64::consts::TAU + 1.0;
            lit += 1;
            beside += usize::from(
                x.hypot(y) > farthest[(angle * SECTORS as f64) as usize % SECTORS] + 2.0 * self.cell,
            );
        }
        f64::from(beside as u32) / f64::from(lit.max(1) as u32)
    }

    /// Classifies the pupil by its cells.
    pub fn pupil(&self) -> Pupil {
        let lit = self.cells.iter().filter(|&&lit| lit).count();
        let Some(start) = (0..self.cells.len()).find(|&i| self.cells[i]) else { return Pupil::Dark };
        // A component off the axis of symmetry has a mirrored twin. `find` begins in the row next to that axis.
        if start >= ACROSS || self.filled(start) < lit {
            return Pupil::Disconnected;
        }
        let beginning = (0..ACROSS).filter(|&i| self.cells[i]);
        let (first, last) = beginning.fold((ACROSS, 0), |(first, last), i| (first.min(i), last.max(i)));
        let centers = (0..CENTERS).map(|k| {
            let part = (k as f64 + 0.5) / CENTERS as f64;
            first as f64 + 0.5 + part * (last - first) as f64
        });
        if centers.into_iter().any(|center| self.is_star_shaped_about(center)) {
            Pupil::StarShaped
        } else {
            Pupil::OtherShape
        }
    }

    /// Counts the cells of the same state as `start` that are connected to it by edges and corners.
    fn filled(&self, start: usize) -> usize {
        let mut seen = vec![false; self.cells.len()];
        let (mut open, mut count) = (vec![start], 0);
        seen[start] = true;
        while let Some(i) = open.pop() {
            count += 1;
            let (column, row) = (i % ACROSS, i / ACROSS);
            for (dx, dy) in (-1..=1).flat_map(|dx: i32| (-1..=1).map(move |dy: i32| (dx, dy))) {
                let (x, y) = (column as i32 + dx, row as i32 + dy);
                let inside = (0..ACROSS as i32).contains(&x) && (0..DOWN as i32).contains(&y);
                if inside {
                    let next = y as usize * ACROSS + x as usize;
                    if self.cells[next] == self.cells[start] && !seen[next] {
                        seen[next] = true;
                        open.push(next);
                    }
                }
            }
        }
        count
    }

    /// Whether each half-line from a point on the axis of symmetry leaves the open region once, to within a cell or
    /// two.
    fn is_star_shaped_about(&self, center: f64) -> bool {
        let lit = |x: f64, y: f64| {
            let inside = x >= 0.0 && y >= 0.0 && x < ACROSS as f64 && y < DOWN as f64;
            inside && self.cells[y as usize * ACROSS + x as usize]
        };
        (0..HALF_LINES).all(|i| {
            let (dy, dx) = (std::f64::consts::PI * (i as f64 + 0.5) / HALF_LINES as f64).sin_cos();
            // Runs of half cells of the other state.
            let (mut gap, mut again) = (0, 0);
            for k in 0..2 * ACROSS + DOWN {
                let r = 0.5 * k as f64;
                if lit(center + r * dx, r * dy) {
                    again = if gap > 3 { again + 1 } else { 0 };
                    gap = if gap > 3 { gap } else { 0 };
                    if again > 3 {
                        return false;
                    }
                } else {
                    gap += 1;
                }
            }
            true
        })
    }
}
