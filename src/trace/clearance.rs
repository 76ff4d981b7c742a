//! How near a ray comes to being clipped: a smooth measure of what [`Path::walk`] answers with
//! yes or no, for searches of a pupil's edge.

use super::{
    Path, Ray,
    kernel::{self, Available},
};

/// The aperture that a ray comes nearest to, or reaches farthest beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// The ray's distance from the axis there over the clear semi-diameter; at most 1 for a ray that
    /// gets through.
    pub ratio: f64,
    /// The surface, counted along the travel.
    pub surface: usize,
}

impl Path<f64> {
    /// Appends the largest ratio of height to clear semi-diameter along each of several rays, traced side by side,
    /// where no aperture stops them.
    ///
    /// A ray that stops for another reason (it misses a surface, is reflected, turns back) has the
    /// ratio so far if that is more than 1, else none: `None` and a ratio of more than 1
    /// together are what [`Path::walk`] blocks. Refraction is by the fused form, whatever the path's.
    pub fn clearances(&self, rays: &[Ray], found: &mut Vec<Option<Clearance>>) {
        kernel::clearances(Available::best(), self, rays, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{lens::Lens, prescription::catalogue};

    #[test]
    fn a_ray_gets_through_exactly_where_no_ratio_exceeds_1() {
        for name in catalogue::names() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let path = Path::<f64>::film_to_scene(&lens);
            let film = lens.rear().vertex - 1.1 * lens.rear().semi_diameter;
            let mut rays = Vec::new();
            for i in 0..40 {
                for j in 0..40 {
                    for height in [0.0, 3.0, 12.0] {
                        let at = |k: i32| 2.5 * (f64::from(k) / 39.0 - 0.5);
                        rays.push(Ray { origin: [height, 0.0, film], direction: [at(i), at(j), 1.0] });
                    }
                }
            }
            let mut clearances = Vec::new();
            path.clearances(&rays, &mut clearances);
            let (mut through, mut clipped, mut stopped) = (0, 0, 0);
            for (ray, clearance) in rays.into_iter().zip(clearances) {
                let passes = clearance.is_some_and(|clearance| clearance.ratio <= 1.0);
                assert_eq!(passes, path.trace(ray).is_ok(), "{name} {ray:?} {clearance:?}");
                match clearance {
                    Some(_) if passes => through += 1,
                    Some(_) => clipped += 1,
                    None => stopped += 1,
                }
            }
            assert!(through > 20 && clipped > 20, "{name}: {through} {clipped} {stopped}");
        }
    }
}
