//! Rays from a film in the kernels' batch form, and their results. Converts single [`Ray`]s to the arrays of
//! [`PlaneRays`] and [`LensRays`], and back. Timings, fits and tests of batches hold their rays here.

use realistic_optics::trace::{Ray, Real};
use realistic_trace::kernel::{LensRays, PlaneRays};

/// Rays from a plane perpendicular to the axis as structure of arrays, with arrays for the rays behind the lens.
#[derive(Clone, Debug)]
pub struct FilmRays<S> {
    /// z of the film plane, lens space, mm.
    pub plane: f64,
    /// x, y (mm), dx/dz, dy/dz.
    from: [Vec<S>; 4],
    /// x, y, z (mm) and dx, dy, dz behind the lens, and the weight, 0 for a blocked ray.
    to: [Vec<S>; 7],
}

impl<S: Real> FilmRays<S> {
    /// Holds these rays, which start in the plane z = `plane` and travel toward +z.
    pub fn new(plane: f64, rays: &[Ray]) -> Self {
        let column = |of: fn(&Ray) -> f64| rays.iter().map(|ray| S::from_f64(of(ray))).collect();
        let from = [
            column(|ray| ray.origin[0]),
            column(|ray| ray.origin[1]),
            column(|ray| ray.direction[0] / ray.direction[2]),
            column(|ray| ray.direction[1] / ray.direction[2]),
        ];
        Self { plane, from, to: std::array::from_fn(|_| vec![S::ZERO; rays.len()]) }
    }

    /// Returns the number of rays.
    pub fn count(&self) -> usize {
        self.from[0].len()
    }

    /// Returns the point and slopes of a ray at the film.
    pub fn at_film(&self, i: usize) -> ([S; 2], [S; 2]) {
        let [x, y, slope_x, slope_y] = self.from.each_ref().map(|column| column[i]);
        ([x, y], [slope_x, slope_y])
    }

    /// Traces all rays through a lens, `size` (1 or more) per call.
    pub fn trace(&mut self, size: usize, trace: impl Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>)) {
        for start in (0..self.count()).step_by(size) {
            let part = start..self.count().min(start + size);
            let [x, y, slope_x, slope_y] = self.from.each_ref().map(|column| &column[part.clone()]);
            let from = PlaneRays { plane: self.plane, x, y, slope_x, slope_y };
            let [ox, oy, oz, dx, dy, dz, weight] = self.to.each_mut().map(|column| &mut column[part.clone()]);
            trace(&from, &mut LensRays { origin: [ox, oy, oz], direction: [dx, dy, dz], weight });
        }
    }

    /// Returns a ray behind the lens; `None` if it is blocked.
    pub fn traced(&self, i: usize) -> Option<Ray> {
        let [x, y, z, dx, dy, dz, weight] = self.to.each_ref().map(|column| column[i].to_f64());
        (weight > 0.0).then_some(Ray { origin: [x, y, z], direction: [dx, dy, dz] })
    }
}
