//! The image of the stop's clear aperture through the glass behind it, as a film point sees it, for any width of the
//! stop. The image is an egg-shaped ellipse whose parameters are short polynomials in the stop s.
//!
//! In the sampling plane, the image of the aperture at s is |y| <= h(s) √(1 - X²) (1 + e s X), with X = (x -
//! c(s))/w(s). Here c = c0 + c1 s² + c2 s⁴, and w/s and h/s have the same form. Rays are traced only from the film to
//! the stop; an aperture that no ray reaches sets no limit.

use super::optics::Optics;
use super::polynomial::least_squares;
use realistic_optics::lens::{Lens, film_ray};
use realistic_optics::trace::{Blocked, Path};
use std::f64::consts::PI;

/// The coefficients c0 to c2, w0 to w2, h0 to h2, and e.
pub type EggCoefficients = [f64; 10];

/// The image of a stop that sets no limit, in mm.
pub const NO_LIMIT: EggCoefficients = [0.0, 0.0, 0.0, 1e6, 0.0, 0.0, 1e6, 0.0, 0.0, 0.0];

/// Stops for which the image is traced.
const STOPS: [f64; 8] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0];
/// Number of stops from which on a third term is fitted; with fewer stops, the fit would diverge beyond them.
const STEADY: usize = 6;
/// Number of directions over half a turn in which the image is traced, minus one.
const DIRECTIONS: usize = 12;
/// Share by which the image is widened at the end, to cover images between the fields of the table.
const MARGIN: f64 = 0.002;

/// The rear group of a lens, from the film to the stop, at one focus.
#[derive(Debug)]
pub struct StopView {
    path: Path,
    film: f64,
    distance: f64,
    /// Clear semi-diameter of the widest stop, mm.
    widest: f64,
    surfaces: usize,
}

impl StopView {
    /// Makes the view for a film `distance` mm from the sampling plane; `lens` is the lens of `optics` at a focus.
    pub fn of(optics: &Optics, lens: &Lens, distance: f64) -> Self {
        let mut rear = lens.clone();
        let widest = rear.surfaces[optics.stop].semi_diameter;
        rear.surfaces.drain(..optics.stop);
        open_wide(&mut rear);
        let back = distance - optics.plane;
        Self {
            path: Path::film_to_scene(&rear),
            film: rear.rear().vertex - back,
            distance,
            widest,
            surfaces: rear.surfaces.len(),
        }
    }

    /// Returns the point in the stop, in units of the stop's radius, that a ray from field σ through a point of the
    /// sampling plane reaches.
    fn in_stop(&self, field: f64, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let point = field * self.distance;
        let slopes = [(x - point) / self.distance, y / self.distance];
        let walk = self.path.walk(film_ray([point, 0.0], self.film, slopes));
        let met = walk.surfaces_met == self.surfaces;
        // Blocking behind the stop does not matter.
        let arrived = met && matches!(walk.blocked, None | Some(Blocked::Reflected));
        arrived.then(|| [walk.ray.origin[0] / self.widest, walk.ray.origin[1] / self.widest])
    }

    /// Returns the point of the sampling plane through which a ray reaches the point `target` of the stop, by
    /// Newton's method from `start`.
    fn seen(&self, field: f64, target: [f64; 2], start: [f64; 2]) -> Option<[f64; 2]> {
        let mut point = start;
        let step = 1e-6 * self.distance;
        for _ in 0..20 {
            let [qx, qy] = self.in_stop(field, point)?;
            let [ex, ey] = [target[0] - qx, target[1] - qy];
            if ex.hypot(ey) < 1e-9 {
                return Some(point);
            }
            let along = |dx: f64, dy: f64| {
                let [ax, ay] = self.in_stop(field, [point[0] + dx, point[1] + dy])?;
                Some([(ax - qx) / step, (ay - qy) / step])
            };
            let ([a, c], [b, d]) = (along(step, 0.0)?, along(0.0, step)?);
            let determinant = a * d - b * c;
            point = [point[0] + (d * ex - b * ey) / determinant, point[1] + (a * ey - c * ex) / determinant];
        }
        None
    }

    /// Returns the image for field σ, and its centre, which approximates the centre for the next field. `near` is the
    /// centre for the previous field.
    pub fn image(&self, field: f64, near: [f64; 2]) -> Option<(EggCoefficients, [f64; 2])> {
        let center = self.seen(field, [0.0, 0.0], near)?;
        let mut before = [center; DIRECTIONS + 1];
        let mut outlines: Vec<(f64, Vec<[f64; 2]>)> = Vec::new();
        for s in STOPS {
            let outline = (0..=DIRECTIONS).map(|i| {
                let (sin, cos) = (PI * i as f64 / DIRECTIONS as f64).sin_cos();
                let found = self.seen(field, [s * cos, s * sin], before[i])?;
                before[i] = found;
                Some(found)
            });
            let Some(outline) = outline.collect() else { break };
            outlines.push((s, outline));
        }
        (outlines.len() >= 2).then(|| (egg_coefficients(&outlines), center))
    }

