//! Focus: which film distance images an object at a given distance sharply.
//!
//! An object's place is kept as u = 1/(z - F), F being the scene-side focal point: by Newton's equation
//! the paraxial image distance is linear in u, and infinity, u = 0, is a number like any other. The
//! best image distance b(u) minimises the RMS spot of the axial bundle, uniform over the entrance
//! pupil. Distances are counted from the film plane, which moves: D(u) = F + 1/u - z' + b(u), z' the
//! last vertex. D has one minimum, near u = 1/f; the branch from infinity to there is where focusing
//! takes place.

use thiserror::Error;

use super::axial_image::{AxialImage, BestImage};
use crate::lens::{Lens, LensError, first_order::FirstOrder, pupil::EntrancePupil};
use crate::{
    message::{short, short_above},
    numeric::{minimum, root},
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

/// Film where a field flattener's last vertex is, or no farther inside the glass than this part of the focal length, is put
/// right behind it: at f/1.4 that blurs by half a circle of confusion.
const TOUCHING: f64 = 1e-3;
/// How far behind, in focal lengths: less than any lens's depth of focus.
const NEAREST_FILM: f64 = 1e-5;

/// The focusing of one lens at its stop and wavelength.
#[derive(Clone, Debug)]
pub struct Focus {
    lens: String,
    first_order: FirstOrder,
    entrance: EntrancePupil,
    image: AxialImage,
    /// Of the axial point at infinity.
    at_infinity: BestImage,
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
        let image = AxialImage::of(lens, entrance);
        if image.is_dark() {
            return Err(FocusError::Dark { lens: lens.name.clone() });
        }
        let at_infinity = image.best(0.0);
        let focus = Self { lens: lens.name.clone(), first_order, entrance, image, at_infinity };
        if focus.at_infinity.distance <= -TOUCHING * first_order.focal_length {
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
            return Ok(self.behind_the_lens(self.at_infinity.distance));
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
        Ok(self.behind_the_lens(self.best_image_distance(root(0.0, end, residual))))
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
            let at_end = residual(end);
            if at_end >= 0.0 {
                let u = root(0.0, end, |u| if u == end { at_end } else { residual(u) });
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

    /// A film distance that is one where the image lies at the last vertex.
    fn behind_the_lens(&self, distance: f64) -> f64 {
        distance.max(NEAREST_FILM * self.first_order.focal_length)
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
        if u == 0.0 { self.at_infinity } else { self.image.best(self.vergence(u)) }
    }

    /// 1 over the distance of the axial point u from the first vertex.
    fn vergence(&self, u: f64) -> f64 {
        u / (1.0 + u * self.first_order.front_focal_point)
    }
}
