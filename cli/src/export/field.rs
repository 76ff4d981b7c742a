//! The exact chief rays of a film, sampled along one radius.

use super::table::RadialFunction;
use realistic_base::message::short;
use realistic_optics::imaging::{axial_beam::stop_or_limiting, focus::Focus};
use realistic_optics::lens::{Lens, pupil::EntrancePupil};
use realistic_trace::field::Field;

/// The film: its pixels, which are square, and its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Diagonal, mm.
    pub diagonal: f64,
    /// z of the film plane in lens space, mm.
    pub z: f64,
}

impl Film {
    /// Returns the side of a pixel, mm.
    pub fn pixel(&self) -> f64 {
        self.diagonal / (2.0 * self.corner())
    }

    /// Returns the distance from the centre to a corner, pixels.
    pub fn corner(&self) -> f64 {
        let [width, height] = self.size.map(f64::from);
        0.5 * width.hypot(height)
    }

    /// Returns the distances from the centre to the right and lower edges, pixels.
    pub fn half(&self) -> [f64; 2] {
        self.size.map(|side| 0.5 * f64::from(side))
    }

    /// Returns width and height, mm.
    pub fn sides(&self) -> [f64; 2] {
        self.half().map(|half| 2.0 * half * self.pixel())
    }

    /// Returns the centre in pixels; the centre of pixel (0, 0) is at (0, 0).
    pub fn principal_point(&self) -> [f64; 2] {
        self.half().map(|half| half - 0.5)
    }

    /// Returns the distance of the plane in focus from the film, mm; infinite for a film beyond the image of any object,
    /// which has nothing in focus.
    pub fn object_distance(&self, lens: &Lens) -> f64 {
        // After rounding, an object at infinity may be merely far away.
        Focus::new(lens)
            .ok()
            .and_then(|focus| focus.object_distance(lens.rear().vertex - self.z))
            .filter(|distance| *distance < INFINITE * self.diagonal)
            .unwrap_or(f64::INFINITY)
    }

    /// Returns the angle of the part of a circle that lies on the film; `radius` is in pixels.
    fn arc(&self, radius: f64) -> f64 {
        // In one quadrant the arc runs from one edge of the film to the other.
        let [right, down] = self.half().map(|half| (half / radius).min(1.0).acos());
        4.0 * (std::f64::consts::FRAC_PI_2 - right - down).max(0.0)
    }
}

/// A distance from the film's centre, and the chief ray of the film points at this distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Distance from the centre, pixels.
    pub radius: f64,
    /// Point at which the ray leaves the front surface, mm: its distance from the axis, positive on the side toward
    /// which the ray travels, and its z.
    pub origin: [f64; 2],
    /// Unit direction of the ray in the same axes.
    pub direction: [f64; 2],
    /// z at which the ray crosses the axis, mm.
    pub pupil: f64,
    /// Angle from the axis at which the pinhole sees the point of the ray that is in focus.
    pub angle: f64,
    /// Share of the film's area that the ring represents.
    pub share: f64,
}

/// The chief rays of all film points with light.
#[derive(Clone, Debug)]
pub struct ChiefField {
    /// The film.
    pub film: Film,
    /// z of the models' pinhole: the paraxial entrance pupil, mm.
    pub pinhole: f64,
    /// z of the plane in focus, mm; may be infinite.
    pub in_focus: f64,
    /// Distance from the centre up to which the film gets light, pixels.
    pub lit: f64,
    /// The rays at even steps from the centre to `lit`.
    pub rings: Vec<Ring>,
}

/// A lens whose chief rays no model can represent.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The film's centre gets no light.
    #[error("lens \"{0}\" leaves the centre of the film dark; give another --film-distance or stop")]
    Dark(String),
    /// The lens sees parallel to the axis.
    #[error(
        "lens \"{0}\" has its entrance pupil at infinity: it sees parallel to its axis, and no camera with a projection centre does"
    )]
    Telecentric(String),
    /// The plane in focus is not in front of the pinhole.
    #[error(
        "lens \"{lens}\" is focused {} mm in front of its film, which is not in front of its entrance pupil; focus farther away",
        short(*.distance)
    )]
    TooNear {
        /// The lens.
        lens: String,
        /// Distance from the film to the plane in focus, mm.
        distance: f64,
    },
}