    /// Returns the radius of the image for the film's centre, as a polynomial s (k0 + k1 s² + k2 s⁴).
    pub fn radius(&self) -> [f64; 3] {
        let edges = STOPS.iter().filter_map(|&s| Some((s, self.seen(0.0, [s, 0.0], [0.0, 0.0])?[0].abs())));
        let (basis, radii): (Vec<_>, Vec<_>) =
            edges.map(|(s, radius)| ([1.0, s * s, s.powi(4)], radius / s)).unzip();
        least_squares(&basis, &radii)
    }
}

/// Returns the egg that encloses these images of the aperture. Each image is a list of points from the greatest x to
/// the least, or in reverse.
fn egg_coefficients(outlines: &[(f64, Vec<[f64; 2]>)]) -> EggCoefficients {
    let ends = |outline: &[[f64; 2]]| {
        let (a, b) = (outline[0][0], outline[outline.len() - 1][0]);
        [a.min(b), a.max(b)]
    };
    let basis: Vec<[f64; 3]> = outlines
        .iter()
        .map(|(s, _)| [1.0, s * s, if outlines.len() < STEADY { 0.0 } else { s.powi(4) }])
        .collect();
    let over_stops = |value: &dyn Fn(f64, &[[f64; 2]]) -> f64| -> [f64; 3] {
        least_squares(&basis, &outlines.iter().map(|(s, outline)| value(*s, outline)).collect::<Vec<_>>())
    };
    let c = over_stops(&|_, outline| f64::midpoint(ends(outline)[0], ends(outline)[1]));
    let w = over_stops(&|s, outline| (ends(outline)[1] - ends(outline)[0]) / 2.0 / s);
    // The fit gives h and h e in |y| / √(1 - X²) = h + h e X.
    let shape = |outline: &[[f64; 2]]| -> [f64; 2] {
        let [low, high] = ends(outline);
        let inner = &outline[1..outline.len() - 1];
        let at = |[x, _]: &[f64; 2]| (2.0 * x - low - high) / (high - low);
        let root = |point: &[f64; 2]| (1.0 - at(point).powi(2)).max(1e-9).sqrt();
        let basis: Vec<[f64; 2]> = inner.iter().map(|point| [1.0, at(point)]).collect();
        least_squares(&basis, &inner.iter().map(|point| point[1].abs() / root(point)).collect::<Vec<_>>())
    };
    let h = over_stops(&|s, outline| shape(outline)[0] / s);
    let [e, ..] = over_stops(&|s, outline| shape(outline)[1] / shape(outline)[0] / s);
    // Each image requires its own factor of widening; a parabola in s lies above all of these factors.
    let outside = |[w, h]: [[f64; 3]; 2], (s, outline): &(f64, Vec<[f64; 2]>)| {
        let at = |terms: [f64; 3]| terms[0] + s * s * (terms[1] + s * s * terms[2]);
        let (c, w, h) = (at(c), s * at(w), s * at(h));
        let of = |[x, y]: &[f64; 2]| ((x - c) / w).hypot(y / (h * (1.0 + e * s * (x - c) / w)));
        outline.iter().map(of).fold(1.0, f64::max)
    };
    let least = outside([w, h], &outlines[0]);
    let steepest = outlines
        .iter()
        .map(|outline| (outside([w, h], outline) / least - 1.0) / (outline.0 * outline.0))
        .fold(0.0, f64::max);
    let [w, h] = [w, h].map(|[t0, t1, t2]| [least * t0, least * (t1 + steepest * t0), least * t2]);
    let widened =
        outlines.iter().map(|outline| outside([w, h], outline)).fold(1.0, f64::max) * (1.0 + MARGIN);
    let [w, h] = [w, h].map(|terms| terms.map(|term| term * widened));
    [c[0], c[1], c[2], w[0], w[1], w[2], h[0], h[1], h[2], e]
}

/// Widens all apertures, so that they clip no ray.
fn open_wide(lens: &mut Lens) {
    for surface in &mut lens.surfaces {
        let widest = if surface.figure.is_none() { 0.9999 * surface.radius.abs() } else { f64::INFINITY };
        surface.semi_diameter = (20.0 * surface.semi_diameter).min(widest).max(surface.semi_diameter);
    }
}
