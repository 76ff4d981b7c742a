//! The pupil of a film point as tracing finds it: a test of points of a plane in, the upper half of the open region's
//! outline out.
//!
//! The film point lies on +x, so that the region is symmetric about the x axis.

use realistic::unstable::numeric::edge;
use std::f64::consts::PI;

/// The outline above the x axis.
#[derive(Clone, Debug)]
pub struct Region {
    /// From the greatest x counter-clockwise to the least.
    points: Vec<[f64; 2]>,
}

/// Where the region is looked for: x from and to, y up to.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub x: [f64; 2],
    pub y: f64,
}

/// Cells across the frame in looking for the region, and again where that finds none.
const CELLS: [usize; 2] = [32, 96];
/// Directions from its centre, over half a turn.
const DIRECTIONS: usize = 112;
/// Steps along a direction in looking for the edge.
const STEPS: u32 = 24;
/// To which share of the frame the edge is found.
const WIDTH: f64 = 1e-8;
/// How much the frame of the next region is wider than this one.
const ROOM: f64 = 0.6;

impl Region {
    /// The region of points that pass, in the frame; `None` where there are none.
    pub fn find(frame: Frame, passes: impl Fn([f64; 2]) -> bool) -> Option<Self> {
        let center = CELLS.iter().find_map(|&cells| center(frame, cells, &passes))?;
        let size = frame.x[1] - frame.x[0] + frame.y;
        let points = (0..=DIRECTIONS).map(|i| {
            let (sin, cos) = (PI * i as f64 / DIRECTIONS as f64).sin_cos();
            let at = |radius: f64| [center + radius * cos, radius * sin];
            let to_side = if cos > 0.0 { frame.x[1] - center } else { center - frame.x[0] } / cos.abs();
            let end = to_side.min(frame.y / sin);
            let step = |i: u32| end * f64::from(i) / f64::from(STEPS);
            // From outside, so that nothing open is left out.
            let last = (0..=STEPS).rev().find(|&i| passes(at(step(i))));
            let radius = match last {
                Some(STEPS) => end,
                Some(last) => edge(step(last), step(last + 1), WIDTH * size, |radius| passes(at(radius))),
                None => 0.0,
            };
            at(radius)
        });
        Some(Self { points: points.collect() })
    }

    /// The least and the greatest x.
    pub fn reach(&self) -> [f64; 2] {
        let all = || self.points.iter().map(|point| point[0]);
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// The greatest y at x; `None` beside the region.
    pub fn height(&self, x: f64) -> Option<f64> {
        let crossings = self.points.windows(2).filter_map(|pair| {
            let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
            if !(x0.min(x1) <= x && x <= x0.max(x1)) {
                return None;
            }
            Some(if x0 == x1 { y0.max(y1) } else { y0 + (x - x0) / (x1 - x0) * (y1 - y0) })
        });
        crossings.reduce(f64::max)
    }

    /// Where the region of a film point nearby is to be looked for.
    pub fn frame(&self) -> Frame {
        let [from, to] = self.reach();
        let height = self.points.iter().map(|point| point[1]).fold(0.0, f64::max);
        let room = ROOM * (to - from).max(0.5 * height);
        Frame { x: [from - room, to + room], y: height + room }
    }
}

/// x of the middle of the open cells.
fn center(frame: Frame, cells: usize, passes: impl Fn([f64; 2]) -> bool) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for i in 0..cells {
        let x = frame.x[0] + (frame.x[1] - frame.x[0]) * (i as f64 + 0.5) / cells as f64;
        // Half as many above the axis as across, the first of them on it.
        for j in 0..cells / 2 {
            if passes([x, frame.y * j as f64 / (cells / 2) as f64]) {
                sum += x;
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lens_shaped_region_has_the_heights_of_its_two_circles() {
        let passes = |[x, y]: [f64; 2]| (x - 1.0).hypot(y) < 2.0 && (x + 1.0).hypot(y) < 2.0;
        let region = Region::find(Frame { x: [-3.0, 3.0], y: 3.0 }, passes).expect("open");
        let [from, to] = region.reach();
        assert!((from + 1.0).abs() < 1e-6 && (to - 1.0).abs() < 1e-6, "{from} {to}");
        for x in [-0.9, -0.5, 0.0, 0.3, 0.8_f64] {
            let wanted = (4.0 - (x.abs() + 1.0).powi(2)).sqrt();
            let found = region.height(x).expect("inside");
            assert!((found - wanted).abs() < 2e-3, "{x}: {found} {wanted}");
        }
        assert_eq!(region.height(1.1), None);
        assert!(Region::find(Frame { x: [1.5, 3.0], y: 3.0 }, passes).is_none());
    }
}
