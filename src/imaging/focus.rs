//! Focus: which film distance images an object at a given distance sharply.
//!
//! An object's place is kept as u = 1/(z - F), F being the scene-side focal point: by Newton's equation
//! the paraxial image distance is linear in u, and infinity, u = 0, is a number like any other. The
//! best image distance b(u) minimises the RMS spot of the axial bundle, uniform over the entrance
//! pupil. Distances are counted from the film plane, which moves: D(u) = F + 1/u - z' + b(u), z' the
//! last vertex. D has one minimum, near u = 1/f; the branch from infinity to there is where focusing
//! takes place.

use thiserror::Error;

use crate::lens::{Lens, LensError, first_order::FirstOrder, pupil::EntrancePupil};
use crate::{
    message::{short, short_above},
    numeric::{edge, gauss_legendre, minimum, root},
    trace::{Path, Ray},
};

/// Why no film distance can be given.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FocusError {
    /// The lens cannot focus at all.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// Not even the ray along the axis gets through.
    #[error("no light passes along the axis of lens \"{lens}\"")]
    Dark {
        /// The lens.
        lens: String,
    },
    /// The object is nearer than the lens can focus.
    #[error(
        "lens \"{lens}\" cannot focus at {} mm from the film; the nearest it reaches is \
         {} mm (film {} mm behind the last vertex)",
        short(*distance), short_above(*nearest), short(*film_distance)
    )]
    TooNear {
        /// The lens.
        lens: String,
        /// Distance asked for, mm.
        distance: f64,
        /// The nearest that can be reached, mm.
        nearest: f64,
        /// The film distance there, mm.
        film_distance: f64,
    },
}

/// The focusing of one lens at its stop and wavelength.
#[derive(Clone, Debug)]
pub struct Focus {
    lens: String,
    first_order: FirstOrder,
    entrance: EntrancePupil,
    path: Path,
    /// z of a plane that lies before the whole first surface.
    start: f64,
    rule: [(f64, f64); crate::numeric::GAUSS_POINTS],
    /// Of the axial point at infinity.
    at_infinity: BestImage,
}

/// Where an axial point's bundle is narrowest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BestImage {
    /// From the last vertex, mm.
    distance: f64,
    /// RMS radius of the bundle there, mm.
    spot: f64,
    /// The largest share of the entrance pupil's radius that gets through.
    margin: f64,
}

/// An object distance and the film distance that focuses it, both mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conjugates {
    /// From the film plane to the object, along the axis.
    pub object_distance: f64,
    /// From the last vertex to the film.
    pub film_distance: f64,
}

impl Focus {
    /// [`Focus::of`] a lens whose first-order optics are not known yet.
    ///
    /// # Errors
    /// As [`Focus::of`].
    pub fn new(lens: &Lens) -> Result<Self, FocusError> {
        Self::of(lens, FirstOrder::of(lens)?, EntrancePupil::of_lens(lens))
    }

    /// Prepares focusing by a lens with these cardinal points and this entrance pupil.
    ///
    /// # Errors
    /// The lens is diverging, or passes no light along its axis.
    pub fn of(lens: &Lens, first_order: FirstOrder, entrance: EntrancePupil) -> Result<Self, FocusError> {
        if first_order.focal_length < 0.0 {
            let focal_length = first_order.focal_length;
            return Err(LensError::Diverging { lens: lens.name.clone(), focal_length }.into());
        }
        let mut focus = Self {
            lens: lens.name.clone(),
            first_order,
            entrance,
            path: Path::scene_to_film(lens),
            start: lens.front().sagitta_range()[1],
            rule: gauss_legendre(),
            at_infinity: BestImage::default(),
        };
        if focus.image_side(0.0, 0.0).is_none() {
            return Err(FocusError::Dark { lens: lens.name.clone() });
        }
        focus.at_infinity = focus.best_image(0.0);
        if focus.at_infinity.distance <= 0.0 {
            let focal_length = first_order.focal_length;
            return Err(LensError::Diverging { lens: lens.name.clone(), focal_length }.into());
        }
        Ok(focus)
    }

    /// The film distance, mm behind the last vertex, that focuses the plane `distance` mm in front
    /// of the film (infinity included), by exact rays.
    ///
    /// # Errors
    /// The plane is nearer than the lens can focus.
    pub fn film_distance(&self, distance: f64) -> Result<f64, FocusError> {
        // 1 + u (D(u) - 1/u - distance): positive at infinity, negative past the root.
        let residual = |u: f64| 1.0 + u * (self.distance_with(u, 0.0) - distance);
        if distance == f64::INFINITY {
            return Ok(self.at_infinity.distance);
        }
        // The paraxial branch's end serves nearly always and saves the search for the true one.
        let mut end = 1.0 / self.first_order.focal_length;
        if !(residual(end) <= 0.0) {
            end = self.nearest_parameter();
            if !(residual(end) <= 0.0) {
                let nearest = self.nearest();
                return Err(FocusError::TooNear {
                    lens: self.lens.clone(),
                    distance,
                    nearest: nearest.object_distance,
                    film_distance: nearest.film_distance,
                });
            }
        }
        Ok(self.best_image_distance(root(0.0, end, residual)))
    }

