//! Transmission as a part of the trace: rays carry their light from step to step of the kernel, in lanes of either
//! precision.
//!
//! A step gives the normal of the surface and n cos I on both sides of it; the surface's effect on the light follows
//! from these ([`LaneSurface`]), and the state of polarisation is carried along ([`LaneLight`]). Between surfaces glass
//! absorbs. The result is within 1e-4, relative, of the exact product over the surfaces
//! ([`LitPath::trace_exactly`](super::LitPath::trace_exactly)) for every ray.

use super::{
    absorption::{Absorbers, AbsorptionCurves},
    boundary::Boundary,
    coating::AirSide,
    lane_light::LaneLight,
    lane_surface::LaneSurface,
};
use crate::{
    lens::Lens,
    prescription::{Layer, SurfaceCoating},
    trace::{
        Direction,
        kernel::{Carried, Cpu, Crossing, KernelScalar, Lanes, LensSteps, Own, Scalar, Table},
    },
};

/// The light that rays carry through a lens, beside what they carry in any case (`C`).
#[derive(Clone, Debug)]
pub struct Transmission<S, C> {
    carried: C,
    steps: Box<[LitStep<S>]>,
    /// The distinct surfaces.
    surfaces: Box<[LaneSurface<S>]>,
    /// The lens's own wavelength, nm.
    wavelength: S,
    /// Absorption by wavelength, if rays have wavelengths of their own.
    curves: AbsorptionCurves<S>,
    /// Whether any glass absorbs.
    absorbs: bool,
}

/// A step of the kernel, as light meets it.
#[derive(Clone, Copy, Debug)]
struct LitStep<S> {
    /// Index of the surface; `None` if the medium does not change.
    surface: Option<usize>,
    /// n before and behind the surface, at the lens's own wavelength.
    indices: [S; 2],
    before: Absorption<S>,
}

/// Absorption by the medium before a surface.
#[derive(Clone, Copy, Debug)]
enum Absorption<S> {
    None,
    /// n α, 1/mm, at the lens's own wavelength.
    Fixed(S),
    /// Index of the glass's curve.
    Curve(usize),
}

/// Relative error that the polynomials of all surfaces together may have. The documented error is 1e-4, which leaves
/// room for rounding in single precision.
const GOAL: f64 = 5e-5;

impl<S: KernelScalar> LensSteps<S, Transmission<S, Own>> {
    /// Adds light to the steps of a lens with these coatings, from the scene on, traced in a direction at the lens's
    /// own wavelength.
    pub fn lit(
        steps: &LensSteps<S, Own>,
        lens: &Lens,
        direction: Direction,
        coatings: &[SurfaceCoating],
    ) -> Self {
        let count = lens.surfaces.len() as f64;
        let mut known: Vec<([f64; 2], Vec<Layer>)> = Vec::new();
        let mut surfaces = Vec::new();
        let number = |surface: usize, media: [f64; 2]| {
            if media[0] == media[1] {
                return None;
            }
            let own = (media, coatings[surface].layers(media));
            let place = known.iter().position(|other| *other == own);
            Some(place.unwrap_or_else(|| {
                let boundary = Boundary::untabulated(own.0, &own.1, lens.wavelength);
                let fitted = if own.1.is_empty() {
                    None
                } else {
                    LaneSurface::fitted(&boundary, own.0[0], GOAL / count)
                };
                surfaces.push(fitted.unwrap_or_else(|| stack(&coatings[surface], own.0)));
                known.push(own);
                known.len() - 1
            }))
        };
        let absorption = |medium: Option<usize>| {
            let own = medium.map_or(0.0, |medium| lens.surfaces[medium].absorption);
            let index = medium.map_or(1.0, |medium| lens.surfaces[medium].n_film);
            if own > 0.0 { Absorption::Fixed(S::from_f64(own * index)) } else { Absorption::None }
        };
        let lit = lit_steps(&steps.table, lens, direction, number, absorption);
        let carried = Transmission {
            carried: Own,
            absorbs: lit.iter().any(|step| !matches!(step.before, Absorption::None)),
            steps: lit,
            surfaces: surfaces.into(),
            wavelength: S::from_f64(lens.wavelength),
            curves: AbsorptionCurves::new(&Absorbers::default(), [0.0; 2]),
        };
        Self { table: steps.table.clone(), carried }
    }
}

