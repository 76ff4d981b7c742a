//! Rays that leave the film, in lanes. A sampler sets their slopes and the pupil's area per sample; a tracer
//! then continues from there.

use realistic_simd::{Lanes, Portable, Scalar};

/// Film rays.
#[derive(Clone, Copy, Debug)]
pub struct FilmRays<L> {
    /// Film points of the rays, mm.
    pub point: [L; 2],
    /// Points of the unit disk to which the lens samples map; NaN if another lens sample is requested.
    pub disk: [L; 2],
    /// dx/dz and dy/dz.
    pub slopes: [L; 2],
    /// Slope area per sample, divided by π; NaN for a ray that does not exist.
    pub area_per_pi: L,
}

impl<L: Lanes> FilmRays<L> {
    /// Returns the squares of the film points' distances from the axis, mm².
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn radius_squared(&self) -> L {
        let [x, y] = self.point;
        y.mul_add(y, x * x)
    }

    /// Replaces the slopes and areas of the rays that are not in `kept`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn replace(&mut self, kept: L::Mask, (slopes, area_per_pi): ([L; 2], L)) {
        for (own, slope) in self.slopes.iter_mut().zip(slopes) {
            *own = L::select(kept, *own, slope);
        }
        self.area_per_pi = L::select(kept, self.area_per_pi, area_per_pi);
    }
}

impl<S: Scalar> FilmRays<Portable<S, 1>> {
    /// Converts a single ray to double precision.
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
