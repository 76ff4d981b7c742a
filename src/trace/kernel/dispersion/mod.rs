//! A lens compiled for a wavelength per lane: the kernel's steps with the media of each ray's own wavelength.
//!
//! A step needs n², 1/n² and K = n'² - n² of its two media. The table for the lens's own wavelength λ₀ has constants
//! per n², and n² at λ is n²(λ₀) + Δ(λ), where Δ is the change of the glass's dispersion formula: a small number with
//! a small rounding error, also in single precision.
//!
//! `media` supplies a step with its media; `glass` evaluates Δ in lanes; [`SpectralKernel`] combines the lens's steps
//! with the medium behind each, and is the [`Optics`] that traces rays with wavelengths.

mod glass;
mod media;

use glass::{LaneGlass, LightLanes};
use media::AtWavelengths;
pub use media::{Media, MediaOnWay, Own};

use super::{
    instances::{KernelScalar, Optics},
    lanes::{Cpu, Lanes},
    ray::{End, RayLanes, Start},
    rays::Approach,
    simd::Available,
    table::{Step, Table},
    trace::through,
};
use crate::{
    numeric::Real,
    prescription::Medium,
    trace::path::{Direction, Path},
};

/// A lens from film to scene, compiled for a wavelength per ray in numbers of type `S`.
#[derive(Clone, Debug)]
pub struct SpectralKernel<S> {
    /// Steps with constants per n².
    table: Table<S>,
    /// The medium behind each step that refracts.
    behind: Box<[Option<LaneGlass<S>>]>,
    /// The square of the lens's own wavelength, µm².
    own: S,
    simd: Available,
}

/// Largest factor by which a lens's n² may exceed its value at the own wavelength; an asphere's bounds allow for it.
const MORE: f64 = 1.5;

impl<S: KernelScalar> SpectralKernel<S> {
    /// Compiles a path from the film for its own `wavelength`, nm. `media` are the media on the film's side of its
    /// surfaces, counted from the scene. The film is in air.
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
            // The medium on the scene's side of the first surface is air.
            let medium = (last - at).checked_sub(1).map_or(&Medium::Air, |before| &media[before]);
            LaneGlass::new(medium, wavelength)
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

    /// Returns the instructions that its rays are traced by.
    pub fn available(&self) -> Available {
        self.simd
    }
}

impl<S: KernelScalar> Optics<S> for SpectralKernel<S> {
    type OnWay<L: Lanes<Scalar = S>> = RayLanes<L>;
    type Light<L: Lanes<Scalar = S>> = SpectralLight<L>;
    const SIDE_BY_SIDE: bool = true;

    #[inline(always)]
    fn approach(&self) -> Approach {
        self.table.approach()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        wavelengths: L,
        start: Start<L>,
    ) -> (RayLanes<L>, SpectralLight<L>) {
        let Self { table, behind, own, .. } = self;
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        let mut light = SpectralLight {
            lanes: LightLanes::new(cpu, wavelengths, *own),
            here: Here { square: one, inverse: one, change: zero },
            media: AtWavelengths { square: one, inverse: one, change: zero },
        };
        light.reach(cpu, behind[0].as_ref());
        (RayLanes::enter(cpu, &table.steps[0], light.media, start), light)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn through<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L>; U],
        light: &mut [SpectralLight<L>; U],
        count: usize,
    ) {
        let Self { table, behind, .. } = self;
        let light = if U == 1 { &mut light[..1] } else { &mut light[..count] };
        through(cpu, table, &mut OnWay { behind, light }, rays, count);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn leave<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, rays: RayLanes<L>) -> (End<L>, L) {
        self.table.leave(cpu, rays)
    }
}

/// The light of a vector of rays on their way.
#[derive(Clone, Copy)]
pub struct SpectralLight<L> {
    lanes: LightLanes<L>,
    /// The medium behind the last surface reached, and so before the next one.
    here: Here<L>,
    /// The media at that surface.
    media: AtWavelengths<L>,
}

/// A medium that rays are in.
#[derive(Clone, Copy)]
struct Here<L> {
    /// n² and its reciprocal.
    square: L,
    inverse: L,
    /// Change of n² from the lens's own wavelength.
    change: L,
}

impl<L: Lanes> SpectralLight<L> {
    /// Advances to the next surface; `glass` is the medium behind it, if it refracts.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reach(&mut self, cpu: Cpu<L>, glass: Option<&LaneGlass<L::Scalar>>) {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let Here { square, inverse, change: before } = self.here;
        self.media = AtWavelengths { square, inverse, change: zero };
        let Some(glass) = glass else { return };
        let own = L::splat(cpu, glass.square);
        let change = if glass.is_fixed() { zero } else { glass.change(cpu, &self.lanes) };
        let square = own + change;
        self.media.change = change - before;
        self.here = Here { square, inverse: one / square, change };
    }
}

/// The media along the path of several vectors of rays.
struct OnWay<'a, L: Lanes> {
    behind: &'a [Option<LaneGlass<L::Scalar>>],
    light: &'a mut [SpectralLight<L>],
}

impl<L: Lanes> MediaOnWay<L> for OnWay<'_, L> {
    type Media = AtWavelengths<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn go_to(&mut self, cpu: Cpu<L>, number: usize) {
        let glass = self.behind[number].as_ref();
        for light in &mut *self.light {
            light.reach(cpu, glass);
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn media(&self, vector: usize) -> AtWavelengths<L> {
        self.light[vector].media
    }
}
