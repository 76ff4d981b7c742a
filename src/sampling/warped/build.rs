//! Builds the table: a path and the film's place in; outlines at as many film radii as it takes for the ones between to
//! be interpolated out. Intervals of film radius are halved until the middle is predicted by its ends (adaptive
//! subdivision); where no outline fits the rear element's disk stands in.

use std::cell::Cell;

use super::{
    illinois::{Closing, illinois},
    outline::{Guess, Outline, direction},
    search::{Crossing, EdgeFinder, Hints},
    slice::{CELLS, Knots, Slice, TRACE_EVERY},
    view::{Limit, View},
};
use crate::{lens::pupil::SlopeDisk, sampling::pupil_disk::PupilDisk, trace::Path};

/// Intervals of film radius that the table begins with.
pub(crate) const COARSE: usize = 8;
/// Times that each of them may be halved.
pub(crate) const DEPTH: u32 = 6;
/// Smallest intervals.
pub(crate) const FINE: usize = COARSE << DEPTH;

/// What may be left of a misfit in an interval's middle when that is made a slice: a quarter for smooth
/// outlines, a little more where a corner moves along.
const AFTER_HALVING: f64 = 0.3;
/// The same where a corner comes or goes anywhere within the interval, a quarter of it from the end
/// at worst.
const WITH_NEW_CORNERS: f64 = 1.0;
/// Share of the pupil that interpolation may then miss before the halves are halved again.
const MISSED: f64 = 6e-5;
/// The same for what the interpolated shape has too much, which costs acceptance.
const EXCESS: f64 = 3e-3;
/// Share missed at the greatest depth above which the outline is given up for the rear disk.
const HOPELESS: f64 = 0.02;

/// Part of the pupil on the axis below which a pupil about to vanish is no longer worth an outline.
const SLIVER: f64 = 1e-3;

/// τ where the pupil vanishes: not 0, which rounding in single precision would make a negative density of.
const LEAST_WIDTH: f64 = 1e-6;

/// How far beyond the radius at which a pupil seems to vanish it has to be dark, too, relative.
const BESIDE_THE_END: f64 = 1e-6;

/// Distance from the centre over the edge's from which light that gets through is another piece's.
const BESIDE: f64 = 1.001;

/// What the table is built from.
pub(crate) struct Builder<'a> {
    pub path: &'a Path,
    /// z of the film.
    pub film: f64,
    /// Largest film radius asked for, mm.
    pub reach: f64,
    /// A disk that holds every pupil.
    pub cover: PupilDisk,
    /// Film radius times this is about the slope to the pupil's centre.
    pub shift: f64,
    pub rays: Cell<u32>,
    hints: Hints,
    knots: Knots,
    /// The film radius at which the pupil vanishes, mm; infinite where that lies beyond reach.
    vanishing: Cell<f64>,
}

/// A stretch of film radius between two slices.
pub(crate) struct Interval {
    /// In units of the smallest interval.
    pub from: usize,
    pub to: usize,
    pub slices: [Slice; 2],
}

/// Everything that the table keeps.
pub(crate) struct Layout {
    /// Film radius at the table's end, mm.
    pub end: f64,
    /// Whether no light reaches the film beyond the end.
    pub dark_beyond: bool,
    pub intervals: Vec<Interval>,
}

impl<'a> Builder<'a> {
    pub fn new(path: &'a Path, film: f64, reach: f64, cover: PupilDisk, shift: f64) -> Self {
        Self {
            path,
            film,
            reach,
            cover,
            shift,
            rays: Cell::new(0),
            hints: Hints::new(path.surfaces()),
            knots: Knots::new(),
            vanishing: Cell::new(f64::INFINITY),
        }
    }

