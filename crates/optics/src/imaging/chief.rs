//! Chief rays of any lens: the rays that meet the centre of the stop. Apertures are left out, because the chief ray of a
//! mirror lens meets the obstruction.

use super::axial_beam::stop_or_limiting;
use crate::{
    lens::{Lens, Ray, film_ray, refraction::Refraction},
    trace::{Direction, Path},
};

/// Finds chief rays along one direction of travel.
#[derive(Clone, Debug)]
pub struct ChiefRays {
    path: Path<f64>,
    /// The number of the stop along the path, and its clear semi-diameter, mm.
    stop: usize,
    size: f64,
}

/// Largest distance from the centre of the stop, relative to its semi-diameter.
const PRECISION: f64 = 1e-11;
/// The same, for a ray that further steps do not bring nearer.
const TOLERANCE: f64 = 1e-7;
/// Maximum number of steps of Newton's iteration, and of halvings of a step.
const STEPS: u32 = 30;
const HALVINGS: u32 = 12;
/// Shortest step along the way from the film's centre.
const SHORTEST: f64 = 1e-3;
/// Differences of the rays' parameters for derivatives, relative to their unit.
const DIFFERENCE: f64 = 1e-5;

impl ChiefRays {
    /// Prepares a lens. Without a stop, the surface that limits the axial beam is taken for it.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        let number = stop_or_limiting(lens);
        let stop = match direction {
            Direction::SceneToFilm => number,
            Direction::FilmToScene => lens.surfaces.len() - 1 - number,
        };
        let path = Path::new(lens, direction, Refraction::default()).without_edges();
        Self { path, stop, size: lens.surfaces[number].semi_diameter }
    }

    /// Returns the path along which the rays are traced, without apertures.
    pub fn path(&self) -> &Path<f64> {
        &self.path
    }

    /// Returns the two parameters from which `ray` makes the ray that meets the stop's centre. The search begins at `start`;
    /// `unit` is the size of the parameters. `None` if the search finds no such ray.
    pub fn aimed(&self, ray: impl Fn([f64; 2]) -> Ray, start: [f64; 2], unit: f64) -> Option<[f64; 2]> {
        let miss = |at: [f64; 2]| self.path.meeting_point(ray(at), self.stop);
        let distance = |[x, y]: [f64; 2]| x.hypot(y) / self.size;
        let (mut at, mut here) = (start, miss(start)?);
        let moved = |at: [f64; 2], by: [f64; 2], times: f64| [at[0] + times * by[0], at[1] + times * by[1]];
        for _ in 0..STEPS {
            if distance(here) <= PRECISION {
                return Some(at);
            }
            let h = DIFFERENCE * unit;
            let derivative = |axis: [f64; 2]| {
                let [from, to] = [-h, h].map(|by| miss(moved(at, axis, by)));
                let (from, to) = (from?, to?);
                Some([0, 1].map(|i| (to[i] - from[i]) / (2.0 * h)))
            };
            let ([a, c], [b, d]) = (derivative([1.0, 0.0])?, derivative([0.0, 1.0])?);
            let determinant = a * d - b * c;
            let step = [(b * here[1] - d * here[0]) / determinant, (c * here[0] - a * here[1]) / determinant];
            // A step is shortened until it brings the ray nearer.
            let nearer = (0..HALVINGS).find_map(|halvings| {
                let next = moved(at, step, 0.5_f64.powi(halvings as i32));
                let found = miss(next)?;
                (distance(found) < distance(here)).then_some((next, found))
            });
            let Some(found) = nearer else { break };
            (at, here) = found;
        }
        (distance(here) <= TOLERANCE).then_some(at)
    }

    /// Returns the slopes of the chief ray of a film point, mm, for film at z = `film`. The search proceeds from the film's
    /// centre to the point.
    pub fn from_film(&self, point: [f64; 2], film: f64) -> Option<[f64; 2]> {
        let at = |part: f64, start: [f64; 2]| {
            let point = point.map(|coordinate| part * coordinate);
            self.aimed(|slopes| film_ray(point, film, slopes), start, 1.0)
        };
        follow(at, [0.0; 2])
    }
}

/// Follows a solution from part 0 of a way to part 1; `at` finds it at a part, beginning from the last one found.
fn follow(at: impl Fn(f64, [f64; 2]) -> Option<[f64; 2]>, start: [f64; 2]) -> Option<[f64; 2]> {
    let (mut part, mut step, mut found) = (0.0, 1.0_f64, at(0.0, start)?);
    while part < 1.0 {
        match at((part + step).min(1.0), found) {
            Some(next) => (part, found) = (part + step, next),
            None if step < SHORTEST => return None,
            None => step /= 2.0,
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{imaging::focus::Focus, prescription::catalogue};

    #[test]
    fn chief_rays_of_every_lens_meet_the_centre_of_the_stop() {
        for name in catalogue::names() {
            let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
            let focus = Focus::new(&lens).expect("not afocal");
            let film = lens.rear().vertex - focus.film_distance(1e6).expect("in reach");
            let chief = ChiefRays::new(&lens, Direction::FilmToScene);
            for point in [[0.0, 0.0], [1.0, 0.0], [0.0, -1.5], [0.5, 1.0]] {
                let slopes = chief.from_film(point, film).unwrap_or_else(|| panic!("{name}: {point:?}"));
                let ray = film_ray(point, film, slopes);
                let [x, y] = chief.path.meeting_point(ray, chief.stop).expect("met");
                assert!(x.hypot(y) < 1e-7 * chief.size, "{name}: {x} {y}");
            }
        }
    }
}
