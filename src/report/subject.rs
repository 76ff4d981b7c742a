//! A lens with the film that it is judged on.

use crate::{
    camera::{Film, PupilDisk, Raster, ray_set::passing_rays},
    optics::{
        Lens,
        first_order::FirstOrder,
        focus::{Focus, FocusError},
    },
    prescription::Prescription,
    trace::{Path, Ray},
};

/// A lens focused at infinity on a film.
#[derive(Clone, Debug)]
pub struct Subject {
    /// At the d line and the file's stop.
    pub lens: Lens,
    /// The film.
    pub film: Film,
    /// z of the film plane, lens space, mm.
    pub film_z: f64,
    /// The thick lens.
    pub first_order: FirstOrder,
    /// The rear element's disk, through which all light comes.
    pub rear: PupilDisk,
    /// The thick lens's exit pupil.
    pub exit: PupilDisk,
    /// The exact rays.
    pub path: Path<f64>,
}

/// Diagonal of the film of every subject, mm.
pub const FILM_DIAGONAL: f64 = 35.0;
/// Pixels of the film in which errors are counted.
pub const PIXELS: Raster = Raster { xres: 1920, yres: 1280 };

impl Subject {
    /// Focuses the lens at infinity on 35 mm film.
    ///
    /// # Errors
    /// The lens cannot focus, or not on film behind it.
    pub fn new(prescription: &Prescription) -> Result<Self, FocusError> {
        let lens = Lens::at_d_line(prescription);
        let first_order = FirstOrder::of(&lens)?;
        let film_z = lens.rear().vertex - Focus::new(&lens)?.film_distance(f64::INFINITY)?;
        let film = Film::new(PIXELS, FILM_DIAGONAL);
        let rear = PupilDisk::rear(&lens, film_z, film.reach())
            .ok_or_else(|| FocusError::Dark { lens: lens.name.clone() })?;
        let exit = PupilDisk::exit(&lens, film_z);
        let path = Path::film_to_scene(&lens);
        Ok(Self { lens, film, film_z, first_order, rear, exit, path })
    }

    /// Rays that get through, spread over film and pupil.
    pub fn rays(&self, count: usize, seed: u32) -> Vec<Ray> {
        passing_rays(&self.path, self.film_z, self.film.diagonal() / 2.0, self.rear, count, seed)
    }

    /// What an angle in the scene is on the film, in pixels, by the focal length.
    pub fn pixels(&self, angle: f64) -> f64 {
        (angle * self.first_order.focal_length / self.film.pixel()).abs()
    }
}