/// Largest distance of an off-axis object from the pinhole, as a multiple of the distance from the pinhole to the
/// plane in focus along the axis.
///
/// A ray at 90 degrees to the axis never meets the plane in focus. An object ten times as far away looks like one at
/// infinity, except for a tenth of the effect that pupil shift has at the plane in focus.
const FARTHEST: f64 = 10.0;

/// Object distance, in film diagonals, that counts as infinity: no pupil shift is large enough to change a pixel.
const INFINITE: f64 = 1e9;

impl ChiefField {
    /// Traces the rays of `count` evenly spaced film points.
    ///
    /// # Errors
    /// There is no light on the axis, or no position for a pinhole.
    pub fn new(lens: &Lens, film: Film, count: u32) -> Result<Self, FieldError> {
        let field = Field::new(lens, film.z);
        let corner = 0.5 * film.diagonal;
        let lit = field.lit_radius(corner).ok_or_else(|| FieldError::Dark(lens.name.clone()))?;
        let pinhole = EntrancePupil::of_surface(lens, stop_or_limiting(lens))
            .position()
            .ok_or_else(|| FieldError::Telecentric(lens.name.clone()))?;
        let distance = film.object_distance(lens);
        let in_focus = film.z + distance;
        if !(in_focus > pinhole.max(0.0)) {
            return Err(FieldError::TooNear { lens: lens.name.clone(), distance });
        }
        let rays = field.chief_rays(lit / f64::from(count - 1), count);
        let step = film.pixel().recip();
        let mut rings: Vec<Ring> = rays
            .iter()
            .map(|(height, ray)| {
                let ([_, y, z], [_, dy, dz]) = (ray.origin, ray.direction);
                // The image is upside down: a film point above the axis sees an object below. Subtraction from 0 drops
                // the sign of -0 on the axis.
                let (origin, direction) = ([0.0 - y, z], [0.0 - dy, dz]);
                let pupil = if *height > 0.0 { z - y * dz / dy } else { pinhole };
                let angle = seen(origin, direction, pinhole, in_focus);
                Ring { radius: height * step, origin, direction, pupil, angle, share: 0.0 }
            })
            .collect();
        let area: f64 = film.size.iter().map(|&side| f64::from(side)).product();
        let width = lit * step / f64::from(count - 1);
        for ring in &mut rings {
            ring.share =
                if ring.radius > 0.0 { film.arc(ring.radius) * ring.radius * width / area } else { 0.0 };
        }
        let lit = rings.last().map_or(0.0, |ring| ring.radius);
        if !(lit > 0.0) {
            return Err(FieldError::Dark(lens.name.clone()));
        }
        Ok(Self { film, pinhole, in_focus, lit, rings })
    }

    /// Returns the rays for objects in another plane, at z = `plane`.
    pub fn looking_at(&self, plane: f64) -> Self {
        let angle = |ring: &Ring| seen(ring.origin, ring.direction, self.pinhole, plane);
        let rings = self.rings.iter().map(|ring| Ring { angle: angle(ring), ..*ring }).collect();
        Self { rings, in_focus: plane, ..self.clone() }
    }

    /// Returns the rays within an angle from the axis.
    pub fn within(&self, angle: f64) -> Self {
        let rings: Vec<Ring> = self.rings.iter().copied().take_while(|ring| ring.angle < angle).collect();
        let lit = rings.last().map_or(0.0, |ring| ring.radius);
        Self { rings, lit, ..self.clone() }
    }

    /// Returns the largest angle from the axis, and the largest pupil shift from the pinhole, mm.
    pub fn extent(&self) -> (f64, f64) {
        let walk = |ring: &Ring| (ring.pupil - self.pinhole).abs();
        let most = |value: &dyn Fn(&Ring) -> f64| self.rings.iter().map(value).fold(0.0, f64::max);
        (most(&|ring| ring.angle), most(&walk))
    }

