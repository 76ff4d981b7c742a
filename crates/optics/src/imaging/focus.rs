//! Focus and depth of field: the film distance that images an object at a given distance sharply, and the range of
//! distances that are then sharp enough.
//!
//! **Best image.** [`AxialImage`] traces the bundle of rays from a point on the axis as exact rays, distributed
//! uniformly over the entrance pupil. The best image lies in the plane where the bundle has its smallest RMS radius.
//!
//! **Focus.** An object's position is stored as u = 1/(z - F), where F is the scene-side focal point. By Newton's
//! equation the paraxial image distance is linear in u, and infinity is simply u = 0. b(u) is the distance of the best
//! image from the last vertex. Object distances are counted from the film plane, which moves, so that D(u) = F + 1/u -
//! z' + b(u), where z' is the z of the last vertex. D has one minimum, near u = 1/f; a lens focuses on the branch from
//! infinity to that minimum. Here f is √(n n')/φ, with the indices of the media in front of the lens and behind it.
//!
//! **Depth of field.** This is the range of object distances in which the blur of an axial point on the film stays
//! below a circle of confusion. It is computed from the thick lens and its entrance pupil. Let D be the diameter of the
//! entrance pupil, and s the distance of the plane in focus from that pupil. A point at the distance s₁ is blurred, in
//! the plane in focus, to a disk D |s₁ - s|/s₁ wide. The blur on the film is that width times the magnification (H.
//! Gross, ed., *Handbook of Optical Systems* 1, §10.5; the similar triangles of the lecture give the same result).

use thiserror::Error;

use super::axial_beam::{AxialBeam, in_front};
use crate::{
    lens::{Lens, LensError, first_order::FirstOrder, pupil::EntrancePupil},
    trace::{Path, Ray},
};
use realistic_base::{
    message::{short, short_above},
    numeric::{GAUSS_POINTS, edge, gauss_legendre, minimum, root},
};

/// A lens prepared for tracing the ray bundles of axial points.
#[derive(Clone, Debug)]
pub struct AxialImage {
    entrance: EntrancePupil,
    path: Path,
    /// The z coordinate of a plane in front of the whole lens.
    start: f64,
    rear_vertex: f64,
    rule: [(f64, f64); GAUSS_POINTS],
    /// The azimuths of the rays, as unit vectors: one for a lens with an axis, else all around.
    azimuths: Vec<[f64; 2]>,
}

/// Number of azimuths of the rays of a lens that is not symmetric.
const AZIMUTHS: u32 = 16;

fn all_around() -> Vec<[f64; 2]> {
    let azimuth = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(AZIMUTHS);
    (0..AZIMUTHS).map(|i| azimuth(i).sin_cos().into()).collect()
}

/// The sums over a bundle from which its best image follows, of points p and slopes s in the plane of the rear vertex.
#[derive(Clone, Copy, Debug, Default)]
struct BundleSums {
    weight: f64,
    point: [f64; 2],
    slope: [f64; 2],
    /// p·p, p·s and s·s.
    products: [f64; 3],
}

impl BundleSums {
    fn add(&mut self, weight: f64, [p, s]: [[f64; 2]; 2]) {
        self.weight += weight;
        for i in 0..2 {
            self.point[i] += weight * p[i];
            self.slope[i] += weight * s[i];
            for (sum, (a, b)) in self.products.iter_mut().zip([(p[i], p[i]), (p[i], s[i]), (s[i], s[i])]) {
                *sum += weight * a * b;
            }
        }
    }

    /// Returns the products about the bundle's centre.
    fn central(&self) -> [f64; 3] {
        let ([px, py], [sx, sy]) = (self.point, self.slope);
        let of_means = [px * px + py * py, px * sx + py * sy, sx * sx + sy * sy];
        std::array::from_fn(|i| (self.products[i] - of_means[i] / self.weight) / self.weight)
    }
}

/// The plane in which an axial point's bundle is narrowest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BestImage {
    /// Distance from the last vertex, mm: negative if the image is virtual or in the lens, infinite if the bundle
    /// leaves the lens parallel.
    pub distance: f64,
    /// RMS radius of the bundle in that plane, mm.
    pub spot: f64,
    /// Largest fraction of the entrance pupil's radius at which rays get through.
    pub margin: f64,
}

impl AxialImage {
    /// Prepares a lens with this entrance pupil for tracing.
    pub fn of(lens: &Lens, entrance: EntrancePupil) -> Self {
        Self {
            entrance,
            path: Path::scene_to_film(lens),
            start: in_front(lens),
            rear_vertex: lens.rear().vertex,
            rule: gauss_legendre(),
            azimuths: if lens.is_centred() { vec![[0.0, 1.0]] } else { all_around() },
        }
    }

