//! A lens compiled for one wavelength per lane: the kernel's steps, with the media at each ray's own wavelength.
//!
//! A step needs n², 1/n² and K = n'² - n² of its two media. The table for the lens's own wavelength λ₀ has constants
//! per n², and n² at λ is n²(λ₀) + Δ(λ), where Δ is the change by the glass's dispersion formula. It is a small number
//! with a small rounding error, also in single precision.
//!
//! If the film is not in air, indices are relative to its medium: with N for n² of that medium at λ₀ and r for the ratio
//! of n² to N at λ₀, the relative n² at λ is r + (Δ - r Δ_film)/(N + Δ_film).
//!
//! `media` supplies a step with its media, and `glass` evaluates Δ in lanes. [`Dispersed`] contains the medium behind
//! each step, and determines the data that rays with wavelengths carry.

mod glass;
mod media;

use glass::{LaneGlass, LightLanes};
use media::AtWavelengths;
pub use media::{Media, Own};

use super::{
    carried::Carried,
    instances::{KernelScalar, LensSteps},
    table::{Step, Table},
};
use realistic_base::numeric::Real;
use realistic_optics::{
    prescription::Medium,
    trace::{Direction, Path},
};
use realistic_simd::{Compiled, Cpu, Lanes, Scalar};

/// The media of a lens from film to scene, for one wavelength per ray, in numbers of type `S`.
#[derive(Clone, Debug)]
pub struct Dispersed<S> {
    /// The medium behind each step that refracts; n² at the lens's own wavelength is relative to that of the film's
    /// medium.
    behind: Box<[Option<LaneGlass<S>>]>,
    /// The medium of the film; `None` for air.
    film: Option<LaneGlass<S>>,
    /// The relative n² of the scene's medium at the lens's own wavelength, if this ratio depends on the wavelength.
    last_square: Option<S>,
    /// The square of the lens's own wavelength, µm².
    own: S,
}

/// Largest factor by which n² of a medium may exceed its value at the lens's own wavelength; the bounds of an asphere
/// allow for it.
const MORE: f64 = 1.5;

impl<S: KernelScalar> LensSteps<S, Dispersed<S>> {
    /// Compiles a path from the film for the lens's own `wavelength`, nm. `media` lists the media from the scene's to the
    /// film's, one more than surfaces.
    pub fn dispersed(path: &Path, media: &[Medium], wavelength: f64) -> Self {
        debug_assert!(path.direction() == Direction::FilmToScene);
        let mut table = Table::<S>::per_square(path, S::AMPLIFICATION);
        for step in &mut table.steps {
            if let Step::Asphere(asphere) = step {
                for bend in [&mut asphere.inside, &mut asphere.beyond] {
                    bend.along = bend.along * S::from_f64(MORE);
                }
            }
        }
        let last = media.len() - 1;
        let own_glass = |medium: &Medium| LaneGlass::new(medium, wavelength);
        let film = (media[last] != Medium::Air).then(|| own_glass(&media[last]));
        let relative = |medium: &Medium| match &film {
            Some(film) => own_glass(medium).relative_to(film),
            None => own_glass(medium),
        };
        let behind = |at: usize| relative(&media[last - 1 - at]);
        let varies = [&media[0], &media[last]].iter().any(|medium| medium.is_dispersive());
        let last_square = varies.then(|| relative(&media[0]).square);
        let steps = table.steps.iter().zip(&table.surfaces);
        let behind = steps.map(|(step, at)| step.refracts().then(|| behind(*at))).collect();
        let own = S::from_f64((wavelength * 1e-3) * (wavelength * 1e-3));
        Self { table, carried: Dispersed { behind, film, last_square, own } }
    }
}

/// The wavelengths of a vector of rays, and the media at the current surface.
#[derive(Clone, Copy)]
pub struct DispersedState<L> {
    wavelengths: L,
    lanes: LightLanes<L>,
    /// The medium behind the last surface reached, which is also before the next surface.
    here: MediumLanes<L>,
    /// The media at the last surface reached.
    media: AtWavelengths<L>,
}

