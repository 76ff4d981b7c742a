//! The first row, in the plane of symmetry, followed outward to the end of what is asked for or to the image's.

use super::{
    outline::{first_row, row_in},
    pencil::{Excess, Family, Pencil},
};
use crate::lens::pupil::SlopeDisk;

/// Steps to the film's reach at least: more take more rays, fewer may step over a jump.
const STEPS: f64 = 16.0;
/// How much farther than the film's reach the image's end is sought.
pub(super) const BEYOND: f64 = 1.125;
/// Relative accuracy of the image's end, beyond which it has to be dark: more may leave out light there, less takes more steps.
const ACCURACY: f64 = 1e-9;
/// The part of the way to where the row's width would come to 0 that the next step goes: more overshoots, less takes more steps.
const NEARER: f64 = 0.6;
/// Rays across the rear disk in search of light beyond the image's end, and radii at which they are: more take longer, fewer may miss
/// it.
const GRID: u32 = 20;
const RADII: u32 = 6;

/// The first row's edges at film radii.
#[derive(Clone, Debug)]
pub(crate) struct Trail {
    known: Vec<(f64, [f64; 2])>,
    /// Where the image ends, if it does within [`BEYOND`] of the film's reach.
    pub end: Option<f64>,
}

impl Trail {
    /// Follows the row; `None` where no light gets through on the axis.
    pub fn new<F: Family>(side: &F) -> Option<Self> {
        let anywhere = |height: f64| {
            let SlopeDisk { center: [center, _], radius } = side.cover(height);
            row_in(&side.pencil(height), [center - radius, center + radius])
        };
        let quarter = 0.25 * side.cover(0.0).radius;
        let first = first_row(&side.pencil(0.0), [-quarter, quarter]).or_else(|| anywhere(0.0))?;
        let mut trail = Self { known: vec![(0.0, first)], end: None };
        while let Some(end) = trail.follow(side) {
            // Something else may get through there, or farther out.
            let beside = end * (1.0 + ACCURACY);
            match anywhere(beside) {
                Some(row) => trail.known.push((beside, row)),
                None if !F::ENDS && leaks_beyond(side, end) => break,
                None => {
                    trail.end = Some(end);
                    break;
                }
            }
        }
        Some(trail)
    }

    /// Goes on to a little beyond the film's reach, or to where the row ends or jumps, if it does so before.
    fn follow(&mut self, side: &impl Family) -> Option<f64> {
        let (reach, shift) = (side.reach(), side.shift());
        let widest = reach / STEPS;
        let mut step = widest / 16.0;
        while self.last().0 < reach * BEYOND && !side.work().is_spent() {
            let (from, row) = self.last();
            let height = (from + step).min(reach * BEYOND);
            let expected = if from > 0.0 { self.at(height) } else { row.map(|edge| edge + shift * height) };
            if let Some(found) =
                first_row(&side.pencil(height), expected).filter(|found| is_near(*found, expected))
            {
                self.known.push((height, found));
                let left = self.left();
                if left < ACCURACY * height {
                    return Some(height + left);
                }
                step = (2.0 * step).min(widest).min(NEARER * left);
            } else if step > ACCURACY * from.max(ACCURACY * reach) {
                step /= 3.0;
            } else {
                return Some(from);
            }
        }
        None
    }

    fn last(&self) -> (f64, [f64; 2]) {
        self.known[self.known.len() - 1]
    }

    /// How much farther out the row's width comes to 0 if it goes on as it went last; infinite where it does not shrink.
    fn left(&self) -> f64 {
        let [.., (from, before), (to, row)] = self.known[..] else { return f64::INFINITY };
        let [first, last] = [before, row].map(|[low, high]| high - low);
        let rate = (first - last) / (to - from);
        if rate > 0.0 { last / rate } else { f64::INFINITY }
    }

    /// The edges expected at a film radius.
    pub fn at(&self, height: f64) -> [f64; 2] {
        // Of film without width, and where the rays are spent at once, one row is known.
        let next = self.known.partition_point(|known| known.0 < height).max(1).min(self.known.len() - 1);
        let ((from, a), (to, b)) = (self.known[next.saturating_sub(1)], self.known[next]);
        let part = if to > from { (height - from) / (to - from) } else { 0.0 };
        let [low, high] = [0, 1].map(|i| a[i] + part * (b[i] - a[i]));
        // Beyond the last one the row may shrink, and stays one.
        let (middle, half) = (f64::midpoint(low, high), ((high - low) / 2.0).max(0.05 * (b[1] - b[0])));
        [middle - half, middle + half]
    }

    /// The pupil's radius on the axis.
    pub fn axial_radius(&self) -> f64 {
        let [low, high] = self.known[0].1;
        (high - low) / 2.0
    }
}

/// Whether a row is about where it was expected, its middle within that one and at most three times as wide or narrow;
/// another may be something else.
fn is_near(found: [f64; 2], expected: [f64; 2]) -> bool {
    let [middle, other] = [found, expected].map(|[low, high]| f64::midpoint(low, high));
    let [width, expected] = [found, expected].map(|[low, high]| high - low);
    (middle - other).abs() < expected / 2.0 && width < 3.0 * expected && expected < 3.0 * width
}

/// Whether light gets through anywhere within reach beyond the radius at which the first row ends.
fn leaks_beyond(side: &impl Family, end: f64) -> bool {
    (1..=RADII).any(|k| {
        let height = end + (side.reach() - end) * f64::from(k) / f64::from(RADII);
        let points = half_disk(GRID, side.cover(height));
        height > end && side.pencil(height).excesses(&points).iter().any(Excess::passes)
    })
}

/// A grid of `across` by `across` on a disk's upper half, the disk's centre being on the sx axis.
pub(super) fn half_disk(across: u32, disk: SlopeDisk) -> Vec<[f64; 2]> {
    let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(across) - 1.0;
    let grid = (0..across).flat_map(|i| (across / 2..across).map(move |j| [at(i), at(j)]));
    let within = grid.filter(|[x, y]| x * x + y * y <= 1.0);
    within.map(|[x, y]| [disk.center[0] + disk.radius * x, disk.radius * y]).collect()
}
