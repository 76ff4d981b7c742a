//! Depth of field: how far before and behind the plane in focus an axial point's blur on the film
//! stays below a circle of confusion, by the thick lens with its entrance pupil.
//!
//! With the entrance pupil's diameter D and the plane in focus at distance s from it, a point at s₁
//! is blurred, in the plane in focus, to D |s₁ - s|/s₁; the film shows that times the magnification
//! (H. Gross, ed., *Handbook of Optical Systems* 1, §10.5; the same as the lecture's
//! similar triangles).

use crate::lens::{Lens, LensError, first_order::FirstOrder, pupil::EntrancePupil};

/// The range in focus. Distances are from the film plane along the axis, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthOfField {
    /// Nearest distance that is sharp enough.
    pub near: f64,
    /// Farthest one; infinity where there is none.
    pub far: f64,
    /// The nearest focus distance at which infinity is sharp enough.
    pub hyperfocal: f64,
}

impl DepthOfField {
    /// The range about `focus_distance` (mm from the film, infinity included) for a film
    /// `film_distance` mm behind the last vertex and a blur of at most `confusion` mm on it.
    /// `entrance` is the pupil of the surface that limits the beam. `None` for a pupil at infinity.
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
        let hyperfocal = from_film(focal_point + first_order.focal_length * diameter / confusion);
        // 1/s₁ = (1 ± blur/D)/s, the blur being the confusion in the plane in focus; both sides
        // divided by s, so that a plane at infinity is no special case.
        let focus = film + focus_distance;
        let vergence = (focus - pupil).recip();
        let magnification_per_distance = first_order.focal_length / (1.0 + (pupil - focal_point) * vergence);
        let spread = confusion / (diameter * magnification_per_distance);
        let limit = |vergence: f64| {
            if vergence > 0.0 { from_film(pupil + vergence.recip()) } else { f64::INFINITY }
        };
        Ok(Some(Self { near: limit(vergence + spread), far: limit(vergence - spread), hyperfocal }))
    }
}
