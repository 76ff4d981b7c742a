//! A lens made ready for tracing in one direction.

use super::Real;
use crate::lens::{Lens, Surface, refraction::Refraction};

/// Which way rays travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the film, toward +z.
    FilmToScene,
    /// From the scene, toward -z.
    SceneToFilm,
}

/// What one surface asks of a ray, in a frame whose axis points along the travel and whose
/// origin is the surface's vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<R> {
    /// From the previous surface's vertex to this one's; 0 for the first.
    pub distance: R,
    /// 1/radius; positive when the centre lies ahead.
    pub curvature: R,
    /// Refractive index before.
    pub n: R,
    /// Refractive index after.
    pub n_after: R,
    /// n'^2 - n^2.
    pub index_step: R,
    /// Square of the clear semi-diameter.
    pub aperture: R,
    /// How far behind the ray's point a hit may lie by rounding alone, in units of V.
    pub slack: R,
}

impl<R: Real> Step<R> {
    fn new(surface: &Surface, forward: bool, distance: f64) -> Self {
        let Surface { n_scene, n_film, radius, curvature, semi_diameter, .. } = *surface;
        let (n, n_after) = if forward { (n_scene, n_film) } else { (n_film, n_scene) };
        // A type wider than double takes the reciprocal and the difference of squares itself; for
        // the others they are rounded once, from double.
        let (curvature, index_step) = if R::EPSILON < f64::EPSILON {
            let [n, n_after] = [n, n_after].map(R::from_f64);
            let curvature = if curvature == 0.0 { R::ZERO } else { R::ONE / R::from_f64(radius) };
            (curvature, (n_after - n) * (n_after + n))
        } else {
            (R::from_f64(curvature), R::from_f64((n_after - n) * (n_after + n)))
        };
        // At an incidence of 65 degrees rounding was seen to reach 60 EPSILON.
        let slack = 512.0 * R::EPSILON * (semi_diameter + distance);
        Self {
            distance: R::from_f64(distance),
            curvature: if forward { curvature } else { -curvature },
            n: R::from_f64(n),
            n_after: R::from_f64(n_after),
            index_step,
            aperture: R::from_f64(semi_diameter) * R::from_f64(semi_diameter),
            slack: R::from_f64(slack),
        }
    }
}

/// A lens made ready for tracing in one direction with numbers of type `R`.
#[derive(Clone, Debug)]
pub struct Path<R = f64> {
    pub(super) steps: Vec<Step<R>>,
    pub(super) direction: Direction,
    pub(super) refraction: Refraction,
    /// z of the first vertex met, in lens space.
    pub(super) entry: f64,
    /// z of the last vertex met, in lens space.
    pub(super) exit: f64,
}

impl<R: Real> Path<R> {
    /// Makes `lens` ready for rays in `direction`, refracted by `refraction`.
    pub fn new(lens: &Lens, direction: Direction, refraction: Refraction) -> Self {
        let forward = direction == Direction::SceneToFilm;
        let mut surfaces: Vec<_> = lens.surfaces.iter().collect();
        if !forward {
            surfaces.reverse();
        }
        let mut previous_thickness = 0.0;
        let steps = surfaces
            .iter()
            .enumerate()
            .map(|(number, surface)| {
                let distance = match (number, forward) {
                    (0, _) => 0.0,
                    (_, true) => previous_thickness,
                    (_, false) => surface.thickness,
                };
                previous_thickness = surface.thickness;
                Step::new(surface, forward, distance)
            })
            .collect();
        let (entry, exit) = (surfaces[0].vertex, surfaces[surfaces.len() - 1].vertex);
        Self { steps, direction, refraction, entry, exit }
    }

    /// How many surfaces there are.
    pub(crate) fn surfaces(&self) -> usize {
        self.steps.len()
    }

    /// Film to scene with the default refraction.
    pub fn film_to_scene(lens: &Lens) -> Self {
        Self::new(lens, Direction::FilmToScene, Refraction::default())
    }

    /// Scene to film with the default refraction.
    pub fn scene_to_film(lens: &Lens) -> Self {
        Self::new(lens, Direction::SceneToFilm, Refraction::default())
    }
}
