//! The facts of a camera with a prescription: its lens, its film, and their first-order properties.

use crate::sampling::film::Film;
use realistic_optics::{
    imaging::{
        axial_beam::AxialBeam,
        focus::{Focus, FocusError},
    },
    lens::{Lens, LensError, first_order::FirstOrder},
};

/// A lens and the film behind it.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The lens, at the wavelength and stop in use.
    pub lens: Lens,
    /// The lens's cardinal points, or the error if the lens is afocal.
    pub first_order: Result<FirstOrder, LensError>,
    /// The lens's beam of exact rays from a distant object, with the pupils.
    pub beam: AxialBeam,
    /// The film.
    pub film: Film,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// Distance from the film plane to the plane in focus, mm; the parameter `focus_distance`, in contrast,
    /// is in units of camera space. Infinity if the lens is focused at infinity or beyond; `None` if nothing
    /// in front of the lens is in focus.
    pub focus_distance_mm: Option<f64>,
}

impl Facts {
    /// Returns the effective focal length, mm; negative for a diverging lens, infinite for an afocal one.
    pub fn focal_length(&self) -> f64 {
        self.first_order.as_ref().map_or(f64::INFINITY, |first_order| first_order.focal_length)
    }

    /// Returns the absolute focal length divided by the diameter of the axial beam at the stop in use;
    /// infinite for an afocal lens and for a dark lens.
    pub fn fnumber(&self) -> f64 {
        self.beam.fnumber(self.focal_length())
    }

    /// Returns z of the film, lens space, mm.
    pub fn film_z(&self) -> f64 {
        self.lens.rear().vertex - self.film_distance
    }

    /// Prepares the lens for focusing by exact rays.
    ///
    /// # Errors
    /// The lens is afocal or diverging, or passes no light along its axis.
    pub fn focus(&self) -> Result<Focus, FocusError> {
        Focus::of(&self.lens, self.first_order.clone()?, &self.beam)
    }
}
