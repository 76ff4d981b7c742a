//! A lens with the film on which it is evaluated, and rays between the two.

mod camera_samples;
mod film_rays;
pub mod kernel_rays;
mod passing_rays;
pub mod quasirandom;

pub use camera_samples::CameraSamples;
pub use film_rays::FilmRays;
pub use passing_rays::passing_rays;

use realistic_camera::{
    Film, Raster,
    sampling::{PupilDisk, WarpedPupil},
};
use realistic_optics::{
    imaging::{
        axial_beam::semi_diameter_for_beam,
        focus::{Focus, FocusError},
    },
    lens::{Lens, first_order::FirstOrder},
    prescription::Prescription,
    trace::{Path, Ray},
};
use realistic_trace::{image_scale::ImageScale, polynomial::Polynomial};

/// A lens focused at infinity on a film.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The lens at the d line, with the stop of its file.
    pub lens: Lens,
    /// The film.
    pub film: Film,
    /// z of the film plane, lens space, mm.
    pub film_z: f64,
    /// The thick lens.
    pub first_order: FirstOrder,
    /// The rear element's disk, through which all light passes.
    pub rear: PupilDisk,
    /// The thick lens's exit pupil.
    pub exit: PupilDisk,
    /// The image's scale over the film.
    pub scale: ImageScale,
    /// The exact tracer, in double precision.
    pub path: Path<f64>,
}

/// Diagonal of the film of every subject, mm.
pub const FILM_DIAGONAL: f64 = 35.0;
/// The f-number of [`Subject::stopped_down`].
pub const STOPPED_DOWN: f64 = 8.0;
/// Pixels of the film, the unit of errors.
pub const PIXELS: Raster = Raster { xres: 1920, yres: 1280 };
/// Rays in a polynomial fit.
const FIT_RAYS: usize = 2000;

impl Subject {
    /// Focuses the lens at infinity on 35 mm film.
    ///
    /// # Errors
    /// The lens cannot focus, or its film would not be behind it.
    pub fn new(prescription: &Prescription) -> Result<Self, FocusError> {
        let lens = Lens::at_d_line(prescription);
        Self::of(FirstOrder::of(&lens)?, lens)
    }

    /// Builds [`Subject::new`] with the stop at f/8 ([`STOPPED_DOWN`]).
    ///
    /// # Errors
    /// The errors of [`Subject::new`].
    pub fn stopped_down(prescription: &Prescription) -> Result<Self, FocusError> {
        let mut lens = Lens::at_d_line(prescription);
        let first_order = FirstOrder::of(&lens)?;
        let stop = lens.stop_index().ok_or_else(|| FocusError::Dark { lens: lens.name.clone() })?;
        let closed = semi_diameter_for_beam(&lens, stop, first_order.focal_length.abs() / STOPPED_DOWN);
        let own = &mut lens.surfaces[stop].semi_diameter;
        *own = own.min(closed);
        Self::of(first_order, lens)
    }

    fn of(first_order: FirstOrder, lens: Lens) -> Result<Self, FocusError> {
        let film_z = lens.rear().vertex - Focus::new(&lens)?.film_distance(f64::INFINITY)?;
        let film = Film::new(PIXELS, FILM_DIAGONAL);
        let dark = || FocusError::Dark { lens: lens.name.clone() };
        let rear = PupilDisk::rear(&lens, film_z, film.reach()).ok_or_else(dark)?;
        let scale = ImageScale::new(&lens, film_z, film.diagonal() / 2.0, f64::INFINITY).ok_or_else(dark)?;
        let exit = PupilDisk::exit(&lens, film_z);
        let path = Path::film_to_scene(&lens);
        Ok(Self { lens, film, film_z, first_order, rear, exit, scale, path })
    }

    /// Returns rays that pass, spread over film and pupil.
    pub fn rays(&self, count: usize, seed: u32) -> Vec<Ray> {
        passing_rays(&self.path, self.film_z, self.film.diagonal() / 2.0, self.rear, count, seed)
    }

    /// Returns the distance on film, in pixels, between the film points of `exact` and of `other`; `from` is the
    /// film-side ray from which `exact` was traced.
    pub fn pixels(&self, from: &Ray, exact: &Ray, other: &Ray) -> f64 {
        let [x, y, _] = from.origin;
        self.scale.film_error([x, y], exact, other) / self.film.pixel()
    }

    /// Fits polynomials of an order (3, 5, ... 11) to 2000 of the subject's own rays, including the positions of the
    /// rays at the apertures of the given surfaces, numbered from the scene.
    pub fn fit(&self, order: usize, apertures: &[usize]) -> Polynomial {
        Polynomial::with_apertures(&self.lens, self.film_z, &self.rays(FIT_RAYS, 0), order, apertures)
            .expect("the rays are spread over film and pupil")
    }

    /// Returns the true pupil's table as a camera builds it.
    pub fn warped_pupil(&self) -> WarpedPupil {
        WarpedPupil::new(&self.path, self.film_z, self.film.reach(), [self.rear, self.exit])
    }
}
