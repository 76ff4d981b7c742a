//! The pupils of all points of a film at every wavelength of a range.
//!
//! As the wavelength changes, the pupil and the image on the film shift and grow slightly, nearly in
//! proportion to the refractive indices of the glasses. These change nearly in proportion to 1/λ² (A.-L.
//! Cauchy; λ is the wavelength). So the columns of the grid lie at equal steps of 1/λ².

use super::{
    FilmRadii, Grid, LanePupil, PupilFilmSide, PupilMap,
    film::{Heading, aim},
    pencil::{Family, Pencil},
};
use crate::sampling::{film_rays::FilmRays, pupil_disk::PupilDisk};
use realistic_base::numeric::Real;
use realistic_simd::{Cpu, Lanes, Scalar};

/// Number of intervals between the columns. More intervals make the first request for a wavelength take
/// longer; fewer block more samples.
const COLUMNS: usize = 4;

/// The true pupil of every point of a film, at every wavelength of a range. Immutable once built.
#[derive(Clone, Debug)]
pub struct SpectralPupil {
    /// 1/λ² of the first column, 1/μm².
    first: f64,
    /// Number of columns per unit of 1/λ².
    per_w: f64,
    map: PupilMap,
    cover: PupilDisk,
}

/// Constants of look-ups, in the precision of the lanes.
#[derive(Clone, Copy, Debug)]
pub struct LaneSpectralPupil<S> {
    first: S,
    per_w: S,
    pupil: LanePupil<S>,
}

/// The rays on the film's side of a lens, at each column and halfway between columns.
struct Spectrum(Vec<FilmRadii>);

impl Spectrum {
    fn at(&self, column: f64) -> &FilmRadii {
        &self.0[(2.0 * column).round() as usize]
    }
}

impl Family for Spectrum {
    const SYMMETRIC: bool = true;
    const ENDS: bool = true;

    fn pencil(&self, radius: f64, column: f64) -> impl Pencil + '_ {
        self.at(column).pencil(radius, 0.0)
    }

    fn reach(&self) -> f64 {
        self.0[0].reach()
    }

    fn intervals(&self) -> [usize; 2] {
        [self.0[0].intervals()[0], COLUMNS]
    }
}

/// Returns 1/λ² in 1/μm² for a wavelength λ in nm.
fn w(wavelength: f64) -> f64 {
    (wavelength * 1e-3).powi(-2)
}

impl SpectralPupil {
    /// Tabulates the pupils for wavelengths from `shortest` to `longest`, nm, and film points up to `reach`
    /// mm from the axis. `side` returns the rays on the film's side of the lens at a wavelength, and the disk
    /// that contains every pupil. `None` if `side` returns `None`.
    pub fn new(
        [shortest, longest]: [f64; 2],
        reach: f64,
        side: impl Fn(f64) -> Option<(PupilFilmSide, PupilDisk)>,
    ) -> Option<Self> {
        let (first, last) = (w(longest), w(shortest));
        let at = |half: usize| {
            let w = first + (last - first) * half as f64 / (2 * COLUMNS) as f64;
            side(1e3 * w.recip().sqrt())
        };
        let sides: Vec<(PupilFilmSide, PupilDisk)> = (0..=2 * COLUMNS).map(at).collect::<Option<_>>()?;
        let cover = sides[0].1;
        let family = Spectrum(sides.into_iter().map(|(side, _)| FilmRadii::new(side, reach)).collect());
        let map = PupilMap::new(&Grid::new(&family), true);
        Some(Self { first, per_w: COLUMNS as f64 / (last - first), map, cover })
    }

    /// Returns the constants of look-ups, in the precision of the lanes.
    pub fn lane_pupil<S: Scalar>(&self) -> LaneSpectralPupil<S> {
        LaneSpectralPupil {
            first: S::from_f64(self.first),
            per_w: S::from_f64(self.per_w),
            pupil: LanePupil::new(&self.map, self.cover),
        }
    }

    /// Sets the slopes and areas of rays whose wavelengths are given in nm. The area is NaN if there is
    /// nothing to sample.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LaneSpectralPupil<L::Scalar>,
        wavelengths: &[L; U],
        rays: &mut [FilmRays<L>; U],
    ) {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        for (wavelength, ray) in wavelengths.iter().zip(rays) {
            let micrometres = *wavelength * number(1e-3);
            let w = number(1.0) / (micrometres * micrometres);
            let column = (w - L::splat(cpu, constants.first)) * L::splat(cpu, constants.per_w);
            let heading = Heading::of(cpu, ray.point);
            let location = self.map.locate_in_columns(cpu, &constants.pupil.map, heading.radius, column);
            aim(cpu, &self.map, &constants.pupil, &heading, &location, ray);
        }
    }
}
