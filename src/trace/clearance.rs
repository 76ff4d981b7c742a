//! How near a ray comes to being clipped: a smooth measure of what [`Path::walk`] answers with
//! yes or no, for searches of a pupil's edge.

use super::{Path, Ray, Real, walk::unit};

/// The aperture that a ray comes nearest to, or reaches farthest beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// The ray's distance from the axis there over the clear semi-diameter; at most 1 for a ray that
    /// gets through.
    pub ratio: f64,
    /// The surface, counted along the travel.
    pub surface: usize,
}

impl<R: Real> Path<R> {
    /// The largest ratio of height to clear semi-diameter along a ray that no aperture stops.
    ///
    /// A ray that stops for another reason (it misses a surface, is reflected, turns back) has the
    /// ratio so far if that is more than 1, else none: `None` and a ratio of more than 1
    /// together are what [`Path::walk`] blocks.
    pub fn clearance(&self, ray: Ray) -> Option<Clearance> {
        let direction = unit(ray.direction);
        let mut state = self.enter(ray, direction);
        let mut largest = R::ZERO;
        let mut surface = 0;
        let finite = state.p.iter().map(|x| x.to_f64()).chain(direction).all(f64::is_finite);
        let stopped = !finite
            || self.steps.iter().enumerate().any(|(number, step)| {
                state.p[2] = state.p[2] - step.distance;
                if !self.is_forward(&state, number) || step.meet(&mut state).is_err() {
                    return true;
                }
                let [x, y, _] = state.p;
                let ratio = (x * x + y * y) / step.aperture;
                if ratio > largest {
                    (largest, surface) = (ratio, number);
                }
                step.refract(&mut state, self.refraction).is_err()
            });
        (!stopped || largest > R::ONE).then(|| Clearance { ratio: largest.sqrt().to_f64(), surface })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{optics::Lens, prescription::catalogue};

    #[test]
    fn a_ray_gets_through_exactly_where_no_ratio_exceeds_1() {
        for name in catalogue::names() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let path = Path::<f64>::film_to_scene(&lens);
            let film = lens.rear().vertex - 1.1 * lens.rear().semi_diameter;
            let (mut through, mut clipped, mut stopped) = (0, 0, 0);
            for i in 0..40 {
                for j in 0..40 {
                    for height in [0.0, 3.0, 12.0] {
                        let at = |k: i32| 2.5 * (f64::from(k) / 39.0 - 0.5);
                        let ray = Ray { origin: [height, 0.0, film], direction: [at(i), at(j), 1.0] };
                        let clearance = path.clearance(ray);
                        let passes = clearance.is_some_and(|clearance| clearance.ratio <= 1.0);
                        assert_eq!(passes, path.trace(ray).is_ok(), "{name} {ray:?} {clearance:?}");
                        match clearance {
                            Some(_) if passes => through += 1,
                            Some(_) => clipped += 1,
                            None => stopped += 1,
                        }
                    }
                }
            }
            assert!(through > 20 && clipped > 20, "{name}: {through} {clipped} {stopped}");
        }
    }
}
