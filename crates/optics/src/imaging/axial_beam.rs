//! The axial beam, traced with exact rays: its width and the surface that limits it. The f-number, the pupils, the stop
//! diameter that gives an f-number, and the cone of light at the film's centre follow from these.
//!
//! Code that needs a pupil or an f-number uses the result, an [`AxialBeam`].
//!
//! First-order optics takes the aperture with the smallest image as the aperture stop (W. J. Smith, *Modern Optical
//! Engineering*, on stops and pupils). In a fast lens a real ray is lower or higher at a surface than the paraxial ray,
//! and another aperture may limit the beam. Here the limiting aperture is the one that blocks the first ray outside the
//! beam. The pupils lie where first-order optics images that aperture. The entrance pupil is as wide as the beam, so
//! that the f-number is the focal length 1/φ divided by the diameter of the entrance pupil. By Abbe's sine condition
//! this is 1/(2 n' sin U') in any medium. The exit pupil is larger or smaller than the entrance pupil by the
//! magnification between the two.

use std::f64::consts::FRAC_PI_2;

use crate::{
    lens::{
        Lens, Ray,
        pupil::{EntrancePupil, ExitPupil},
    },
    trace::{Blocked, Direction, Path},
};
use realistic_base::numeric::edge;

/// The beam of a distant point on the axis, and its pupils.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialBeam {
    /// Index, counted from the scene, of the surface that limits the beam. Either the aperture of this surface clips
    /// the first ray outside the beam, or that ray ends at this surface for another reason.
    pub limiting: usize,
    /// Image of the limiting surface's aperture, formed by the glass in front of it. The image is as wide as the beam.
    pub entrance: EntrancePupil,
    /// Image of the limiting surface's aperture, formed by the glass behind it.
    pub exit: ExitPupil,
    /// Diameter of the entrance pupil by first-order optics alone, mm: the diameter of the smallest image of any
    /// aperture.
    pub paraxial_diameter: f64,
}

impl AxialBeam {
    /// Traces the rays parallel to the axis. The beam extends to the outermost ray that gets through, even if some rays
    /// nearer to the axis are blocked. If no ray gets through, the diameter is 0 and the pupils are those of
    /// first-order optics alone.
    pub fn of(lens: &Lens) -> Self {
        let images: Vec<f64> = (0..lens.surfaces.len())
            .map(|surface| EntrancePupil::of_surface(lens, surface).diameter())
            .collect();
        let paraxial = (0..images.len()).min_by(|&a, &b| images[a].total_cmp(&images[b])).unwrap_or(0);
        let start = in_front(lens);
        let ray = |height: f64| Ray { origin: [0.0, height, start], direction: [0.0, 0.0, -1.0] };
        let marginal = outermost(&Path::scene_to_film(lens), lens.front().semi_diameter, ray);
        let (limiting, height) = marginal.unwrap_or((paraxial, 0.0));
        let entrance = EntrancePupil::of_surface(lens, limiting).with_diameter(2.0 * height);
        Self {
            limiting,
            entrance,
            exit: ExitPupil::of_surface(lens, limiting).conjugate_to(&entrance),
            paraxial_diameter: images[paraxial],
        }
    }

    /// Returns whether no ray parallel to the axis gets through.
    pub fn is_dark(&self) -> bool {
        self.diameter() == 0.0
    }

    /// Returns the diameter of the beam in front of the lens, mm.
    pub fn diameter(&self) -> f64 {
        self.entrance.diameter()
    }

    /// Returns the f-number of a lens: the focal length 1/φ (mm, of either sign) divided by the diameter of the beam. The
    /// f-number of an afocal or a dark lens is infinite.
    pub fn fnumber(&self, focal_length: f64) -> f64 {
        focal_length.abs() / self.diameter()
    }

    /// Returns the f-number by first-order optics alone: the focal length divided by [`AxialBeam::paraxial_diameter`].
    pub fn paraxial_fnumber(&self, focal_length: f64) -> f64 {
        focal_length.abs() / self.paraxial_diameter
    }
}

/// Returns the index of the surface whose centre the chief rays pass through: the stop or, in a lens without a stop,
/// the surface that limits the axial beam.
pub fn stop_or_limiting(lens: &Lens) -> usize {
    lens.stop_index().unwrap_or_else(|| AxialBeam::of(lens).limiting)
}

