//! The pupil's edge as one film point sees it, found with few rays.
//!
//! The film point lies at (h, 0); its pupil is symmetric about the sx axis of slopes.

use std::cell::Cell;

use crate::{
    camera::irradiance::film_ray,
    trace::{Clearance, Path},
};

/// The lens from one film point.
pub(super) struct View<'a> {
    pub path: &'a Path,
    /// z of the film.
    pub film: f64,
    /// Distance from the axis, mm.
    pub height: f64,
    /// Rays traced so far, for the build's account.
    pub rays: &'a Cell<u32>,
}

/// What stops the rays beyond a point of the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Limit {
    /// The aperture of a surface.
    Aperture(usize),
    /// A ray that misses, is reflected or turns back.
    Optics,
}

/// How far outside an aperture a ray is: negative for one that gets through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Excess {
    /// Height over semi-diameter, minus 1; infinite for [`Limit::Optics`].
    pub value: f64,
    pub limit: Limit,
}

/// A point of the edge along a half-line of slopes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Distance from the half-line's start, in slope.
    pub radius: f64,
    pub limit: Limit,
    /// d(excess)/d(ln radius) there; a hint for the next search.
    pub steepness: f64,
}

/// Relative accuracy of a crossing. A secant's error is its step times its span times half the
/// relative curvature, and the height in an aperture is nearly linear in the slope.
const ACCURACY: f64 = 1e-6;
/// Distance of a secant's two points, over the radius, up to which that is relied on.
const LAST_SPAN: f64 = 3e-2;
/// Newton step, over the radius, that a neighbour's steepness makes as exactly.
const LAST_STEP: f64 = 2e-5;
/// Halvings that take any bracket to its last bits.
const MOST_STEPS: u32 = 120;

impl View<'_> {
    /// How far outside the pupil the ray of these slopes is.
    pub fn excess(&self, slopes: [f64; 2]) -> Excess {
        self.rays.set(self.rays.get() + 1);
        match self.path.clearance(film_ray([self.height, 0.0], self.film, slopes)) {
            Some(Clearance { ratio, surface }) => {
                Excess { value: ratio - 1.0, limit: Limit::Aperture(surface) }
            }
            None => Excess { value: f64::INFINITY, limit: Limit::Optics },
        }
    }

    /// Whether the ray of these slopes gets through.
    pub fn passes(&self, slopes: [f64; 2]) -> bool {
        self.rays.set(self.rays.get() + 1);
        self.path.trace(film_ray([self.height, 0.0], self.film, slopes)).is_ok()
    }

    /// The edge along the half-line from (`center`, 0), which lies inside, in the unit `direction`:
    /// by Newton's method from `guess`, then secants within a bracket. `None` when there is none.
    pub fn crossing(&self, center: f64, direction: [f64; 2], guess: Crossing) -> Option<Crossing> {
        let at = |radius: f64| self.excess([center + radius * direction[0], radius * direction[1]]);
        let (mut inside, mut outside) = (0.0_f64, f64::INFINITY);
        let mut limit = Limit::Optics;
        let mut radius = guess.radius;
        let mut before: Option<(f64, Excess)> = None;
        for step in 0..MOST_STEPS {
            let excess = at(radius);
            if excess.value <= 0.0 {
                inside = radius;
            } else {
                outside = radius;
                limit = excess.limit;
            }
            let usable = before.filter(|(_, old)| old.value.is_finite() && old.value != excess.value);
            let slope = match usable {
                Some((old_radius, old)) => (excess.value - old.value) / (radius - old_radius),
                None => guess.steepness / radius,
            };
            let mut next = radius - excess.value / slope;
            let length = (next - radius).abs() / radius;
            let landed = match usable {
                Some((old_radius, old)) => {
                    let span = (radius - old_radius).abs() / radius;
                    old.limit == excess.limit && span <= LAST_SPAN && length * span <= ACCURACY
                }
                None => guess.limit == excess.limit && length <= LAST_STEP,
            };
            if next > 0.0 && landed {
                return Some(Crossing { radius: next, limit: excess.limit, steepness: slope * radius });
            }
            if outside.is_finite() && outside - inside <= ACCURACY * outside {
                let steepness = if limit == Limit::Optics { guess.steepness } else { slope * radius };
                return Some(Crossing { radius: inside, limit, steepness });
            }
            // Where the secant leads nowhere, and now and then in any case, the bracket's middle.
            if !(next > inside && next < outside) || step % 8 == 7 {
                next = if outside.is_finite() { f64::midpoint(inside, outside) } else { 2.0 * radius };
            } else if outside == f64::INFINITY {
                next = next.min(4.0 * radius);
            }
            if !(next > 0.0 && next.is_finite()) {
                return None;
            }
            before = Some((radius, excess));
            radius = next;
        }
        None
    }

    /// The slope sx on the meridian that is farthest inside the pupil, sought from `guess` within
    /// `reach`, and its excess: where that is positive, the pupil is empty. With `any` the search
    /// ends at the first slope inside.
    pub fn innermost(&self, guess: f64, reach: f64, any: bool) -> (f64, f64) {
        const GRID: u32 = 24;
        let value = |s: f64| self.excess([s, 0.0]).value;
        let done = |best: (f64, f64)| any && best.1 < 0.0;
        let mut best = (guess, value(guess));
        let mut width = 0.02 * reach;
        if !done(best) && best.1 == f64::INFINITY {
            // Nothing to descend along: a coarse scan first.
            width = 2.0 * reach / f64::from(GRID);
            for i in 0..=GRID {
                let s = guess - reach + width * f64::from(i);
                let found = value(s);
                if found < best.1 {
                    best = (s, found);
                }
            }
        }
        while width > 1e-9 * reach && !done(best) {
            let better =
                [best.0 - width, best.0 + width].into_iter().map(|s| (s, value(s))).find(|f| f.1 < best.1);
            width *= if better.is_some() { 2.0 } else { 0.4 };
            best = better.unwrap_or(best);
        }
        best
    }
}
