//! The chief rays of a lens that is not round: sampled over x and y of the film, and its ST maps and rays.

use super::field::Film;
use super::map::Map;
use rayon::prelude::*;
use realistic_optics::imaging::{axial_beam::stop_or_limiting, chief::ChiefRays};
use realistic_optics::lens::{Lens, Ray, film_ray, pupil::EntrancePupil};
use realistic_optics::trace::Direction;

/// A chief ray: where it leaves the front surface, its unit direction, and the tangents under which a pinhole sees the
/// point of it that is in focus, to the right and down in the picture.
type Chief = [f64; 8];

/// The chief rays at the nodes of a grid over the film.
#[derive(Clone, Debug)]
pub struct PlaneField {
    film: Film,
    /// Distance of the nodes, pixels, along x and y, and their numbers.
    step: [f64; 2],
    count: [usize; 2],
    /// The rays in rows from the top; `None` at a node without a chief ray.
    chiefs: Vec<Option<Chief>>,
}

/// Number of intervals between nodes along the longer side of the film.
const INTERVALS: f64 = 64.0;

impl PlaneField {
    /// Traces the chief rays of a film.
    pub fn new(lens: &Lens, film: Film) -> Self {
        let chief = ChiefRays::new(lens, Direction::FilmToScene);
        let half = film.half();
        let largest = half[0].max(half[1]);
        let intervals = half.map(|half| (INTERVALS * half / largest).ceil().max(4.0));
        let step = [0, 1].map(|axis| 2.0 * half[axis] / intervals[axis]);
        let count = intervals.map(|intervals| intervals as usize + 1);
        let pinhole = EntrancePupil::of_surface(lens, stop_or_limiting(lens)).position().unwrap_or(0.0);
        let in_focus = Some(film.z + film.object_distance(lens)).filter(|plane| plane.is_finite());
        let at = |k: usize| {
            let [right, down] = [k % count[0], k / count[0]];
            // The image is upside down: the pixel at the right sees the object at the right by film at the left.
            let mm = [right as f64 * step[0] - half[0], down as f64 * step[1] - half[1]]
                .map(|px| px * film.pixel());
            let point = [-mm[0], mm[1]];
            let slopes = chief.from_film(point, film.z)?;
            let Ray { origin, direction } = chief.path().trace(film_ray(point, film.z, slopes)).ok()?;
            // Lens space has y up.
            let seen = match in_focus {
                None => direction,
                Some(plane) => {
                    let along = (plane - origin[2]) / direction[2];
                    [0, 1, 2].map(|i| origin[i] + along * direction[i] - if i == 2 { pinhole } else { 0.0 })
                }
            };
            let ([x, y, z], [dx, dy, dz]) = (origin, direction);
            let chief = [x, y, z, dx, dy, dz, seen[0] / seen[2], -seen[1] / seen[2]];
            (seen[2] > 0.0 && chief.iter().all(|part| part.is_finite())).then_some(chief)
        };
        let chiefs = (0..count[0] * count[1]).into_par_iter().map(at).collect();
        Self { film, step, count, chiefs }
    }

    /// Returns the share of the nodes that have a chief ray.
    pub fn share(&self) -> f64 {
        let found = self.chiefs.iter().filter(|chief| chief.is_some()).count();
        found as f64 / self.chiefs.len() as f64
    }