    /// Returns the share of the film that has light.
    pub fn share(&self) -> f64 {
        let share: f64 = self.rings.iter().map(|ring| ring.share).sum();
        share.min(1.0)
    }

    /// Returns the image scale of a pinhole in the middle of the film, pixels per unit of the tangent.
    pub fn central_scale(&self) -> f64 {
        // Distortion is of third order, so the ring nearest the axis has none.
        let ring = self.rings[1.min(self.rings.len() - 1)];
        ring.radius / ring.angle.tan()
    }

    /// Returns a value of every ring as an odd function of the distance from the centre in pixels.
    pub fn odd(&self, value: impl Fn(&Ring) -> f64) -> RadialFunction {
        RadialFunction::odd(self.step(), self.rings.iter().map(value).collect())
    }

    /// Returns a value of every ring as an even function of the distance from the centre in pixels.
    pub fn even(&self, value: impl Fn(&Ring) -> f64) -> RadialFunction {
        RadialFunction::even(self.step(), self.rings.iter().map(value).collect())
    }

    fn step(&self) -> f64 {
        self.rings[1.min(self.rings.len() - 1)].radius
    }

    /// Returns the point of a ring's ray that is in focus; `None` at infinity.
    pub fn point(&self, ring: &Ring) -> Option<[f64; 2]> {
        point(ring.origin, ring.direction, self.pinhole, self.in_focus)
    }
}

/// Returns the point of a ray on the plane z = `plane`. If the ray does not meet the plane, or meets it at more than
/// [`FARTHEST`] times the plane's distance from the pinhole, returns the ray's point at that multiple of the
/// distance.
fn point([h, z]: [f64; 2], [dh, dz]: [f64; 2], pinhole: f64, plane: f64) -> Option<[f64; 2]> {
    if plane == f64::INFINITY {
        return None;
    }
    let at = |along: f64| [h + along * dh, z + along * dz];
    let most = FARTHEST * (plane - pinhole);
    let along = (plane - z) / dz;
    let [x, y] = at(along);
    if along > 0.0 && x.hypot(y - pinhole) <= most {
        return Some([x, y]);
    }
    // The root of |o + along d - pinhole| = most that lies ahead on the ray.
    let half = h * dh + (z - pinhole) * dz;
    let rest = h * h + (z - pinhole).powi(2) - most * most;
    Some(at((half * half - rest).max(0.0).sqrt() - half))
}

/// Returns the angle from the axis at which the pinhole sees the point of a ray on the plane z = `plane`.
fn seen(origin: [f64; 2], direction: [f64; 2], pinhole: f64, plane: f64) -> f64 {
    let [x, y] = match point(origin, direction, pinhole, plane) {
        Some([h, z]) => [h, z - pinhole],
        None => direction,
    };
    x.atan2(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_circles_of_a_film_have_its_area() {
        let film = Film { size: [480, 320], diagonal: 35.0, z: -60.0 };
        let step = film.corner() / 20_000.0;
        let area: f64 = (1..=20_000).map(|i| f64::from(i) * step).map(|r| film.arc(r) * r * step).sum();
        assert!((area / (480.0 * 320.0) - 1.0).abs() < 1e-3, "{area}");
        assert!((film.arc(100.0) - 2.0 * PI).abs() < 1e-12 && film.arc(film.corner() + 1.0) == 0.0);
        assert!((film.pixel() * 480.0_f64.hypot(320.0) - 35.0).abs() < 1e-12);
    }

    #[test]
    fn objects_are_on_the_plane_of_focus_or_on_a_sphere() {
        let [h, z] = point([1.0, 0.0], [0.6, 0.8], -10.0, 790.0).unwrap();
        assert!((h - 593.5).abs() < 1e-9 && (z - 790.0).abs() < 1e-9);
        let [h, z] = point([3.0, 0.0], [0.8, -0.6], -10.0, 790.0).unwrap();
        assert!((h.hypot(z + 10.0) - 8000.0).abs() < 1e-6 && h > 0.0 && z < 0.0);
        assert_eq!(point([3.0, 0.0], [0.8, -0.6], -10.0, f64::INFINITY), None);
    }
}
