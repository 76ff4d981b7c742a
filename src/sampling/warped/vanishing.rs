//! Where along the film radius the pupil vanishes: the lens and how far the film reaches in, the radius from which on no
//! light arrives and the slope at which the last of it does out. The pupil is followed outward along the meridian, the
//! plane of axis and film point.

use std::cell::Cell;

use super::{
    illinois::{Closing, illinois},
    pieces::half_disk,
    view::{Tracer, View},
};
use crate::sampling::pupil_disk::PupilDisk;

/// Steps outward up to the film's reach.
const STEPS: usize = 8;
/// Relative accuracy of the radius.
const ACCURACY: f64 = 1e-9;
/// How far beyond the radius at which a pupil seems to vanish it has to be dark, too, relative.
const BESIDE: f64 = 1e-6;
/// Slopes on the meridian that are tried there.
const SLOPES: u32 = 256;

/// What is searched.
pub(crate) struct Field<'a> {
    pub tracer: &'a Tracer<'a>,
    /// Largest film radius asked for, mm.
    pub reach: f64,
    /// A disk that holds every pupil.
    pub cover: PupilDisk,
    /// Film radius times this is about the slope to the pupil's centre.
    pub shift: f64,
}

/// Where the pupil has shrunk to a point.
pub(crate) struct Vanishing {
    /// Film radius, mm.
    pub height: f64,
    /// The point's slope over the film radius, 1/mm.
    pub center: f64,
}

impl Field<'_> {
    /// The radius at which the pupil has shrunk to a point, where that lies within reach, or so little beyond that the
    /// pupil is a sliver there; and no light gets through farther out.
    pub fn vanishing(&self) -> Option<Vanishing> {
        let scale = self.cover.seen_from([0.0; 2]).radius;
        // Film radius, and the slope of a ray that gets through there.
        let mut inside = (0.0, 0.0);
        for step in 1..=STEPS + 1 {
            let height = self.reach * step as f64 / STEPS as f64;
            let guess = if inside.0 > 0.0 { inside.1 * height / inside.0 } else { self.shift * height };
            let (slope, excess) = self.view(height).innermost(guess, scale, true);
            if excess < 0.0 {
                inside = (height, slope);
                continue;
            }
            let ratio = if inside.0 > 0.0 { inside.1 / inside.0 } else { self.shift };
            let best = Cell::new(ratio);
            let margin = |height: f64| {
                let (slope, excess) = self.view(height).innermost(best.get() * height, scale, false);
                // Where a search fails it may end anywhere: no guess for one nearer the axis.
                if excess < 0.0 {
                    best.set(slope / height);
                }
                excess.min(1.0)
            };
            let end = illinois(inside.0.max(1e-9 * height), height, Closing::Bracket(ACCURACY), margin);
            if self.tracer.is_spent() {
                return None;
            }
            let beside = (1.0 + BESIDE) * end;
            // What was followed may be one of several pieces, or so small that it was lost from a guess far off.
            let lit = if margin(beside) < 0.0 { Some(best.get() * beside) } else { self.lit_slope(beside) };
            match lit {
                Some(slope) => inside = (beside, slope),
                None if self.leaks_beyond(end) => return None,
                None => return Some(Vanishing { height: end, center: best.get() }),
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