    /// As [`Focus::film_distance`] by first-order optics alone; `None` when the plane is nearer than
    /// 2 f plus the distance between the focal points, the paraxial limit.
    pub fn paraxial_film_distance(&self, distance: f64) -> Option<f64> {
        let FirstOrder { focal_length: f, front_focal_point, rear_focal_point, .. } = self.first_order;
        // f² u² - p u + 1 = 0, the smaller root, in the form that does not cancel.
        let p = distance - (front_focal_point - rear_focal_point);
        let discriminant = p - 4.0 * f * f / p;
        if p == f64::INFINITY {
            return Some(self.first_order.back_focal_distance());
        }
        (p > 0.0 && discriminant >= 0.0).then(|| {
            let u = 2.0 / (p + (discriminant * p).sqrt());
            self.first_order.back_focal_distance() + f * f * u
        })
    }

    /// The distance in focus, mm from the film plane, for a film `film_distance` mm behind the last
    /// vertex: infinity when the film is at or before the image of infinity, `None` when it is
    /// farther than the image of any object in front of the lens.
    pub fn object_distance(&self, film_distance: f64) -> Option<f64> {
        let residual = |u: f64| self.best_image_distance(u) - film_distance;
        if residual(0.0) >= 0.0 {
            return Some(f64::INFINITY);
        }
        let paraxial =
            (film_distance - self.first_order.back_focal_distance()) / self.first_order.focal_length.powi(2);
        let mut end = paraxial.max(0.1 / self.first_order.focal_length);
        for _ in 0..60 {
            if self.first_order.front_focal_point + end.recip() <= 0.0 {
                return None;
            }
            if residual(end) >= 0.0 {
                let u = root(0.0, end, residual);
                return Some(self.distance_with(u, u.recip()));
            }
            end *= 1.1;
        }
        None
    }

    /// The nearest plane in focus and its film distance.
    pub fn nearest(&self) -> Conjugates {
        let u = self.nearest_parameter();
        Conjugates {
            object_distance: self.distance_with(u, u.recip()),
            film_distance: self.best_image_distance(u),
        }
    }

    fn nearest_parameter(&self) -> f64 {
        let end = 1.0 / self.first_order.focal_length;
        let highest = match self.first_order.front_focal_point {
            // The object stays in front of the front vertex.
            behind if behind < 0.0 => (2.0 * end).min(0.999 / -behind),
            _ => 2.0 * end,
        };
        minimum(0.2 * end.min(highest), highest, 1e-8, |u| self.distance_with(u, u.recip()))
    }

    /// D(u) with `beyond_focus` in the place of 1/u.
    fn distance_with(&self, u: f64, beyond_focus: f64) -> f64 {
        self.first_order.front_focal_point + beyond_focus - self.first_order.rear_vertex
            + self.best_image_distance(u)
    }

    /// Effective focal length, mm.
    pub fn focal_length(&self) -> f64 {
        self.first_order.focal_length
    }

    /// How sharp the image of the axial point at infinity is at its best: RMS radius of the spot, and radius of the
    /// parallel bundle that makes it, mm.
    pub fn axial_spot(&self) -> [f64; 2] {
        let BestImage { spot, margin, .. } = self.at_infinity;
        [spot, margin * self.entrance.diameter() / 2.0]
    }

    /// Distance from the last vertex to the plane where the bundle of the axial point u has its
    /// smallest RMS radius, mm.
    fn best_image_distance(&self, u: f64) -> f64 {
        self.best_image(u).distance
    }

    fn best_image(&self, u: f64) -> BestImage {
        let passes = |fraction: f64| self.image_side(u, fraction).is_some();
        let mut blocked = 1.0;
        while passes(blocked) && blocked < 8.0 {
            blocked *= 1.125;
        }
        let margin = edge(0.0, blocked, 0.0, passes);
        // Uniform over the pupil is uniform in the square of the fraction.
        let (mut heights, mut product, mut square) = (0.0, 0.0, 0.0);
        for (area, weight) in self.rule {
            if let Some((height, slope)) = self.image_side(u, margin * area.sqrt()) {
                heights += weight * height * height;
                product += weight * height * slope;
                square += weight * slope * slope;
            }
        }
        let distance = -product / square;
        BestImage { distance, spot: (heights + distance * product).max(0.0).sqrt(), margin }
    }

    /// Height in the rear vertex plane and slope dy/ds, s toward the film, of the ray from the axial
    /// point u that is aimed at `fraction` of the entrance pupil's radius.
    fn image_side(&self, u: f64, fraction: f64) -> Option<(f64, f64)> {
        let vergence = u / (1.0 + u * self.first_order.front_focal_point);
        let (height, slope) = self.entrance.marginal_ray(vergence, fraction);
        let origin = [0.0, height - slope * self.start, self.start];
        let ray = self.path.trace(Ray { origin, direction: [0.0, slope, -1.0] }).ok()?;
        let slope = ray.direction[1] / -ray.direction[2];
        let height = ray.origin[1] + slope * (ray.origin[2] - self.first_order.rear_vertex);
        Some((height, slope))
    }
}
