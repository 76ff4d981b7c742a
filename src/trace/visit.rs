//! A ray's way through all surfaces, whatever their apertures say: what it is at each, told to a caller who
//! decides how far it goes.

use super::{Path, Real, walk::State};

/// What [`Path::visit`] tells of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Visit<R> {
    /// The surface, counted along the travel.
    pub surface: usize,
    /// Where the ray meets it, x and y, mm.
    pub point: [R; 2],
    /// The square of the distance from the axis over that of the clear semi-diameter.
    pub ratio: R,
    /// z of the surface's normal there: positive on the near side.
    pub normal: R,
}

impl<R: Real> Path<R> {
    /// Takes a ray from (`x`, `y`) on a film at z = `film`, with these slopes, through all surfaces, whatever their
    /// apertures say, as long as `go_on` says so. Whether it came to the end; a decision that
    /// numbers of type `R` leave open counts against it.
    pub(crate) fn visit(
        &self,
        film: f64,
        [x, y]: [R; 2],
        [sx, sy]: [R; 2],
        mut go_on: impl FnMut(Visit<R>) -> bool,
    ) -> bool {
        let way = R::from_f64(self.sense() * (self.entry - film));
        let length = (R::ONE + sx * sx + sy * sy).sqrt();
        let vz = self.steps[0].n / length;
        let mut state =
            State { p: [x + way * sx, y + way * sy, R::ZERO], v: [sx * vz, sy * vz, vz], lead: way * length };
        self.steps.iter().enumerate().all(|(surface, step)| {
            state.p[2] = state.p[2] - step.distance;
            if !self.is_forward(&state, surface) || step.meet(&mut state).is_err() {
                return false;
            }
            let [x, y, z] = state.p;
            let ratio = (x * x + y * y) / step.aperture;
            let normal = R::ONE - step.curvature * z;
            go_on(Visit { surface, point: [x, y], ratio, normal })
                && step.refract(&mut state, self.refraction).is_ok()
        })
    }
}