    /// Returns the best image of the axial point 1/`vergence` mm in front of the first vertex. A vergence of 0 stands
    /// for a point at infinity. The bundle of a lens that is not symmetric is narrowest about its centre.
    pub fn best(&self, vergence: f64) -> BestImage {
        let mut sums = BundleSums::default();
        let mut widest = 0.0_f64;
        for &azimuth in &self.azimuths {
            let margin = self.margin(vergence, azimuth);
            widest = widest.max(margin);
            // A uniform sampling of the pupil's area is uniform in the square of the fraction.
            for (area, weight) in self.rule {
                if let Some(ray) = self.image_side(vergence, margin * area.sqrt(), azimuth) {
                    let sector = if self.azimuths.len() > 1 { margin * margin } else { 1.0 };
                    sums.add(weight * sector, ray);
                }
            }
        }
        // One azimuth stands for all; the centre is then on the axis.
        let [heights, product, square] = if self.azimuths.len() > 1 { sums.central() } else { sums.products };
        let distance = -product / square;
        BestImage { distance, spot: (heights + distance * product).max(0.0).sqrt(), margin: widest }
    }

    /// Returns the largest fraction of the entrance pupil's radius at which rays of an azimuth get through.
    fn margin(&self, vergence: f64, azimuth: [f64; 2]) -> f64 {
        let passes = |fraction: f64| self.image_side(vergence, fraction, azimuth).is_some();
        let mut blocked = 1.0;
        while passes(blocked) && blocked < 8.0 {
            blocked *= 1.125;
        }
        let [low, high] = self.around_the_edge(vergence, blocked, azimuth, passes).unwrap_or([0.0, blocked]);
        edge(0.0, blocked, 0.0, |fraction| fraction <= low || fraction < high && passes(fraction))
    }

    /// Brackets the fraction of the entrance pupil's radius, below `blocked`, at which rays begin to be clipped. A ray
    /// at the first end of the bracket gets through, and a ray at the second end does not. Bisection then needs to
    /// search only between the two ends. `None` if no bracket is found.
    fn around_the_edge(
        &self,
        vergence: f64,
        blocked: f64,
        azimuth: [f64; 2],
        passes: impl Fn(f64) -> bool,
    ) -> Option<[f64; 2]> {
        /// Half widths of the bracket around the root of the excess, relative to that root.
        const WIDTHS: [f64; 2] = [1e-14, 1e-12];
        if !self.excess(vergence, blocked, azimuth).is_finite() {
            return None;
        }
        let found = root(0.0, blocked, |fraction| self.excess(vergence, fraction, azimuth));
        let around = |width: f64| [found * (1.0 - width), found * (1.0 + width)];
        let brackets = |&[low, high]: &[f64; 2]| high <= blocked && passes(low) && !passes(high);
        WIDTHS.map(around).into_iter().find(brackets)
    }

    /// Returns the maximum, over the surfaces, of the ratio of height to clear semi-diameter, minus 1, for the ray
    /// aimed at `fraction` of the entrance pupil's radius. The result is infinite if the ray ends although it is inside
    /// all apertures.
    fn excess(&self, vergence: f64, fraction: f64, azimuth: [f64; 2]) -> f64 {
        let (height, slope) = self.entrance.marginal_ray(vergence, fraction);
        let start = height - slope * self.start;
        let mut most = 0.0_f64;
        let through = self.path.intersections(
            self.start,
            azimuth.map(|part| part * start),
            azimuth.map(|part| part * slope),
            |intersection| {
                most = most.max(intersection.ratio);
                true
            },
        );
        if through || most > 1.0 { most.sqrt() - 1.0 } else { f64::INFINITY }
    }

    /// Returns the point and the slopes, in the plane of the rear vertex, of the ray from the axial point of this vergence
    /// to `fraction` of the entrance pupil's radius at an azimuth. The slopes are those by s, which points toward the
    /// film.
    fn image_side(&self, vergence: f64, fraction: f64, [across, up]: [f64; 2]) -> Option<[[f64; 2]; 2]> {
        let (height, slope) = self.entrance.marginal_ray(vergence, fraction);
        let start = height - slope * self.start;
        let origin = [across * start, up * start, self.start];
        let ray = self.path.trace(Ray { origin, direction: [across * slope, up * slope, -1.0] }).ok()?;
        let slopes = [0, 1].map(|i| ray.direction[i] / -ray.direction[2]);
        let point = [0, 1].map(|i| ray.origin[i] + slopes[i] * (ray.origin[2] - self.rear_vertex));
        Some([point, slopes])
    }
}

