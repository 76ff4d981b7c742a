//! Where along the film radius the pupil vanishes: the lens and how far the film reaches in, the radius from which on no
//! light arrives and the slope at which the last of it does out. The pupil is followed outward along the meridian, the
//! plane of axis and film point.

use std::cell::Cell;

use super::{
    illinois::illinois,
    meridian::first_look,
    pieces::half_disk,
    view::{Tracer, View},
};
use crate::sampling::pupil_disk::PupilDisk;

/// Steps outward up to the film's reach.
const STEPS: usize = 8;
/// Searches between two of them: each but the last one ends where the pupil was lost from sight.
const SEARCHES: u32 = 9;
/// Relative accuracy of the radius.
const ACCURACY: f64 = 1e-9;
/// How far beyond the radius at which a pupil seems to vanish it has to be dark, too, relative.
const BESIDE: f64 = 1e-6;
/// Slopes on the meridian that are tried there.
const SLOPES: u32 = 256;

/// What is searched.
pub(crate) struct Field<'a> {
    pub tracer: &'a Tracer,
    /// Largest film radius asked for, mm.
    pub reach: f64,
    /// A disk that holds every pupil.
    pub cover: PupilDisk,
    /// Film radius times this is about the slope to the pupil's centre.
    pub shift: f64,
    /// Radius of the pupil on the axis, in slope; infinite where it is not known.
    pub radius: f64,
}

/// Where the pupil has shrunk to a point.
pub(crate) struct Vanishing {
    /// Film radius, mm.
    pub height: f64,
    /// The point's slope over the film radius, 1/mm.
    pub center: f64,
}

/// The way of the pupil's innermost ray along the film, as far as it has been followed.
#[derive(Clone, Copy)]
struct Trail {
    /// Film radius, mm, and slope at the end.
    height: f64,
    slope: f64,
    /// How much the slope changes per mm of film radius.
    change: f64,
    /// How far around what is expected it is sought first.
    width: f64,
}

impl Trail {
    /// Relative step of film radius over which a change of slope is more than what a search leaves open.
    const STEP: f64 = 0.02;
    /// The part of the widest search that the narrowest is.
    const NEAREST: f64 = 1.0 / 32.0;

    /// The slope expected at a film radius.
    fn at(&self, height: f64) -> f64 {
        self.slope + self.change * (height - self.height)
    }

    /// The trail as far as a film radius and the slope found there. Next time it is sought a few times as far as it was
    /// off, within `widest`.
    fn to(self, height: f64, slope: f64, widest: f64) -> Self {
        let step = height - self.height;
        let change = if step > Self::STEP * height { (slope - self.slope) / step } else { self.change };
        let width = (4.0 * (slope - self.at(height)).abs()).clamp(Self::NEAREST * widest, widest);
        Self { height, slope, change, width }
    }
}

impl Field<'_> {
    /// The radius at which the pupil has shrunk to a point, where that lies within reach, or so little beyond that the
    /// pupil is a sliver there; and no light gets through farther out.
    pub fn vanishing(&self) -> Option<Vanishing> {
        let scale = self.cover.seen_from([0.0; 2]).radius;
        let width = first_look(scale, self.radius);
        let trail = Cell::new(Trail { height: 0.0, slope: 0.0, change: self.shift, width });
        let (mut step, mut searches) = (1, 0);
        while step <= STEPS + 1 {
            let height = self.reach * step as f64 / STEPS as f64;
            let (slope, excess) =
                self.view(height).innermost(trail.get().at(height), trail.get().width, scale, true);
            if excess < 0.0 {
                trail.set(trail.get().to(height, slope, width));
                step += 1;
                continue;
            }
            let margin = |height: f64| {
                let (expected, nearby) = (trail.get().at(height), trail.get().width);
                let (slope, excess) = self.view(height).innermost(expected, nearby, scale, false);
                if excess < 0.0 {
                    trail.set(trail.get().to(height, slope, width));
                    return excess;
                }
                // A search that has lost the pupil may end anywhere, also at rays that hardly miss something elsewhere: that
                // tells nothing of how far off the pupil is.
                if (slope - expected).abs() > self.radius { 1.0 } else { excess.min(1.0) }
            };
            let inside = trail.get().height.max(1e-9 * height);
            let end = illinois(inside, height, ACCURACY, margin);
            searches += 1;
            if self.tracer.is_spent() || searches > SEARCHES {
                return None;
            }
            let beside = (1.0 + BESIDE) * end;
            if margin(beside) < 0.0 {
                continue;
            }
            // What was followed may be one of several pieces, or so small that it was lost from a guess far off.
            match self.lit_slope(beside) {
                Some(slope) => trail.set(trail.get().to(beside, slope, width)),
                None if self.leaks_beyond(end) => return None,
                None => return Some(Vanishing { height: end, center: trail.get().at(end) / end }),
            }
        }
        None
    }

    fn view(&self, height: f64) -> View<'_> {
        View { tracer: self.tracer, height, width_scale: 1.0 }
    }

    /// A slope on the meridian at which light gets through, if one of many tried does.
    fn lit_slope(&self, height: f64) -> Option<f64> {
        let cover = self.cover.seen_from([height, 0.0]);
        let at = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(SLOPES) - 1.0;
        let slopes: Vec<[f64; 2]> =
            (0..SLOPES).map(|i| [cover.center[0] + cover.radius * at(i), 0.0]).collect();
        let passes = self.view(height).pass(&slopes);
        slopes.iter().zip(passes).find_map(|(slope, passes)| passes.then_some(slope[0]))
    }

    /// Whether light gets through anywhere within reach beyond the radius at which the pupil closes.
    fn leaks_beyond(&self, end: f64) -> bool {
        const RADII: u32 = 6;
        const GRID: u32 = 20;
        if end >= self.reach {
            return false;
        }
        (1..=RADII).any(|i| {
            let height = end + (self.reach - end) * f64::from(i) / f64::from(RADII);
            self.view(height).pass(&half_disk(GRID, self.cover.seen_from([height, 0.0]))).contains(&true)
        })
    }
}