impl<S: KernelScalar, C: Carried<S>> LensSteps<S, Transmission<S, C>> {
    /// Adds light to the steps of a lens from the film whose rays have wavelengths of their own, nm, within `range`.
    pub fn lit_at_wavelengths(
        steps: LensSteps<S, C>,
        lens: &Lens,
        coatings: &[SurfaceCoating],
        absorbers: &Absorbers,
        range: [f64; 2],
    ) -> Self {
        let mut surfaces = Vec::new();
        // Media with one index at the lens's own wavelength may differ at others.
        let number = |surface: usize, media| {
            surfaces.push(stack(&coatings[surface], media));
            Some(surfaces.len() - 1)
        };
        let absorption = |medium: Option<usize>| {
            medium.and_then(|medium| absorbers.behind(medium)).map_or(Absorption::None, Absorption::Curve)
        };
        let lit = lit_steps(&steps.table, lens, Direction::FilmToScene, number, absorption);
        let carried = Transmission {
            carried: steps.carried,
            absorbs: lit.iter().any(|step| !matches!(step.before, Absorption::None)),
            steps: lit,
            surfaces: surfaces.into(),
            wavelength: S::from_f64(lens.wavelength),
            curves: AbsorptionCurves::new(absorbers, range),
        };
        Self { table: steps.table, carried }
    }
}

/// Returns the steps of a lens for light. `number` gives a surface, counted from the scene and between these media in
/// the order of the light, its index; `absorption` is that of the medium behind a surface.
fn lit_steps<S: Scalar>(
    table: &Table<S>,
    lens: &Lens,
    direction: Direction,
    mut number: impl FnMut(usize, [f64; 2]) -> Option<usize>,
    absorption: impl Fn(Option<usize>) -> Absorption<S>,
) -> Box<[LitStep<S>]> {
    let last = lens.surfaces.len() - 1;
    let mut is_first = true;
    let step = |(step, along): (&crate::trace::kernel::Step<S>, &usize)| {
        let surface = if direction == Direction::FilmToScene { last - along } else { *along };
        let own = &lens.surfaces[surface];
        let (media, medium) = match direction {
            Direction::FilmToScene => ([own.n_film, own.n_scene], Some(surface)),
            Direction::SceneToFilm => ([own.n_scene, own.n_film], surface.checked_sub(1)),
        };
        // Light before the first surface is not in the lens.
        let medium = if std::mem::take(&mut is_first) { None } else { medium };
        let is_crossed = step.refracts();
        LitStep {
            surface: if is_crossed { number(surface, media) } else { None },
            indices: media.map(S::from_f64),
            before: if is_crossed { absorption(medium) } else { Absorption::None },
        }
    };
    table.steps.iter().zip(&table.surfaces).map(step).collect()
}

/// Returns a surface between these media, in the order of the light, with its layers.
fn stack<S: Scalar>(coating: &SurfaceCoating, media: [f64; 2]) -> LaneSurface<S> {
    let side = AirSide::of(media);
    let layers = side.map_or_else(Vec::new, |_| coating.from_air());
    LaneSurface::stack(&layers, side == Some(AirSide::First))
}

/// The data of a vector of rays with their light.
#[derive(Clone, Copy, Debug)]
pub struct LitState<L, T> {
    carried: T,
    light: LaneLight<L>,
}

impl<S: KernelScalar, C: Carried<S>> Carried<S> for Transmission<S, C> {
    type State<L: Lanes<Scalar = S>> = LitState<L, C::State<L>>;
    type Media<L: Lanes<Scalar = S>> = C::Media<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, wavelengths: L) -> Self::State<L> {
        LitState { carried: self.carried.start(cpu, wavelengths), light: LaneLight::unpolarised(cpu) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn go_to<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, number: usize, state: &mut Self::State<L>) {
        self.carried.go_to(cpu, number, &mut state.carried);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn media<L: Lanes<Scalar = S>>(&self, state: &Self::State<L>) -> C::Media<L> {
        self.carried.media(&state.carried)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cross<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        number: usize,
        state: &mut Self::State<L>,
        crossing: &Crossing<L>,
    ) {
        let Self { carried, steps, surfaces, wavelength, curves, .. } = self;
        let LitState { carried: state, light } = state;
        let LitStep { surface, indices: [n, n_behind], before } = steps[number];
        let (indices, wavelength) = match carried.light(state) {
            Some(([square, square_behind], wavelengths)) => {
                ([square.sqrt(), square_behind.sqrt()], wavelengths)
            }
            None => ([L::splat(cpu, n), L::splat(cpu, n_behind)], L::splat(cpu, *wavelength)),
        };
        match before {
            Absorption::None => {}
            Absorption::Fixed(coefficient) => light.absorb(crossing.way, L::splat(cpu, coefficient)),
            Absorption::Curve(glass) => {
                let coefficient = curves.coefficient(cpu, glass, wavelength);
                light.absorb(crossing.way, coefficient * indices[0]);
            }
        }
        if let Some(surface) = surface {
            let crossing = crossing.with_unit_normal(cpu);
            let share = surfaces[surface].share(cpu, crossing.facing, indices, wavelength);
            light.cross(cpu, &crossing, indices[0], share);
        }
    }

    #[inline(always)]
    fn light<L: Lanes<Scalar = S>>(&self, state: &Self::State<L>) -> Option<([L; 2], L)> {
        self.carried.light(&state.carried)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn left<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &Self::State<L>) -> L {
        let power = state.light.power();
        if self.absorbs { power * state.light.unabsorbed(cpu) } else { power }
    }
}