    fn view(&self, height: f64, width_scale: f64) -> View<'_> {
        View { path: self.path, film: self.film, height, width_scale, rays: &self.rays }
    }

    fn finder<'b>(&'b self, view: &'b View<'b>) -> EdgeFinder<'b> {
        EdgeFinder { view, hints: &self.hints }
    }

    fn cover_at(&self, height: f64) -> SlopeDisk {
        self.cover.seen_from([height, 0.0])
    }

    fn cover_slice(&self, height: f64) -> Slice {
        let center = self.cover.seen_from([1.0, 0.0]).center[0];
        Slice::disk(height, center, self.cover_at(height).radius, false)
    }

    pub fn layout(&self) -> Layout {
        let vanishing = self.vanishing_slice().filter(|slice| !self.leaks_beyond(slice.height));
        let dark_beyond = vanishing.is_some();
        let end = vanishing.as_ref().map_or(self.reach, |slice| slice.height);
        if dark_beyond {
            self.vanishing.set(end);
        }
        let height = |place: usize| {
            let s = place as f64 / FINE as f64;
            end * if dark_beyond { s * (2.0 - s) } else { s }
        };
        let coarse = self.coarse_slices(&height, vanishing);
        let axis_area = coarse[0].as_ref().map_or(0.0, |slice| slice.area);
        let mut intervals = Vec::new();
        for (number, pair) in coarse.windows(2).enumerate() {
            let (from, to) = (number << DEPTH, (number + 1) << DEPTH);
            match pair {
                [Some(a), Some(b)] => self.refine(&height, [from, to], [a, b], axis_area, &mut intervals),
                _ => intervals.push(self.covered(&height, [from, to])),
            }
        }
        center_on_axis(&mut intervals);
        Layout { end, dark_beyond, intervals }
    }

    fn covered(&self, height: &impl Fn(usize) -> f64, [from, to]: [usize; 2]) -> Interval {
        Interval { from, to, slices: [from, to].map(|place| self.cover_slice(height(place))) }
    }

    /// The radius at which the pupil has shrunk to a point, where that lies within reach, or so little beyond that the
    /// pupil is a sliver there.
    fn vanishing_slice(&self) -> Option<Slice> {
        let scale = self.cover_at(0.0).radius;
        let mut inside = (0.0, 0.0);
        for step in 1..=COARSE + 1 {
            let height = self.reach * step as f64 / COARSE as f64;
            let guess = if inside.0 > 0.0 { inside.1 * height / inside.0 } else { self.shift * height };
            let (slope, excess) = self.view(height, 1.0).innermost(guess, scale, true);
            if excess < 0.0 {
                inside = (height, slope);
                continue;
            }
            let ratio = if inside.0 > 0.0 { inside.1 / inside.0 } else { self.shift };
            let best = Cell::new(ratio);
            let margin = |height: f64| {
                let (slope, excess) = self.view(height, 1.0).innermost(best.get() * height, scale, false);
                // Where a search fails it may end anywhere: no guess for one nearer the axis.
                if excess < 0.0 {
                    best.set(slope / height);
                }
                excess.min(1.0)
            };
            let end = illinois(inside.0.max(1e-9 * height), height, Closing::Bracket(1e-9), margin);
            // From a guess far off a search may have missed a small pupil; from one this near it does not.
            let beside = (1.0 + BESIDE_THE_END) * end;
            if margin(beside) < 0.0 {
                inside = (beside, best.get() * beside);
                continue;
            }
            return Some(Slice {
                narrowing: (1.0 - LEAST_WIDTH) / (end * end),
                ..Slice::disk(end, best.get(), 0.0, true)
            });
        }
        None
    }

    /// Whether light gets through anywhere within reach beyond the radius at which the pupil closes.
    fn leaks_beyond(&self, end: f64) -> bool {
        const RADII: u32 = 6;
        const GRID: u32 = 20;
        if end >= self.reach {
            return false;
        }
        let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(GRID) - 1.0;
        let grid = (0..GRID).flat_map(|i| (GRID / 2..GRID).map(move |j| [at(i), at(j)]));
        let disk: Vec<_> = grid.filter(|[x, y]| x * x + y * y <= 1.0).collect();
        (1..=RADII).any(|i| {
            let height = end + (self.reach - end) * f64::from(i) / f64::from(RADII);
            let cover = self.cover_at(height);
            let slopes = disk.iter().map(|[x, y]| [cover.center[0] + cover.radius * x, cover.radius * y]);
            self.view(height, 1.0).pass(&slopes.collect::<Vec<_>>()).contains(&true)
        })
    }

    /// The slices at the ends of the coarse intervals; `None` where only a cover will do.
    fn coarse_slices(
        &self,
        height: &impl Fn(usize) -> f64,
        mut vanishing: Option<Slice>,
    ) -> Vec<Option<Slice>> {
        let mut slices: Vec<Option<Slice>> = Vec::with_capacity(COARSE + 1);
        slices.push(self.axial_slice());
        let axis_area = slices[0].as_ref().map_or(0.0, |slice| slice.area);
        for number in 1..=COARSE {
            if number == COARSE && vanishing.is_some() {
                slices.push(vanishing.take());
                break;
            }
            let height = height(number << DEPTH);
            let slice = slices[number - 1].as_ref().and_then(|before| {
                let view = self.view(height, before.width_scale());
                let shift = if number == 1 { self.shift } else { before.center };
                let [guess, reach] =
                    [shift * height, self.cover_at(height).radius].map(|x| x / view.width_scale);
                let (inside, excess) = view.innermost(guess, reach, true);
                if !(excess < 0.0) {
                    return None;
                }
                let outline = self.outline(&view, inside, before)?;
                (!self.is_in_pieces(&view, &outline)).then(|| self.fit(&view, &outline, axis_area))
            });
            slices.push(slice);
        }
        if let [Some(axis), Some(next), ..] = slices.as_mut_slice() {
            (axis.center, axis.narrowing) = (next.center, next.narrowing);
        }
        slices
    }

    /// The pupil on the axis: a disk, if it is whole.
    fn axial_slice(&self) -> Option<Slice> {
        let view = self.view(0.0, 1.0);
        let reach = self.cover_at(0.0).radius;
        let guess = Crossing { radius: reach, limit: Limit::Optics, steepness: 1.0 };
        if !(view.excess([0.0, 0.0]).value <= 0.0) {
            return None;
        }
        let edge = self.finder(&view).crossings(0.0, std::iter::once(([1.0, 0.0], guess)))?[0].radius;
        const SCAN: u32 = 32;
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(SCAN);
        let within: Vec<_> = (0..SCAN).map(|i| [edge * place(i), 0.0]).collect();
        let hole = view.pass(&within).contains(&false);
        let beyond = BESIDE * edge;
        let outside: Vec<_> = (0..SCAN).map(|i| [beyond + (reach - beyond) * place(i), 0.0]).collect();
        let ring = beyond < reach && view.pass(&outside).contains(&true);
        (!hole && !ring).then(|| Slice::disk(0.0, 0.0, edge, true))
    }

    /// The outline at `view`, expected to look like `like`.
    fn outline(&self, view: &View<'_>, inside: f64, like: &Slice) -> Option<Outline> {
        let points: Vec<(f64, f64)> = (0..=CELLS)
            .step_by(TRACE_EVERY)
            .map(|knot| {
                let [x, y] = like.point(knot, self.knots.directions[knot]);
                let angle = match knot {
                    0 => 0.0,
                    CELLS => std::f64::consts::PI,
                    _ => y.atan2(x),
                };
                (angle, (x * x + y * y).sqrt())
            })
            .collect();
        let rising = points.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if rising {
            return Outline::trace(self.finder(view), &Guess { inside, points: &points });
        }
        let even: Vec<_> =
            (0..=CELLS).step_by(TRACE_EVERY).map(|knot| (self.knots.angles[knot], points[0].1)).collect();
        Outline::trace(self.finder(view), &Guess { inside, points: &even })
    }

    fn fit(&self, view: &View<'_>, outline: &Outline, axis_area: f64) -> Slice {
        // Where the pupil vanishes at H, √(1 - h²/H²) is about its width over its height. Half of that keeps τ above 0
        // between the slices, too; where it does not vanish nothing is narrowed.
        let crescent = (1.0 - (view.height / self.vanishing.get()).powi(2)).max(0.0).sqrt();
        let least = if crescent < 1.0 { crescent / 2.0 } else { 1.0 };
        Slice::fit(view, outline, &self.knots, axis_area, least)
    }

    /// A coarse look for holes inside the outline, and for light that gets through outside it.
    fn is_in_pieces(&self, view: &View<'_>, outline: &Outline) -> bool {
        const RAYS: u32 = 12;
        const WITHIN: u32 = 3;
        const BEYOND: u32 = 8;
        let cover = self.cover_at(view.height);
        let mut cursor = 0;
        let (mut within, mut beyond) = (Vec::new(), Vec::new());
        for i in 0..RAYS {
            let angle = std::f64::consts::PI * (f64::from(i) + 0.5) / f64::from(RAYS);
            let [dx, dy] = direction(angle);
            let edge = outline.radius(angle, &mut cursor);
            let at = |radius: f64| [outline.center + radius * dx, radius * dy];
            // Along the half-line to where it leaves the cover.
            let (offset, dx) = (view.width_scale * outline.center - cover.center[0], view.width_scale * dx);
            let (along, square) = (offset * dx, dx * dx + dy * dy);
            let inside = cover.radius.powi(2) - offset * offset;
            let end = ((along * along + square * inside).max(0.0).sqrt() - along) / square;
            let place = |k: u32, n: u32| (f64::from(k) + 0.5) / f64::from(n);
            within.extend((0..WITHIN).map(|k| at(edge * place(k, WITHIN))));
            let radii = (0..BEYOND).map(|k| edge + (end - edge) * place(k, BEYOND));
            beyond.extend(radii.filter(|&radius| radius > BESIDE * edge).map(at));
        }
        view.pass(&within).contains(&false) || view.pass(&beyond).contains(&true)
    }

    /// Halves an interval until its ends predict its middle.
    fn refine(
        &self,
        height: &impl Fn(usize) -> f64,
        [from, to]: [usize; 2],
        [a, b]: [&Slice; 2],
        axis_area: f64,
        intervals: &mut Vec<Interval>,
    ) {
        if to - from < 2 {
            intervals.push(match b.area {
                0.0 => last_sliver([from, to], a, b),
                _ => Interval { from, to, slices: [a.clone(), b.clone()] },
            });
            return;
        }
        let place = usize::midpoint(from, to);
        let middle = height(place);
        let predicted = a.between(b, middle);
        let view = self.view(middle, predicted.width_scale());
        let reach = predicted.factors[0][0].abs();
        let (inside, depth) = view.innermost(predicted.center * middle / view.width_scale, reach, true);
        let outline = if depth < 0.0 { self.outline(&view, inside, &predicted) } else { None };
        let Some(outline) = outline else {
            intervals.push(if b.area == 0.0 && a.area < SLIVER * axis_area {
                last_sliver([from, to], a, b)
            } else {
                self.covered(height, [from, to])
            });
            return;
        };
        let slice = self.fit(&view, &outline, axis_area);
        let same_corners = a.corners == b.corners && a.corners == slice.corners;
        let part = if same_corners { AFTER_HALVING } else { WITH_NEW_CORNERS };
        let (missed, excess) = slice.misfit(&predicted, &outline, &self.knots, part);
        if missed > HOPELESS && to - from == 2 && a.area > SLIVER * axis_area {
            intervals.push(self.covered(height, [from, to]));
        } else if missed > MISSED || excess > EXCESS.max(4.0 * slice.margin) {
            self.refine(height, [from, place], [a, &slice], axis_area, intervals);
            self.refine(height, [place, to], [&slice, b], axis_area, intervals);
        } else {
            intervals.push(Interval { from, to: place, slices: [a.clone(), slice.clone()] });
            intervals.push(Interval { from: place, to, slices: [slice, b.clone()] });
        }
    }
}