/// Reason why no film distance exists.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FocusError {
    /// The lens cannot focus at all.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// No ray parallel to the axis gets through.
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
        /// Requested distance, mm.
        distance: f64,
        /// Nearest distance in reach, mm.
        nearest: f64,
        /// Film distance for that nearest object distance, mm.
        film_distance: f64,
    },
}

/// Maximum depth of the image inside the glass, as a fraction of the focal length, at which the film is placed directly
/// behind the last vertex, as behind a field flattener. At f/1.4 this causes a blur of half a circle of confusion.
const TOUCHING: f64 = 1e-3;
/// Distance of such a film from the last vertex, as a fraction of the focal length: less than any lens's depth of
/// focus.
const NEAREST_FILM: f64 = 1e-5;

/// The focusing of one lens at the stop and wavelength of that lens.
#[derive(Clone, Debug)]
pub struct Focus {
    lens: String,
    first_order: FirstOrder,
    image: AxialImage,
    /// Best image of the axial point at infinity.
    at_infinity: BestImage,
}

/// An object distance and the film distance at which the object is in focus, both mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conjugates {
    /// Distance from the film plane to the object, along the axis.
    pub object_distance: f64,
    /// Distance from the last vertex to the film.
    pub film_distance: f64,
}

impl Focus {
    /// Prepares a lens for focusing; computes its cardinal points and axial beam.
    ///
    /// # Errors
    /// See [`Focus::of`].
    pub fn new(lens: &Lens) -> Result<Self, FocusError> {
        Self::of(lens, FirstOrder::of(lens)?, &AxialBeam::of(lens))
    }

    /// Prepares a lens with these cardinal points and this axial beam for focusing.
    ///
    /// # Errors
    /// The lens is diverging, or no ray parallel to its axis gets through.
    pub fn of(lens: &Lens, first_order: FirstOrder, beam: &AxialBeam) -> Result<Self, FocusError> {
        let focal_length = first_order.focal_length;
        let diverging = || LensError::Diverging { lens: lens.name.clone(), focal_length };
        if focal_length < 0.0 {
            return Err(diverging().into());
        }
        if beam.is_dark() {
            return Err(FocusError::Dark { lens: lens.name.clone() });
        }
        let image = AxialImage::of(lens, beam.entrance);
        let at_infinity = image.best(0.0);
        if at_infinity.distance <= -TOUCHING * focal_length {
            return Err(diverging().into());
        }
        Ok(Self { lens: lens.name.clone(), first_order, image, at_infinity })
    }

    /// Returns the cardinal points of the lens.
    pub fn first_order(&self) -> &FirstOrder {
        &self.first_order
    }

