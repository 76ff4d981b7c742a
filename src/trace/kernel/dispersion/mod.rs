//! A lens compiled for a wavelength per lane: the kernel's steps with the media of each ray's own wavelength.
//!
//! A step needs of its two media n², 1/n² and K = n'² - n². The table of the lens's own wavelength λ₀ has its numbers per n²,
//! and n² at λ is n²(λ₀) + Δ(λ), Δ being the change of the glass's dispersion formula: a small number with a small rounding
//! error, in single precision, too.
//!
//! `media` is what a step asks of its media; `glass` evaluates Δ in lanes; [`SpectralKernel`] has the lens's steps with the
//! medium behind each, and takes rays through.

mod glass;
mod media;

use glass::{Glass, LightLanes};
use media::AtWavelengths;
pub use media::{Media, MediaOnWay, Own};

use super::{
    instances::KernelScalar,
    lanes::{Cpu, Lanes, each_further},
    ray::{End, Start},
    rays::Approach,
    simd::Available,
    table::{Step, Table},
    trace::trace,
};
use crate::{
    numeric::Real,
    prescription::Medium,
    trace::path::{Direction, Path},
};

/// A lens from film to scene, compiled for a wavelength per ray in numbers of type `S`.
#[derive(Clone, Debug)]
pub struct SpectralKernel<S> {
    /// Its numbers are per n².
    table: Table<S>,
    /// The medium behind each step that refracts.
    behind: Box<[Option<Glass<S>>]>,
    /// The square of the lens's own wavelength, µm².
    own: S,
    simd: Available,
}

/// How much more than at its own wavelength a lens's n² may be: what an asphere's bounds have to allow for.
const MORE: f64 = 1.5;

impl<S: KernelScalar> SpectralKernel<S> {
    /// Compiles a path from the film, whose surfaces, counted from the scene, have these media on the film's side, for its
    /// own `wavelength`, nm. The film is in air.
    pub fn new(path: &Path, media: &[Medium], wavelength: f64) -> Self {
        debug_assert!(path.direction == Direction::FilmToScene);
        let mut table = Table::<S>::per_square(path, S::AMPLIFICATION);
        for step in &mut table.steps {
            if let Step::Asphere(asphere) = step {
                for bend in [&mut asphere.inside, &mut asphere.beyond] {
                    bend.along = bend.along * S::from_f64(MORE);
                }
            }
        }
        let last = media.len() - 1;
        let behind = |at: usize| {
            // On the scene's side of the first surface is air.
            let medium = (last - at).checked_sub(1).map_or(&Medium::Air, |before| &media[before]);
            Glass::new(medium, wavelength)
        };
        Self {
            behind: table
                .steps
                .iter()
                .zip(&table.surfaces)
                .map(|(step, at)| step.refracts().then(|| behind(*at)))
                .collect(),
            table,
            own: S::from_f64((wavelength * 1e-3) * (wavelength * 1e-3)),
            simd: Available::best(),
        }
    }

    /// Where rays start.
    #[inline(always)]
    pub fn approach(&self) -> Approach {
        Approach { entry: self.table.entry, travel_sign: self.table.travel_sign }
    }

    /// The instructions that its rays are traced by.
    pub fn available(&self) -> Available {
        self.simd
    }

    /// Takes `U` vectors of rays through at wavelengths in nm, each with its squared cosine to the axis before.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn through<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        wavelengths: &[L; U],
        starts: [Start<L>; U],
    ) -> [(End<L>, L); U] {
        let mut light = [LightLanes::new(cpu, wavelengths[0], self.own); U];
        each_further!(u < U, {
            light[u] = LightLanes::new(cpu, wavelengths[u], self.own);
        });
        let one = L::splat(cpu, S::ONE);
        let here = [Here { square: one, inverse: one, change: L::splat(cpu, S::ZERO) }; U];
        trace(cpu, &self.table, OnWay { behind: &self.behind, light, here }, starts)
    }
}

/// The medium that rays are in.
#[derive(Clone, Copy)]
struct Here<L> {
    /// n² and its reciprocal.
    square: L,
    inverse: L,
    /// By how much n² is more than at the lens's own wavelength.
    change: L,
}

/// The media that rays pass one after the other.
struct OnWay<'a, L: Lanes, const U: usize> {
    behind: &'a [Option<Glass<L::Scalar>>],
    light: [LightLanes<L>; U],
    here: [Here<L>; U],
}

impl<L: Lanes, const U: usize> MediaOnWay<L, U> for OnWay<'_, L, U> {
    type Media = AtWavelengths<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at(&mut self, cpu: Cpu<L>, number: usize) -> [AtWavelengths<L>; U] {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let mut media = [AtWavelengths { square: zero, inverse: zero, change: zero }; U];
        for (media, Here { square, inverse, .. }) in media.iter_mut().zip(&self.here) {
            *media = AtWavelengths { square: *square, inverse: *inverse, change: zero };
        }
        let Some(glass) = &self.behind[number] else { return media };
        let (own, one) = (L::splat(cpu, glass.square), L::splat(cpu, L::Scalar::ONE));
        if glass.is_fixed() {
            let inverse = one / own;
            for (media, here) in media.iter_mut().zip(&mut self.here) {
                media.change = zero - here.change;
                *here = Here { square: own, inverse, change: zero };
            }
            return media;
        }
        for ((media, here), light) in media.iter_mut().zip(&mut self.here).zip(&self.light) {
            let change = glass.change(cpu, light);
            let square = own + change;
            media.change = change - here.change;
            *here = Here { square, inverse: one / square, change };
        }
        media
    }
}