/// The last interval before the pupil vanishes. Its height falls faster than evenly; a map that keeps
/// half its size covers that.
fn last_sliver([from, to]: [usize; 2], a: &Slice, b: &Slice) -> Interval {
    let mut end = b.clone();
    end.factors = a.factors.iter().map(|m| m.map(|x| x / 2.0)).collect();
    Interval { from, to, slices: [a.clone(), end] }
}

/// C/h and the narrowing on the axis, where they cannot be measured: even in h, so by extrapolation in h² from the next two
/// slices.
fn center_on_axis(intervals: &mut [Interval]) {
    let [first, second, ..] = intervals else { return };
    let [axis, one] = &mut first.slices;
    let two = &second.slices[1];
    if axis.fitted && one.fitted && two.fitted {
        let (h1, h2) = (one.height * one.height, two.height * two.height);
        let on_axis = |one: f64, two: f64| one - (two - one) * h1 / (h2 - h1);
        // The narrowing not below 0: the map would leave the disks of `WarpedPupil::bands`.
        (axis.center, axis.narrowing) =
            (on_axis(one.center, two.center), on_axis(one.narrowing, two.narrowing).max(0.0));
    } else {
        (axis.center, axis.narrowing) = (one.center, one.narrowing);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{imaging::focus::Focus, lens::Lens, prescription::catalogue};

    #[test]
    fn no_slice_is_narrowed_to_nothing_or_stretched() {
        for name in catalogue::names() {
            for stop in [1.0, 0.5, 0.1, 0.01] {
                let mut lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
                let stop_index = lens.stop_index().expect("a stop");
                lens.surfaces[stop_index].semi_diameter *= stop;
                let focus = Focus::new(&lens).expect("focal");
                let film = lens.rear().vertex - focus.film_distance(f64::INFINITY).expect("reachable");
                let path = Path::film_to_scene(&lens);
                let cover = PupilDisk::rear(&lens, film, 100.0).expect("behind the lens");
                let shift = PupilDisk::exit(&lens, film).seen_from([1.0, 0.0]).center[0];
                let Layout { dark_beyond, intervals, .. } =
                    Builder::new(&path, film, 100.0, cover, shift).layout();
                assert!(dark_beyond, "{name} {stop}");
                for slice in intervals.iter().flat_map(|interval| &interval.slices) {
                    let narrowed = slice.narrowing >= 0.0 && slice.width_scale() > 0.0;
                    assert!(narrowed, "{name} {stop} at {}: {}", slice.height, slice.narrowing);
                }
            }
        }
    }
}
