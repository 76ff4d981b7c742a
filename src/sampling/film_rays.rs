//! Rays that leave the film, in lanes: what a sampler fills in, slopes and the area of the pupil that each sample stands
//! for, and a tracer takes up.

use crate::trace::kernel::{Lanes, Portable, Scalar};

/// Film rays.
#[derive(Clone, Copy, Debug)]
pub struct FilmRays<L> {
    /// Where they begin, mm.
    pub point: [L; 2],
    /// The points of the unit disk that they stand for; NaN where another lens sample is asked for.
    pub disk: [L; 2],
    /// dx/dz and dy/dz.
    pub slopes: [L; 2],
    /// The slope area that each stands for, over π, and times its transmission where a camera has one; NaN where
    /// there is none.
    pub area_per_pi: L,
}

impl<L: Lanes> FilmRays<L> {
    /// The squares of the distances from the axis at which they begin, mm².
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn radius_squared(&self) -> L {
        let [x, y] = self.point;
        y.mul_add(y, x * x)
    }
}

impl<S: Scalar> FilmRays<Portable<S, 1>> {
    /// The one ray in double precision.
    #[inline(always)]
    pub fn widened(self) -> FilmRays<f64> {
        let Self { point, disk, slopes, area_per_pi: Portable([area_per_pi]) } = self;
        let wide = |pair: [Portable<S, 1>; 2]| pair.map(|Portable([number])| number.to_f64());
        FilmRays {
            point: wide(point),
            disk: wide(disk),
            slopes: wide(slopes),
            area_per_pi: area_per_pi.to_f64(),
        }
    }
}
