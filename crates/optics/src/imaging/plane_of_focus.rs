//! The film that brings a plane through three points of the scene into focus: the distance and the tilt of that film
//! (T. Scheimpflug 1904).
//!
//! First-order optics images points to points and planes to planes. In air, a point at the distance s in front of the
//! front principal plane has its image at s' = f s/(s - f) behind the rear principal plane, with the magnification s'/s.
//! The film is the plane through the images of the three points. For a film tilted by a, the plane of focus is tilted by
//! b, where tan b = (s/s') tan a. This holds in any media.
//!
//! Exact rays come to focus a little before or behind first-order rays. The film is moved by the difference found on
//! the axis.

use thiserror::Error;

use super::focus::Focus;
use realistic_base::{
    message::short,
    numeric::{cross, dot, unit},
};

/// A film that is in focus on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocusedFilm {
    /// Distance from the last vertex to the film's centre, on the axis, mm.
    pub film_distance: f64,
    /// Tilt about x and then about y, degrees, as in the parameters `film_tilt_x` and `film_tilt_y`.
    pub tilt: [f64; 2],
}

/// The reason why no film is in focus on a plane.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlaneError {
    /// A point is not a place in the scene.
    #[error("point {number} is not three finite numbers; give x, y and z in mm")]
    NotFinite {
        /// The point, counted from 1.
        number: usize,
    },
    /// A point has no real image.
    #[error(
        "point {number} at z = {} mm has no real image: it must lie in front of the focal point, at z > {} mm",
        short(*z),
        short(*least)
    )]
    TooNear {
        /// The point, counted from 1.
        number: usize,
        /// The z coordinate of the point, mm.
        z: f64,
        /// The z coordinate of the front focal point, mm.
        least: f64,
    },
    /// The points lie on a line, or in a plane through the axis.
    #[error(
        "the points do not define a plane that a film can lie in: they lie on a line, or in a plane along the axis"
    )]
    NoPlane,
    /// The film would stand in the lens.
    #[error("the plane needs film {} mm behind the last vertex, which is not behind the lens", short(*film_distance))]
    InLens {
        /// The distance from the last vertex to the film, mm.
        film_distance: f64,
    },
}

/// Sine of the smallest angle between the sides of a triangle whose plane is well defined.
const LEAST_ANGLE: f64 = 1e-6;

impl FocusedFilm {
    /// Finds the film for a plane through three points. Their coordinates (x, y, z) are in lens space, mm, with z
    /// toward the scene.
    ///
    /// # Errors
    /// A number is not finite, a point has no real image, the points define no plane, or the film would stand in the
    /// lens.
    pub fn on(focus: &Focus, points: [[f64; 3]; 3]) -> Result<Self, PlaneError> {
        let lens = focus.first_order();
        let mut images = [[0.0; 3]; 3];
        for (number, (image, point)) in (1..).zip(images.iter_mut().zip(points)) {
            if point.iter().any(|part| !part.is_finite()) {
                return Err(PlaneError::NotFinite { number });
            }
            let [x, y, z] = point;
            if z <= lens.front_focal_point {
                return Err(PlaneError::TooNear { number, z, least: lens.front_focal_point });
            }
            let beyond = z - lens.front_focal_point;
            // Newton's equation: the image lies f f'/(s - f) behind F', and the magnification is f/(s - f).
            let scale = -lens.front_focal_length() / beyond;
            *image = [x * scale, y * scale, lens.rear_focal_point + lens.rear_focal_length() * scale];
        }
        let normal = unit(normal(images, LEAST_ANGLE).ok_or(PlaneError::NoPlane)?);
        let normal = if normal[2] < 0.0 { normal.map(|part| -part) } else { normal };
        if normal[2] < LEAST_ANGLE {
            return Err(PlaneError::NoPlane);
        }
        let [nx, ny, nz] = normal;
        let centre = images[0][2] + (nx * images[0][0] + ny * images[0][1]) / nz;
        let film_distance = lens.rear_vertex - centre + correction(focus, centre);
        if film_distance <= 0.0 {
            return Err(PlaneError::InLens { film_distance });
        }
        Ok(Self { film_distance, tilt: [(-ny).atan2(nz), nx.asin()].map(f64::to_degrees) })
    }
}

