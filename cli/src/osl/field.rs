//! Which points of the sampling plane a film point gets light from, by exact rays.
//!
//! A film point is named by its field σ = r/B: its distance r from the axis over that of the film from the sampling plane, B.
//! By σ the pupil hardly changes with the focus.

use super::optics::Optics;
use super::region::{Frame, Region};
use realistic::unstable::lens::{Lens, film_ray, pupil::ExitPupil};
use realistic::unstable::trace::Path;

/// Radius of the true pupil of the film's centre over the paraxial one, at most.
const ROOM: f64 = 2.0;

/// A lens ready to be asked, focused once.
#[derive(Debug)]
pub struct Field {
    path: Path,
    /// z of the film, mm.
    film: f64,
    /// Film to sampling plane, mm.
    pub distance: f64,
    /// In the sampling plane the pupil of the film's centre lies within this distance from the axis, mm.
    widest: f64,
    /// The field of a film point as far from the axis as the rear surface's edge.
    pub in_rear: f64,
}

impl Field {
    /// With the film so far, mm, from the sampling plane; `lens` is that of `optics` at a focus, or the
    /// same at another wavelength.
    pub fn of(optics: &Optics, lens: &Lens, distance: f64) -> Self {
        let back = distance - optics.plane;
        let rear = lens.rear();
        let by_first_order =
            ExitPupil::of_lens(lens, rear.vertex - back).slopes(0.0, 0.0, rear.vertex - back).radius;
        let to_rim = back + rear.sagitta_range()[0].min(0.0);
        Self {
            path: Path::film_to_scene(lens),
            film: rear.vertex - back,
            distance,
            widest: (1.05 * rear.semi_diameter / to_rim).min(ROOM * by_first_order) * distance,
            in_rear: rear.semi_diameter / distance,
        }
    }

    /// Whether the ray from field σ through a point of the sampling plane leaves the lens.
    pub fn passes(&self, field: f64, [x, y]: [f64; 2]) -> bool {
        let point = field * self.distance;
        let slopes = [(x - point) / self.distance, y / self.distance];
        self.path.trace(film_ray([point, 0.0], self.film, slopes)).is_ok()
    }

    /// Where the pupil of the film's centre is.
    pub fn widest(&self) -> Frame {
        Frame { x: [-self.widest, self.widest], y: self.widest }
    }

    /// The pupil of field σ in a frame.
    pub fn pupil(&self, field: f64, frame: Frame) -> Option<Region> {
        Region::find(frame, |point| self.passes(field, point))
    }

    /// The pupils of rising fields, each looked for around the one before; dark from the first that is.
    pub fn pupils(&self, fields: &[f64]) -> Vec<Region> {
        let mut frame = self.widest();
        let mut pupils = Vec::new();
        for &field in fields {
            let Some(pupil) = self.pupil(field, frame) else { break };
            frame = pupil.frame();
            pupils.push(pupil);
        }
        pupils
    }
}
