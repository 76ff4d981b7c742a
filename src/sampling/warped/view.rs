//! The pupil of one film point, ray by ray: slopes in, how far outside every aperture their rays are out.
//!
//! The film point lies at (h, 0); its pupil is symmetric about the sx axis of slopes. A pupil much higher than wide is
//! seen as wide as high: sx counts in units of the width scale τ, here and in the outline.

use std::cell::Cell;

use crate::{
    lens::film_ray,
    trace::{
        Path,
        kernel::{Available, Clearance, clearances},
    },
};

/// The lens from one film point.
pub(crate) struct View<'a> {
    pub path: &'a Path,
    /// z of the film.
    pub film: f64,
    /// Distance from the axis, mm.
    pub height: f64,
    /// τ, in units of which sx counts.
    pub width_scale: f64,
    /// Rays traced so far, for the build's account.
    pub rays: &'a Cell<u32>,
}

/// What stops the rays beyond a point of the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    /// The aperture of a surface.
    Aperture(usize),
    /// A ray that misses, is reflected or turns back.
    Optics,
}

/// How far outside an aperture a ray is: negative for one that gets through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excess {
    /// Height over semi-diameter, minus 1; infinite for [`Limit::Optics`].
    pub value: f64,
    pub limit: Limit,
}

impl View<'_> {
    /// How far outside the pupil the ray of these slopes is.
    pub fn excess(&self, slopes: [f64; 2]) -> Excess {
        let mut found = Vec::with_capacity(1);
        self.excesses(&[slopes], &mut found);
        found[0]
    }

    /// [`View::excess`] of many.
    pub fn excesses(&self, slopes: &[[f64; 2]], found: &mut Vec<Excess>) {
        self.rays.set(self.rays.get() + slopes.len() as u32);
        let ray = |&[x, y]: &[f64; 2]| film_ray([self.height, 0.0], self.film, [self.width_scale * x, y]);
        let rays: Vec<_> = slopes.iter().map(ray).collect();
        let mut ratios = Vec::with_capacity(rays.len());
        clearances(Available::best(), self.path, &rays, &mut ratios);
        found.clear();
        found.extend(ratios.into_iter().map(|clearance| match clearance {
            Some(Clearance { ratio, surface }) => {
                Excess { value: ratio - 1.0, limit: Limit::Aperture(surface) }
            }
            None => Excess { value: f64::INFINITY, limit: Limit::Optics },
        }));
    }

    /// Which of the rays of these slopes get through.
    pub fn pass(&self, slopes: &[[f64; 2]]) -> Vec<bool> {
        let mut found = Vec::with_capacity(slopes.len());
        self.excesses(slopes, &mut found);
        found.iter().map(|excess| excess.value <= 0.0).collect()
    }

    /// The slope sx on the meridian that is farthest inside the pupil, sought from `guess` within
    /// `reach`, and its excess: where that is positive, the pupil is empty. With `any` the search
    /// ends at the first slope inside.
    pub fn innermost(&self, guess: f64, reach: f64, any: bool) -> (f64, f64) {
        const GRID: u32 = 24;
        let mut found = Vec::new();
        let mut least_of = |places: &[f64], best: (f64, f64)| {
            let slopes: Vec<_> = places.iter().map(|&s| [s, 0.0]).collect();
            self.excesses(&slopes, &mut found);
            let found = places.iter().zip(&found).map(|(&s, excess)| (s, excess.value));
            found.fold(best, |best, new| if new.1 < best.1 { new } else { best })
        };
        let done = |best: (f64, f64)| any && best.1 < 0.0;
        let mut best = (guess, self.excess([guess, 0.0]).value);
        let mut width = 0.02 * reach;
        if !done(best) && best.1 == f64::INFINITY {
            // Nothing to descend along: a coarse scan first.
            width = 2.0 * reach / f64::from(GRID);
            let grid: Vec<_> = (0..=GRID).map(|i| guess - reach + width * f64::from(i)).collect();
            best = least_of(&grid, best);
        }
        while width > 1e-9 * reach && !done(best) {
            let before = best.1;
            best = least_of(&[best.0 - width, best.0 + width], best);
            width *= if best.1 < before { 2.0 } else { 0.4 };
        }
        best
    }
}
