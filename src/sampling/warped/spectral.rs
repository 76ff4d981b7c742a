//! The pupil at every wavelength of a range.
//!
//! As the wavelength changes the pupil of a film point moves and grows a little, and with it the image on the film. At a
//! given part of the image's radius it changes almost in proportion to the glasses' indices, which themselves change almost
//! in proportion to 1/λ² (A.-L. Cauchy; λ is the wavelength). So a [`SpectralPupil`]'s tables lie evenly in that.

use super::{
    LanePupil, Stack,
    build::{Builder, Course, alike},
    pencil::FilmPencils,
};
use crate::{
    numeric::Real,
    sampling::film_rays::FilmRays,
    trace::kernel::{Cpu, Lanes, Scalar},
};

/// Intervals between the tables: more take longer at the first wavelength that is asked for, fewer block more.
const INTERVALS: usize = 4;
/// By how much maps are larger than what was found: more is blocked, less leaves out light between two wavelengths.
const MARGIN: f64 = 6e-4;
/// How much farther out the image is followed where it ends within reach at some wavelengths and not at others.
const FARTHER: [f64; 3] = [1.02, 1.1, 1.5];
/// How much farther out an image's end is taken to be than the cubic between the tables has it, relative: for what that is off.
const END_MARGIN: f64 = 2e-5;

/// The true pupil of every point of a film, at every wavelength of a range. Immutable once built.
#[derive(Clone, Debug)]
pub(crate) struct SpectralPupil {
    /// w of the first table.
    first: f64,
    /// Tables per w.
    per_w: f64,
    tables: Stack,
}

/// 1/λ² of a wavelength in nm, 1/μm².
fn w(wavelength: f64) -> f64 {
    (wavelength * 1e-3).powi(-2)
}

impl SpectralPupil {
    /// For wavelengths from `shortest` to `longest`, nm, and film points up to `reach` mm from the axis: `side` is the film's side
    /// of the lens at a wavelength, as far out as a reach. `None` where the images at these wavelengths are not alike.
    pub fn new(
        [shortest, longest]: [f64; 2],
        reach: f64,
        side: impl Fn(f64, f64) -> Option<FilmPencils>,
    ) -> Option<Self> {
        let (first, last) = (w(longest), w(shortest));
        let wavelength = |number: usize| {
            let w = first + (last - first) * number as f64 / INTERVALS as f64;
            1e3 * w.recip().sqrt()
        };
        let at: Vec<f64> = (0..=INTERVALS).map(|number| number as f64).collect();
        let builder = |number: usize, reach: f64| Some(Builder::new(side(wavelength(number), reach)?));
        let mut builders =
            (0..=INTERVALS).map(|number| builder(number, reach)).collect::<Option<Vec<_>>>()?;
        // An image ends everywhere or nowhere.
        if builders.iter().any(Builder::ends) {
            for (number, known) in builders.iter_mut().enumerate() {
                let mut farther = FARTHER.iter();
                while !known.ends() {
                    *known = builder(number, reach * farther.next()?)?;
                }
            }
        }
        let beyond = builders[0].side.disk();
        let mut layouts = alike(&builders, &at, Course::Curved);
        if layouts.tables.len() < builders.len() {
            return None;
        }
        for layout in &mut layouts.tables {
            layout.scale.end *= 1.0 + END_MARGIN;
        }
        let tables = Stack::of(&builders, layouts, MARGIN, beyond);
        Some(Self { first, per_w: INTERVALS as f64 / (last - first), tables })
    }

    /// What sampling computes with, in the precision of the lanes.
    pub fn lane_pupil<S: Scalar>(&self) -> LaneSpectralPupil<S> {
        LaneSpectralPupil {
            first: S::from_f64(self.first),
            per_w: S::from_f64(self.per_w),
            pupil: self.tables.lane_pupil(),
        }
    }

    /// Gives rays of wavelengths in nm their slopes and area. Where there is nothing to sample the area is NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        constants: &LaneSpectralPupil<L::Scalar>,
        wavelengths: &[L; U],
        rays: &mut [FilmRays<L>; U],
    ) {
        for u in 0..U {
            self.aim(cpu, constants, wavelengths[u], &mut rays[u]);
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn aim<L: Lanes>(
        &self,
        cpu: Cpu<L>,
        constants: &LaneSpectralPupil<L::Scalar>,
        wavelength: L,
        ray: &mut FilmRays<L>,
    ) {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let one = L::splat(cpu, L::Scalar::ONE);
        let micrometres = wavelength * number(1e-3);
        let w = one / (micrometres * micrometres);
        let place = (w - L::splat(cpu, constants.first)) * L::splat(cpu, constants.per_w);
        self.tables.aim(cpu, &constants.pupil, place, ray);
    }
}

/// What sampling computes with, in its precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneSpectralPupil<S> {
    first: S,
    per_w: S,
    pupil: LanePupil<S>,
}