/// Returns the distance from the first-order image on the axis at z = `image` to the best image of exact rays, mm,
/// positive away from the lens. If the object of that image does not lie in front of the lens, the distance is that for
/// an object at infinity.
fn correction(focus: &Focus, image: f64) -> f64 {
    let lens = focus.first_order();
    let behind = lens.rear_vertex - image;
    let distance = lens.object_distance(behind).unwrap_or(f64::INFINITY);
    let at = |distance| {
        let exact = focus.film_distance(distance).ok()?;
        Some(exact - focus.paraxial_film_distance(distance)?)
    };
    at(distance).or_else(|| at(f64::INFINITY)).unwrap_or(0.0)
}

/// Returns a vector of any length normal to a triangle. Returns `None` if two sides of the triangle are parallel: the
/// sine of the angle between them is at most `least_sine`.
fn normal([a, b, c]: [[f64; 3]; 3], least_sine: f64) -> Option<[f64; 3]> {
    let [u, v] = [b, c].map(|to| [0, 1, 2].map(|axis| to[axis] - a[axis]));
    let (normal, length) = (cross(u, v), |side: [f64; 3]| dot(side, side).sqrt());
    (length(normal) > least_sine * length(u) * length(v)).then_some(normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{lens::Lens, prescription::read};

    /// Returns a thin lens with a focal length of 50 mm and a small stop.
    fn thin() -> Focus {
        let text = "50 1e-9 1.5 20\n-50 0 0 20\n";
        let lens = Lens::at_d_line(&read("thin", text.as_bytes()).expect("a lens"));
        Focus::new(&lens).expect("it focuses")
    }

    #[test]
    fn the_planes_meet_in_scheimpflugs_line() {
        let focus = thin();
        let lens = focus.first_order();
        assert!((lens.focal_length - 50.0).abs() < 1e-6);
        // A plane through the axis at s = 1000, tilted by b = 58.97 degrees.
        let s = 1000.0 + lens.front_principal_plane;
        let image = 50.0 * 1000.0 / 950.0;
        let tan = 1000.0 / image * 5.0_f64.to_radians().tan();
        assert!((tan.atan().to_degrees() - 58.97).abs() < 0.005);
        let about_x = [[0.0, 100.0, s + 100.0 * tan], [0.0, -100.0, s - 100.0 * tan], [300.0, 0.0, s]];
        let found = FocusedFilm::on(&focus, about_x).expect("reachable");
        assert!((found.tilt[0].abs() - 5.0).abs() < 1e-6 && found.tilt[1].abs() < 1e-9, "{found:?}");
        let about_y = about_x.map(|[x, y, z]| [y, x, z]);
        let found = FocusedFilm::on(&focus, about_y).expect("reachable");
        assert!((found.tilt[1].abs() - 5.0).abs() < 1e-6 && found.tilt[0].abs() < 1e-9, "{found:?}");
        let across = [[0.0, 0.0, s], [10.0, 0.0, s], [0.0, 10.0, s]];
        let found = FocusedFilm::on(&focus, across).expect("reachable");
        let exact = focus.film_distance(s - lens.rear_vertex + found.film_distance).expect("reachable");
        assert!(found.tilt.iter().all(|tilt| tilt.abs() < 1e-9), "{found:?}");
        assert!((found.film_distance - exact).abs() < 1e-3, "{found:?} {exact}");
    }

    #[test]
    fn planes_out_of_reach_are_refused_with_the_reason() {
        let focus = thin();
        let refused = |points| FocusedFilm::on(&focus, points).expect_err("out of reach").to_string();
        let (far, near) = ([0.0, 0.0, 1000.0], [10.0, 0.0, 30.0]);
        assert!(refused([far, near, [0.0, 10.0, 500.0]]).contains("point 2 at z = 30 mm"));
        assert!(refused([far, [10.0, 0.0, 1000.0], [20.0, 0.0, 1000.0]]).contains("on a line"));
        assert!(refused([far, [0.0, 10.0, 500.0], [0.0, -10.0, 700.0]]).contains("along the axis"));
        assert!(refused([far, [f64::NAN, 0.0, 1.0], far]).contains("point 2 is not three finite"));
    }
}