/// The medium that rays are in.
#[derive(Clone, Copy)]
struct MediumLanes<L> {
    /// n² and its reciprocal.
    square: L,
    inverse: L,
    /// Change of n² from the lens's own wavelength.
    change: L,
}

/// Returns [`LaneGlass::change`], computed in a function of its own, because few films are in a medium that disperses.
#[cfg_attr(not(debug_assertions), inline(always))]
fn change_apart<L: Lanes>(cpu: Cpu<L>, glass: &LaneGlass<L::Scalar>, light: &LightLanes<L>) -> L {
    let mut change = L::splat(cpu, L::Scalar::ZERO);
    if !glass.is_fixed() {
        L::apart(cpu, GlassChange { cpu, glass, light, change: &mut change });
    }
    change
}

/// The arguments of [`change_apart`] and the place of its result.
struct GlassChange<'a, L: Lanes> {
    cpu: Cpu<L>,
    glass: &'a LaneGlass<L::Scalar>,
    light: &'a LightLanes<L>,
    change: &'a mut L,
}

impl<L: Lanes> Compiled for GlassChange<'_, L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        *self.change = self.glass.change(self.cpu, self.light);
    }
}

impl<L: Lanes> DispersedState<L> {
    /// Advances to the next surface; `glass` is the medium behind it, if it refracts, and `film` that of the film, if
    /// not air.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reach(
        &mut self,
        cpu: Cpu<L>,
        glass: Option<&LaneGlass<L::Scalar>>,
        film: Option<&LaneGlass<L::Scalar>>,
    ) {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let MediumLanes { square, inverse, change: before } = self.here;
        self.media = AtWavelengths { square, inverse, change: zero };
        let Some(glass) = glass else { return };
        let own = L::splat(cpu, glass.square);
        let mut change = if glass.is_fixed() { zero } else { glass.change(cpu, &self.lanes) };
        if let Some(film) = film {
            let of_film = change_apart(cpu, film, &self.lanes);
            change = own.neg_mul_add(of_film, change) / (L::splat(cpu, film.square) + of_film);
        }
        let square = own + change;
        self.media.change = change - before;
        self.here = MediumLanes { square, inverse: one / square, change };
    }
}

impl<S: Scalar> Carried<S> for Dispersed<S> {
    type State<L: Lanes<Scalar = S>> = DispersedState<L>;
    type Media<L: Lanes<Scalar = S>> = AtWavelengths<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, wavelengths: L) -> DispersedState<L> {
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        DispersedState {
            wavelengths,
            lanes: LightLanes::new(cpu, wavelengths, self.own),
            here: MediumLanes { square: one, inverse: one, change: zero },
            media: AtWavelengths { square: one, inverse: one, change: zero },
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn go_to<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, number: usize, state: &mut DispersedState<L>) {
        state.reach(cpu, self.behind[number].as_ref(), self.film.as_ref());
    }

    #[inline(always)]
    fn media<L: Lanes<Scalar = S>>(&self, state: &DispersedState<L>) -> AtWavelengths<L> {
        state.media
    }

    #[inline(always)]
    fn light<L: Lanes<Scalar = S>>(&self, state: &DispersedState<L>) -> Option<([L; 2], L)> {
        Some(([state.media.square, state.here.square], state.wavelengths))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn first_index<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &DispersedState<L>) -> Option<L> {
        let film = self.film.as_ref()?;
        Some((L::splat(cpu, film.square) + change_apart(cpu, film, &state.lanes)).sqrt())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn per_last_index<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &DispersedState<L>) -> Option<L> {
        let own = self.last_square?;
        Some((L::splat(cpu, own) * state.here.inverse).sqrt())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn left<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &DispersedState<L>) -> L {
        match self.last_square {
            Some(own) => L::splat(cpu, own) * state.here.inverse,
            None => L::splat(cpu, S::ONE),
        }
    }
}