    /// Returns the film distance, mm behind the last vertex, that focuses the plane `distance` mm in front of the film
    /// (infinity included), by exact rays.
    ///
    /// # Errors
    /// The plane is nearer than the lens can focus.
    pub fn film_distance(&self, distance: f64) -> Result<f64, FocusError> {
        // The residual is 1 + u (D(u) - 1/u - distance), which is positive at infinity and negative past the root.
        let residual = |u: f64| 1.0 + u * (self.distance_with(u, 0.0) - distance);
        if distance == f64::INFINITY {
            return Ok(self.behind_the_lens(self.at_infinity.distance));
        }
        // The end of the paraxial branch nearly always suffices, without a search for the true end.
        let mut end = 1.0 / self.first_order.mean_focal_length();
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

    /// Returns [`Focus::film_distance`] by first-order optics alone; `None` if the plane is nearer than the paraxial
    /// limit, 2 f plus the distance between the focal points.
    pub fn paraxial_film_distance(&self, distance: f64) -> Option<f64> {
        let FirstOrder { front_focal_point, rear_focal_point, .. } = self.first_order;
        let f = self.first_order.mean_focal_length();
        // The smaller root of f² u² - p u + 1 = 0, in a form without cancellation.
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

    /// Returns the object distance in focus, mm from the film plane, for a film `film_distance` mm behind the last
    /// vertex. The distance is infinite if the film lies at or before the image of an object at infinity. The result is
    /// `None` if the film lies beyond the image of every object in front of the lens.
    pub fn object_distance(&self, film_distance: f64) -> Option<f64> {
        let residual = |u: f64| self.best_image_distance(u) - film_distance;
        if residual(0.0) >= 0.0 {
            return Some(f64::INFINITY);
        }
        let focal_length = self.first_order.mean_focal_length();
        let paraxial = (film_distance - self.first_order.back_focal_distance()) / focal_length.powi(2);
        let mut end = paraxial.max(0.1 / focal_length);
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

    /// Returns the nearest plane that the lens can focus on, and the film distance for it.
    pub fn nearest(&self) -> Conjugates {
        let u = self.nearest_parameter();
        Conjugates {
            object_distance: self.distance_with(u, u.recip()),
            film_distance: self.best_image_distance(u),
        }
    }

    fn nearest_parameter(&self) -> f64 {
        let end = 1.0 / self.first_order.mean_focal_length();
        let highest = match self.first_order.front_focal_point {
            // The object stays in front of the front vertex.
            behind if behind < 0.0 => (2.0 * end).min(0.999 / -behind),
            _ => 2.0 * end,
        };
        minimum(0.2 * end.min(highest), highest, 1e-8, |u| self.distance_with(u, u.recip()))
    }

    /// Replaces a film distance that is too short, or inside the lens, by that of a film directly behind the last
    /// vertex.
    fn behind_the_lens(&self, distance: f64) -> f64 {
        distance.max(NEAREST_FILM * self.first_order.focal_length)
    }

    /// Returns D(u) with `beyond_focus` in place of the term 1/u.
    fn distance_with(&self, u: f64, beyond_focus: f64) -> f64 {
        self.first_order.front_focal_point + beyond_focus - self.first_order.rear_vertex
            + self.best_image_distance(u)
    }

    /// Returns the effective focal length, mm.
    pub fn focal_length(&self) -> f64 {
        self.first_order.focal_length
    }

    /// Returns the sharpness of the best image of the axial point at infinity: the RMS radius of the spot, and the
    /// radius of the parallel bundle that forms the spot, mm.
    pub fn axial_spot(&self) -> [f64; 2] {
        let BestImage { spot, margin, .. } = self.at_infinity;
        [spot, margin * self.image.entrance.diameter() / 2.0]
    }

    /// Returns the distance, mm, from the last vertex to the plane where the bundle of the axial point with parameter u
    /// has its smallest RMS radius.
    fn best_image_distance(&self, u: f64) -> f64 {
        self.best_image(u).distance
    }

    fn best_image(&self, u: f64) -> BestImage {
        if u == 0.0 { self.at_infinity } else { self.image.best(self.vergence(u)) }
    }

    /// Returns the reciprocal of the distance from the first vertex to the axial point with parameter u.
    fn vergence(&self, u: f64) -> f64 {
        u / (1.0 + u * self.first_order.front_focal_point)
    }
}

/// The range of object distances in focus. Distances are counted from the film plane along the axis, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthOfField {
    /// Nearest distance at which objects are sharp enough.
    pub near: f64,
    /// Farthest distance at which objects are sharp enough; may be infinite.
    pub far: f64,
    /// Nearest focus distance at which objects at infinity are sharp enough.
    pub hyperfocal: f64,
}

impl DepthOfField {
    /// Computes the range around `focus_distance` (mm from the film, infinity included) for a film `film_distance` mm
    /// behind the last vertex and a blur of at most `confusion` mm on the film. `entrance` is the entrance pupil of the
    /// axial beam. Returns `None` for a pupil at infinity.
    ///
    /// # Errors
    /// The lens is afocal.
    pub fn of(
        lens: &Lens,
        entrance: &EntrancePupil,
        film_distance: f64,
        focus_distance: f64,
        confusion: f64,
    ) -> Result<Option<Self>, LensError> {
        let first_order = FirstOrder::of(lens)?;
        let (Some(pupil), diameter) = (entrance.position(), entrance.diameter()) else {
            return Ok(None);
        };
        let film = first_order.rear_vertex - film_distance;
        let from_film = |z: f64| z - film;
        let focal_point = first_order.front_focal_point;
        let focal_length = first_order.front_focal_length();
        let hyperfocal = from_film(focal_point + focal_length * diameter / confusion);
        // 1/s₁ = (1 ± blur/D)/s, where the blur is the diameter of the circle of confusion projected into the plane in
        // focus. The equation is written in reciprocals, so that a plane at infinity is no special case.
        let focus = film + focus_distance;
        let vergence = (focus - pupil).recip();
        let magnification_per_distance = focal_length / (1.0 + (pupil - focal_point) * vergence);
        let spread = confusion / (diameter * magnification_per_distance);
        let limit = |vergence: f64| {
            if vergence > 0.0 { from_film(pupil + vergence.recip()) } else { f64::INFINITY }
        };
        Ok(Some(Self { near: limit(vergence + spread), far: limit(vergence - spread), hyperfocal }))
    }
}