/// Returns the clear semi-diameter, mm, of surface `surface` that makes the axial beam `diameter` mm wide. This is the
/// height at that surface of the ray that enters the lens at a distance of `diameter / 2` from the axis. If that ray
/// does not reach the surface, the result is that of first-order optics.
pub fn semi_diameter_for_beam(lens: &Lens, surface: usize, diameter: f64) -> f64 {
    let mut height = None;
    let start = in_front(lens);
    Path::<f64>::scene_to_film(lens).intersections(start, [0.0, diameter / 2.0], [0.0; 2], |met| {
        height = (met.surface == surface).then(|| met.point[1].abs());
        met.surface < surface
    });
    let first_order = || EntrancePupil::of_surface(lens, surface).semi_diameter_for(diameter);
    height.filter(|height| *height > 0.0).unwrap_or_else(first_order)
}

/// Traces rays from the film's centre, at z = `film` (lens space, mm), and finds the outermost ray that gets through.
/// Returns the index of the surface that limits this cone of light, counted from the scene, and the tangent of the
/// cone's half angle; `None` if the centre is dark.
pub fn axial_cone(lens: &Lens, film: f64) -> Option<(usize, f64)> {
    let rear = lens.rear();
    let [nearest, _] = rear.sagitta_range();
    // No ray through the rear surface has a steeper angle.
    let steepest = rear.semi_diameter.atan2(rear.vertex + nearest - film).min(FRAC_PI_2);
    let ray = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        Ray { origin: [0.0, 0.0, film], direction: [0.0, sine, cosine] }
    };
    let (limiting, angle) = outermost(&Path::film_to_scene(lens), steepest, ray)?;
    Some((limiting, angle.tan()))
}

/// Number of equal steps in the search for the outermost ray, from the edge inward. Rays that get through only within
/// an annulus narrower than a step may be missed.
const STEPS: u32 = 256;
/// Number of times that the innermost step is then halved, because a stop may be a pinhole.
const HALVINGS: i32 = 64;

/// Searches the rays with parameters from 0, the axis, to `most` for the outermost ray that gets through. No ray beyond
/// `most` gets through. Returns the index, counted from the scene, of the surface that stops the next ray outward, and
/// the parameter of the outermost ray.
fn outermost(path: &Path, most: f64, ray: impl Fn(f64) -> Ray) -> Option<(usize, f64)> {
    let passes = |size: f64| path.trace(ray(size)).is_ok();
    let equal = (1..=STEPS).rev().map(|i| most * (f64::from(i) / f64::from(STEPS)));
    let halved = (1..=HALVINGS).map(|k| most / f64::from(STEPS) * 0.5_f64.powi(k));
    let mut blocked = most * (1.0 + 1e-9);
    for size in equal.chain(halved).chain([0.0]) {
        if passes(size) {
            let size = edge(size, blocked, 0.0, passes);
            return Some((stopped_at(path, ray(size.next_up())), size));
        }
        blocked = size;
    }
    None
}

/// Returns the index, counted from the scene, of the surface that stops a ray.
fn stopped_at(path: &Path, ray: Ray) -> usize {
    let walk = path.walk(ray);
    let last = path.surfaces() - 1;
    let along = match walk.blocked {
        // The last surface that the ray meets stops it.
        Some(Blocked::Clipped | Blocked::Reflected) => walk.surfaces_met.saturating_sub(1),
        // The ray does not meet the surface that stops it.
        _ => walk.surfaces_met.min(last),
    };
    match path.direction() {
        Direction::SceneToFilm => along,
        Direction::FilmToScene => last - along,
    }
}

/// Returns the z coordinate of a plane in front of the whole lens, mm.
pub(super) fn in_front(lens: &Lens) -> f64 {
    lens.surfaces.iter().map(|surface| surface.vertex + surface.sagitta_range()[1]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::read;

    #[test]
    fn a_stop_is_sized_whatever_its_size_was() {
        // The beam is wider than the spheres, so that its outermost ray does not exist.
        let lens = read("t", b"20 5 1.5 30\n-20 1 1 30\n0 40 0 8\n").expect("a lens");
        let mut lens = Lens::at_d_line(&lens);
        let sized = [4.0, 0.3, 1.0 / 7.0].map(|size| {
            lens.surfaces[2].semi_diameter = size;
            semi_diameter_for_beam(&lens, 2, 50.0)
        });
        assert_eq!(sized, [sized[0]; 3]);
        lens.surfaces[2].semi_diameter = sized[0];
        assert!((EntrancePupil::of_surface(&lens, 2).diameter() - 50.0).abs() < 1e-12);
    }
}
