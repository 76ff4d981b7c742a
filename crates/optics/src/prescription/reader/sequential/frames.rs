//! The distances and the changes of frame from each surface with an effect to the next, composed from what the file
//! states at all its surfaces. A surface without an effect, such as a coordinate break of Zemax, only passes on its
//! thickness and its changes of frame.

use super::SequentialSurface;
use crate::prescription::coordinate_break::CoordinateBreak;

/// Thicknesses and changes of frame that follow each other.
struct Run {
    /// The sum of the thicknesses in front of the first rotation. Decentres do not affect it.
    lead: f64,
    /// The changes of frame, without `lead`, with the thicknesses between them.
    change: CoordinateBreak,
    /// The sum of the thicknesses within `change`.
    within: f64,
    /// The sum of the thicknesses behind the last change of frame, if there was a rotation.
    rest: f64,
}

impl Run {
    const EMPTY: Self = Self { lead: 0.0, change: CoordinateBreak::NONE, within: 0.0, rest: 0.0 };

    fn add_thickness(&mut self, thickness: f64) {
        if self.change.rotation == CoordinateBreak::NONE.rotation {
            self.lead += thickness;
        } else {
            self.rest += thickness;
        }
    }

    fn add(&mut self, change: Option<CoordinateBreak>) {
        if let Some(change) = change {
            let rest = std::mem::take(&mut self.rest);
            self.within += rest;
            self.change = self.change.then(&along(rest)).then(&change);
        }
    }

    /// Returns the distance to the next surface, and the change of frame in front of it.
    fn into_surface(self) -> (f64, Option<CoordinateBreak>) {
        let change = self.change.then(&along(self.rest));
        match change.along_axis() {
            Some(length) => (self.lead + length, None),
            None => (self.lead, Some(change)),
        }
    }

    /// Returns the distance to the film, which is the sum of the thicknesses, and the change of frame in front of that
    /// distance. The film moves along its own normal.
    fn into_film(self) -> (f64, Option<CoordinateBreak>) {
        match self.change.along_axis() {
            Some(length) => (self.lead + length, None),
            None => {
                let length = self.lead + self.within;
                let change = along(self.lead).then(&self.change).then(&along(-length));
                (length + self.rest, Some(change))
            }
        }
    }
}

/// Returns a shift along z.
fn along(length: f64) -> CoordinateBreak {
    CoordinateBreak::shifted([0.0, 0.0, length])
}

/// The distances and the changes of frame of a lens.
#[derive(Debug)]
pub(in super::super) struct Frames {
    /// The distance from the first surface of the file to the first one with an effect, as far as it lies in front of a
    /// rotation.
    pub front: f64,
    /// The distance behind each surface with an effect; behind the last one, to the film. Negative behind an odd number
    /// of mirrors.
    pub gaps: Vec<f64>,
    /// The change of frame in front of each surface with an effect.
    pub breaks: Vec<Option<CoordinateBreak>>,
    pub film_break: Option<CoordinateBreak>,
}

impl Frames {
    /// Returns those of the surfaces `effective`, with the thicknesses behind all surfaces. `image` is the change of
    /// frame in front of the image.
    pub(in super::super) fn of(
        surfaces: &[SequentialSurface],
        effective: &[usize],
        thicknesses: &[f64],
        image: Option<CoordinateBreak>,
    ) -> Self {
        let mut distances = Vec::with_capacity(effective.len() + 1);
        let mut breaks = Vec::with_capacity(effective.len());
        let mut run = Run::EMPTY;
        for (i, (surface, thickness)) in surfaces.iter().zip(thicknesses).enumerate() {
            run.add(surface.general.coordinate_break);
            if effective.get(breaks.len()) == Some(&i) {
                let (distance, change) = std::mem::replace(&mut run, Run::EMPTY).into_surface();
                distances.push(distance);
                breaks.push(change);
            }
            run.add(surface.break_behind);
            run.add_thickness(*thickness);
        }
        run.add(image);
        let (distance, film_break) = run.into_film();
        distances.push(distance);
        let front = distances.remove(0);
        Self { front, gaps: distances, breaks, film_break }
    }

    /// Returns the first surface with an effect, counted from 0, in front of which another configuration has another
    /// change of frame; the number of these surfaces stands for the film.
    pub(in super::super) fn differs(&self, other: &Self) -> Option<usize> {
        let all = |own: &Self| own.breaks.iter().copied().chain([own.film_break]).collect::<Vec<_>>();
        all(self).into_iter().zip(all(other)).position(|(own, other)| own != other)
    }
}

/// Effect of a decentre and tilts behind their surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Behind {
    /// They stay for the surfaces that follow.
    Stay,
    /// They are undone.
    Return,
    /// The tilts are repeated, so that the axis follows the light that a mirror reflects.
    Bend,
}

/// Returns the changes of frame in front of a surface and behind it, in the sense of Code V and RayOptics: a decentre, mm,
/// then tilts about x, y and z, degrees, of which those about x and y are positive in the left-handed sense.
///
/// # Errors
/// The bend is not known for certain; the text says so.
pub(in super::super) fn decentre_and_tilts(
    decentre: [f64; 3],
    [a, b, c]: [f64; 3],
    behind: Behind,
    is_mirror: bool,
) -> Result<[Option<CoordinateBreak>; 2], &'static str> {
    if [decentre, [a, b, c]] == [[0.0; 3]; 2] {
        return Ok([None; 2]);
    }
    let tilt = CoordinateBreak::tilted([-a, -b, c]);
    let change = CoordinateBreak::shifted(decentre).then(&tilt);
    let back = match behind {
        Behind::Stay => None,
        Behind::Return => Some(change.inverse()),
        Behind::Bend if !is_mirror || c != 0.0 || a != 0.0 && b != 0.0 => {
            return Err(
                "has a bend that is not one tilt, about x or y, of a mirror; write it as tilts before and behind the mirror",
            );
        }
        Behind::Bend => Some(tilt),
    };
    Ok([Some(change), back])
}