    /// Returns the chief ray at a position relative to the film's centre, to the right and down, pixels, by cubics through
    /// four nodes along each axis; `None` where one of them has no ray, or far outside the film.
    fn at(&self, position: [f64; 2]) -> Option<Chief> {
        let half = self.film.half();
        let axis = |i: usize| {
            let at = (position[i] + half[i]) / self.step[i];
            let first = (at.floor() - 1.0).clamp(0.0, (self.count[i] - 4) as f64);
            let t = at - first;
            // Lagrange's polynomials of the nodes 0, 1, 2 and 3.
            let weights = [
                (t - 1.0) * (t - 2.0) * (t - 3.0) / -6.0,
                t * (t - 2.0) * (t - 3.0) / 2.0,
                t * (t - 1.0) * (t - 3.0) / -2.0,
                t * (t - 1.0) * (t - 2.0) / 6.0,
            ];
            (-1.0..=self.count[i] as f64).contains(&at).then_some((first as usize, weights))
        };
        let ((column, across), (row, down)) = (axis(0)?, axis(1)?);
        let mut sum = [0.0; 8];
        for (j, weight) in down.iter().enumerate() {
            for (i, share) in across.iter().enumerate() {
                let node = self.chiefs[(row + j) * self.count[0] + column + i]?;
                for (sum, value) in sum.iter_mut().zip(node) {
                    *sum += weight * share * value;
                }
            }
        }
        Some(sum)
    }

    /// Returns the image scales of a pinhole in the middle of the film along x and y, pixels per unit of the tangent;
    /// `None` if the middle has no chief ray.
    pub fn central_scales(&self) -> Option<[f64; 2]> {
        let [right, left] = [self.at([1.0, 0.0])?, self.at([-1.0, 0.0])?];
        let [below, above] = [self.at([0.0, 1.0])?, self.at([0.0, -1.0])?];
        Some([2.0 / (right[6] - left[6]), 2.0 / (below[7] - above[7])])
    }

    /// Returns the chief ray of every pixel, as `map::rays` does.
    pub fn rays(&self) -> Map {
        let names = ["origin.X", "origin.Y", "origin.Z", "direction.X", "direction.Y", "direction.Z"];
        Map::new(self.film.size, names, |at| {
            let Some([x, y, z, dx, dy, dz, ..]) = self.at(at) else { return [0.0; 6] };
            let length = (dx * dx + dy * dy + dz * dz).sqrt();
            [x, y, z, dx / length, dy / length, dz / length]
        })
    }

    /// Returns the ST maps, as `map::st_maps` does, with the pinhole's image scales along x and y.
    pub fn st_maps(&self, [across, down]: [f64; 2]) -> [Map; 2] {
        let [width, height] = self.film.size.map(f64::from);
        let entry = |found: Option<[f64; 2]>| match found {
            Some([x, y]) => [0.5 + x / width, 0.5 - y / height, 1.0],
            None => [-1.0, -1.0, 0.0],
        };
        let pinhole = |at: [f64; 2]| {
            let chief = self.at(at)?;
            Some([across * chief[6], down * chief[7]])
        };
        let names = ["R", "G", "B"];
        [
            Map::new(self.film.size, names, |at| entry(inverse(&pinhole, at))),
            Map::new(self.film.size, names, |at| entry(pinhole(at))),
        ]
    }
}

/// Distance, pixels, within which an inverse is found, and the maximum number of steps.
const PRECISION: f64 = 1e-7;
const STEPS: u32 = 30;

/// Returns the position that a function takes to `target`, by Newton's iteration from `target` itself.
fn inverse(function: &impl Fn([f64; 2]) -> Option<[f64; 2]>, target: [f64; 2]) -> Option<[f64; 2]> {
    let mut at = target;
    for _ in 0..STEPS {
        let here = function(at)?;
        let miss = [target[0] - here[0], target[1] - here[1]];
        if miss[0].hypot(miss[1]) < PRECISION {
            return Some(at);
        }
        let [x, y] = [function([at[0] + 0.5, at[1]])?, function([at[0], at[1] + 0.5])?];
        let [a, c] = [2.0 * (x[0] - here[0]), 2.0 * (x[1] - here[1])];
        let [b, d] = [2.0 * (y[0] - here[0]), 2.0 * (y[1] - here[1])];
        let determinant = a * d - b * c;
        at[0] += (d * miss[0] - b * miss[1]) / determinant;
        at[1] += (a * miss[1] - c * miss[0]) / determinant;
    }
    None
}
