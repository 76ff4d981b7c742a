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
    /// Its cardinal points, or the error of an afocal lens.
    pub first_order: Result<FirstOrder, LensError>,
    /// Its beam of exact rays for a distant object, with the pupils.
    pub beam: AxialBeam,
    /// The film.
    pub film: Film,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// Distance from the film plane to the plane in focus, in mm rather than the units of camera space of the parameter
    /// `focus_distance`. Infinity if focused at infinity or beyond; `None` if nothing in front of the lens is in focus.
    pub focus_distance_mm: Option<f64>,
}

impl Facts {
    /// Effective focal length, mm; negative for a diverging lens, infinite for an afocal one.
    pub fn focal_length(&self) -> f64 {
        self.first_order.as_ref().map_or(f64::INFINITY, |first_order| first_order.focal_length)
    }

    /// Focal length, without its sign, over the diameter of the axial beam at the stop in use; infinite for an afocal
    /// or a dark lens.
    pub fn fnumber(&self) -> f64 {
        self.beam.fnumber(self.focal_length())
    }

    /// z of the film, lens space, mm.
    pub fn film_z(&self) -> f64 {
        self.lens.rear().vertex - self.film_distance
    }

    /// Prepares focusing.
    ///
    /// # Errors
    /// The lens is afocal or diverging, or passes no light along its axis.
    pub fn focus(&self) -> Result<Focus, FocusError> {
        Focus::of(&self.lens, self.first_order.clone()?, &self.beam)
    }
}
