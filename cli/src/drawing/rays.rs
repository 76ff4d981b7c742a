//! Rays for a drawing: the points on all surfaces of every ray of a bundle.

use realistic_optics::lens::Lens;
use realistic_optics::trace::{Path, Ray};
use realistic_trace::field::Field;

/// A ray through the lens, in the plane x = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedRay {
    /// (z, y) of the film point and of the points on the surfaces, mm.
    pub points: Vec<[f64; 2]>,
    /// Direction (dz, dy) of the ray in the scene; `None` if it is blocked.
    pub onward: Option<[f64; 2]>,
}

/// A lens prepared for drawing rays.
#[derive(Debug)]
pub struct Rays {
    lens: Lens,
    path: Path,
    field: Field,
    film: f64,
    /// -1 for a lens that is symmetric, whose bundles are drawn below the axis of the scene, else 1.
    side: f64,
}

/// Distance beyond the edges of the beam, as a fraction of the beam's width, to which rays are drawn, so that the
/// drawing shows the surfaces that stop them.
const BEYOND: f64 = 0.12;

impl Rays {
    /// Prepares a lens with film at `film` (z in image space).
    pub fn new(lens: &Lens, film: f64) -> Self {
        let side = if lens.is_centred() { -1.0 } else { 1.0 };
        let path = Path::film_to_scene(lens).with_apertures(lens);
        let field = Field::new(lens, film);
        Self { lens: lens.clone(), path, field, film, side }
    }

    /// Returns the radius to which the film gets light, at most `radius` mm.
    pub fn lit_radius(&self, radius: f64) -> Option<f64> {
        self.field.lit_radius(radius)
    }

    /// Traces `count` rays of the film point at `height` mm below the axis, spread over the beam that passes the lens
    /// and a margin; empty if the film is dark.
    pub fn bundle(&self, height: f64, count: u32) -> Vec<TracedRay> {
        let Some([low, high]) = self.field.beam(height) else {
            return Vec::new();
        };
        let margin = BEYOND * (high - low);
        let (low, high) = (low - margin, high + margin);
        (0..count)
            .map(|i| {
                let share = if count > 1 { f64::from(i) / f64::from(count - 1) } else { 0.5 };
                // The beam belongs to the point above the axis, and the drawing of a symmetric lens shows its mirror image.
                self.trace(self.side * height, self.side * (low + share * (high - low)))
            })
            .collect()
    }

    fn trace(&self, height: f64, slope: f64) -> TracedRay {
        let ray = Ray { origin: [0.0, height, self.film], direction: [0.0, slope, 1.0] };
        let [_, y, z] = self.lens.from_image_space(ray.origin);
        let mut points = vec![[z, y]];
        let walk = self.path.walk_by(ray, |_, [_, y, z]| points.push([z, y]));
        let [_, dy, dz] = walk.ray.direction;
        TracedRay { points, onward: walk.blocked.is_none().then_some([dz, dy]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::lens::first_order::FirstOrder;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn a_bundle_passes_in_the_middle_and_is_blocked_at_both_edges() {
        for name in catalogue::round() {
            let lens = Lens::at_d_line(&catalogue::find(name).unwrap());
            let optics = FirstOrder::of(&lens).unwrap();
            let height = (0.3 * optics.focal_length).min(3.0);
            let rays = Rays::new(&lens, optics.rear_focal_point).bundle(height, 11);
            let passed: Vec<bool> = rays.iter().map(|ray| ray.onward.is_some()).collect();
            assert_eq!((passed[0], passed[5], passed[10]), (false, true, false), "{name}: {passed:?}");
            for ray in rays {
                if let Some([dz, dy]) = ray.onward {
                    assert_eq!(ray.points.len(), lens.surfaces.len() + 1);
                    // The scene above the axis lies on the film below it.
                    assert!(dz > 0.0 && dy > 0.0 && ray.points[0][1] == -height);
                } else {
                    assert!(ray.points.len() <= lens.surfaces.len() + 1);
                }
            }
        }
    }
}
