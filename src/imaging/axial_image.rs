//! The best image of a point on the axis: a lens and the point in, the plane where its bundle, uniform over the entrance
//! pupil, has its smallest RMS radius, by exact rays, out.

use crate::{
    lens::{Lens, pupil::EntrancePupil},
    numeric::{GAUSS_POINTS, edge, gauss_legendre, root},
    trace::{Path, Ray},
};

/// A lens made ready to trace bundles of axial points.
#[derive(Clone, Debug)]
pub struct AxialImage {
    entrance: EntrancePupil,
    path: Path,
    /// z of a plane that lies before the whole lens.
    start: f64,
    rear_vertex: f64,
    rule: [(f64, f64); GAUSS_POINTS],
}

/// Where an axial point's bundle is narrowest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BestImage {
    /// From the last vertex, mm: negative where the image is virtual or in the lens, infinite where the bundle leaves the
    /// lens parallel.
    pub distance: f64,
    /// RMS radius of the bundle there, mm.
    pub spot: f64,
    /// The largest share of the entrance pupil's radius that gets through.
    pub margin: f64,
}

impl AxialImage {
    /// For a lens with this entrance pupil.
    pub fn of(lens: &Lens, entrance: EntrancePupil) -> Self {
        Self {
            entrance,
            path: Path::scene_to_film(lens),
            start: lens.surfaces.iter().map(|s| s.vertex + s.sagitta_range()[1]).fold(0.0, f64::max),
            rear_vertex: lens.rear().vertex,
            rule: gauss_legendre(),
        }
    }

    /// Whether not even the ray along the axis gets through.
    pub fn is_dark(&self) -> bool {
        self.image_side(0.0, 0.0).is_none()
    }

    /// The narrowest place of the bundle of the axial point that lies 1/`vergence` mm in front of the first vertex (0: at
    /// infinity).
    pub fn best(&self, vergence: f64) -> BestImage {
        let passes = |fraction: f64| self.image_side(vergence, fraction).is_some();
        let mut blocked = 1.0;
        while passes(blocked) && blocked < 8.0 {
            blocked *= 1.125;
        }
        let [low, high] = self.around_the_edge(vergence, blocked, passes).unwrap_or([0.0, blocked]);
        let margin =
            edge(0.0, blocked, 0.0, |fraction| fraction <= low || fraction < high && passes(fraction));
        // Uniform over the pupil is uniform in the square of the fraction.
        let (mut heights, mut product, mut square) = (0.0, 0.0, 0.0);
        for (area, weight) in self.rule {
            if let Some((height, slope)) = self.image_side(vergence, margin * area.sqrt()) {
                heights += weight * height * height;
                product += weight * height * slope;
                square += weight * slope * slope;
            }
        }
        let distance = -product / square;
        BestImage { distance, spot: (heights + distance * product).max(0.0).sqrt(), margin }
    }

    /// Fractions of the entrance pupil's radius close around where rays begin to be clipped, below `blocked`, of which the
    /// one gets through and the other does not: bisection needs to look only between them. `None` where none are found.
    fn around_the_edge(&self, vergence: f64, blocked: f64, passes: impl Fn(f64) -> bool) -> Option<[f64; 2]> {
        /// Relative distances from where the heights have it.
        const WIDTHS: [f64; 2] = [1e-14, 1e-12];
        if !self.excess(vergence, blocked).is_finite() {
            return None;
        }
        let found = root(0.0, blocked, |fraction| self.excess(vergence, fraction));
        let around = |width: f64| [found * (1.0 - width), found * (1.0 + width)];
        let brackets = |&[low, high]: &[f64; 2]| high <= blocked && passes(low) && !passes(high);
        WIDTHS.map(around).into_iter().find(brackets)
    }

    /// The largest height over clear semi-diameter, minus 1, of the ray aimed at `fraction` of the entrance pupil's radius;
    /// infinite where it stops within all apertures.
    fn excess(&self, vergence: f64, fraction: f64) -> f64 {
        let (height, slope) = self.entrance.marginal_ray(vergence, fraction);
        let mut most = 0.0_f64;
        let through = self.path.intersections(
            self.start,
            [0.0, height - slope * self.start],
            [0.0, slope],
            |intersection| {
                most = most.max(intersection.ratio);
                true
            },
        );
        if through || most > 1.0 { most.sqrt() - 1.0 } else { f64::INFINITY }
    }

    /// Height in the rear vertex plane and slope dy/ds, s toward the film, of the ray from the axial
    /// point of this vergence that is aimed at `fraction` of the entrance pupil's radius.
    fn image_side(&self, vergence: f64, fraction: f64) -> Option<(f64, f64)> {
        let (height, slope) = self.entrance.marginal_ray(vergence, fraction);
        let origin = [0.0, height - slope * self.start, self.start];
        let ray = self.path.trace(Ray { origin, direction: [0.0, slope, -1.0] }).ok()?;
        let slope = ray.direction[1] / -ray.direction[2];
        let height = ray.origin[1] + slope * (ray.origin[2] - self.rear_vertex);
        Some((height, slope))
    }
}
