//! The warped pupil at any wavelength of a range: tables at a few wavelengths in, the map between them out.
//!
//! As the wavelength changes the pupil of a film point moves and grows a little, and with it the image on the film. At a
//! given part of the image's radius it changes almost in proportion to the glasses' indices, which themselves change almost
//! in proportion to w = 1/(λ² - 0.028), λ in µm (M. Herzberger, *Optica Acta* 6, 1959). So the tables of a [`Stack`] lie
//! evenly in w.

use super::{LanePupil, build::Builder, stack::Stack, view::FilmPencils};
use crate::{
    numeric::Real,
    prescription::glass::HERZBERGER,
    sampling::film_rays::FilmRays,
    trace::kernel::{Cpu, Lanes, Scalar},
};

/// The true pupil of every point of a film, at every wavelength of a range. Immutable once built.
#[derive(Clone, Debug)]
pub(crate) struct SpectralPupil {
    /// w of the first table.
    first: f64,
    /// Tables per w.
    per_w: f64,
    tables: Stack,
}

/// Intervals between the tables.
const INTERVALS: usize = 4;
/// The same where the image ends within reach: a crescent is so narrow there that its place in the image has to be known
/// better than its width.
const WITH_END: usize = 16;
/// How much farther out the image is followed where it ends within reach at some wavelengths and not at others.
const FARTHER: [f64; 3] = [1.02, 1.1, 1.5];

/// w of a wavelength, nm.
fn w(wavelength: f64) -> f64 {
    ((wavelength * 1e-3).powi(2) - HERZBERGER).recip()
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
        // Numbered as those of the finest division.
        let wavelength = |number: usize| {
            let w = first + (last - first) * number as f64 / WITH_END as f64;
            1e3 * (w.recip() + HERZBERGER).sqrt()
        };
        let table = |number: usize, reach: f64| {
            let builder = Builder::new(side(wavelength(number), reach)?);
            let layout = builder.layout();
            Some((number, builder, layout))
        };
        let mut tables = Vec::with_capacity(WITH_END + 1);
        for number in (0..=WITH_END).step_by(WITH_END / INTERVALS) {
            tables.push(table(number, reach)?);
        }
        let mut intervals = INTERVALS;
        // An image ends everywhere or nowhere.
        if tables.iter().any(|(.., layout)| layout.scale.dark_beyond) {
            intervals = WITH_END;
            for number in (0..=WITH_END).filter(|number| number % (WITH_END / INTERVALS) != 0) {
                tables.push(table(number, reach)?);
            }
            tables.sort_by_key(|(number, ..)| *number);
            for known in &mut tables {
                let mut farther = FARTHER.iter();
                while !known.2.scale.dark_beyond {
                    *known = table(known.0, reach * farther.next()?)?;
                }
            }
        }
        let beyond = tables[0].1.side.disk();
        let (builders, layouts): (Vec<_>, Vec<_>) =
            tables.into_iter().map(|(_, builder, layout)| (builder, layout)).unzip();
        let tables = Stack::of(&builders, layouts, beyond);
        Some(Self { first, per_w: intervals as f64 / (last - first), tables })
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
        let w = one / micrometres.mul_sub(micrometres, number(HERZBERGER));
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
