//! Transmission as a part of the trace: rays of either precision carry their light from step to step of the kernel, in
//! lanes of single precision.
//!
//! A step gives the normal of the surface and n cos I on both sides of the surface. The effect of the surface on the
//! light follows from these ([`LaneSurface`]). The state of polarisation is carried along ([`LaneLight`]). Between
//! surfaces, the glass absorbs light. For every ray, the relative error is at most 1e-4, compared to the exact product
//! over the surfaces ([`LitPath::trace`](super::LitPath::trace) without tables).

use super::{
    absorption::{Absorbers, AbsorptionCurves},
    boundary::Boundary,
    lane_light::LaneLight,
    lane_surface::LaneSurface,
};
use realistic_optics::{
    lens::{Lens, Surface},
    prescription::{AirSide, Layer, SurfaceCoating},
    trace::Direction,
};
use realistic_simd::{Cpu, Lanes, Scalar};
use realistic_trace::kernel::{Carried, Crossing, KernelScalar, LensSteps, Own, Step, Table};

/// The light that rays carry through a lens, in addition to the data that they carry in any case (`C`).
#[derive(Clone, Debug)]
pub struct Transmission<C> {
    carried: C,
    steps: Box<[LitStep]>,
    /// The distinct surfaces.
    surfaces: Box<[LaneSurface]>,
    /// The lens's own wavelength, nm.
    wavelength: f32,
    /// Absorption as a function of the wavelength, used if each ray has its own wavelength.
    curves: AbsorptionCurves,
    /// Whether any glass absorbs.
    absorbs: bool,
}

/// The optical properties of a step of the kernel.
#[derive(Clone, Copy, Debug)]
struct LitStep {
    /// Index of the surface; `None` if the medium does not change.
    surface: Option<usize>,
    /// n before and behind the surface, at the lens's own wavelength, relative to n before the first surface.
    indices: [f32; 2],
    before: Absorption,
}

/// Absorption by the medium before a surface.
#[derive(Clone, Copy, Debug)]
enum Absorption {
    None,
    /// Relative refractive index times absorption coefficient, n α, 1/mm, at the lens's own wavelength.
    Fixed(f32),
    /// Index of the absorption curve of the glass.
    Curve(usize),
}

/// Relative error that the polynomials of all coated surfaces may have in sum. The documented error is 1e-4, which
/// leaves room for rounding in single precision.
const GOAL: f64 = 5e-5;

impl Transmission<Own> {
    /// Adds light to the steps of a lens that is traced in `direction` at the lens's own wavelength. `coatings` are
    /// listed from the scene on.
    pub fn steps<S: KernelScalar>(
        steps: &LensSteps<S, Own>,
        lens: &Lens,
        direction: Direction,
        coatings: &[SurfaceCoating],
    ) -> LensSteps<S, Self> {
        let is_coated = |(surface, coating): (&Surface, &SurfaceCoating)| {
            !coating.layers([surface.n_scene, surface.n_film]).is_empty()
        };
        let coated = lens.surfaces.iter().zip(coatings).filter(|own| is_coated(*own)).count() as f64;
        let first_index = first_index(lens, direction);
        let mut known: Vec<([f64; 2], Vec<Layer>)> = Vec::new();
        let mut surfaces = Vec::new();
        let index_of = |surface: usize, media: [f64; 2]| {
            if media[0] == media[1] {
                return None;
            }
            let own = (media, coatings[surface].layers(media));
            let index = known.iter().position(|other| *other == own);
            Some(index.unwrap_or_else(|| {
                let boundary = Boundary::untabulated(own.0, &own.1, lens.wavelength);
                let fit = || LaneSurface::fitted(&boundary, own.0[0], GOAL / coated, first_index);
                let fitted = if own.1.is_empty() { None } else { fit() };
                surfaces.push(fitted.unwrap_or_else(|| stack(&coatings[surface], own.0, first_index)));
                known.push(own);
                known.len() - 1
            }))
        };
        let absorption = |medium: Option<usize>| {
            let own = medium.map_or(0.0, |medium| lens.surfaces[medium].absorption);
            let index = medium.map_or(1.0, |medium| lens.surfaces[medium].n_film / first_index);
            if own > 0.0 { Absorption::Fixed((own * index) as f32) } else { Absorption::None }
        };
        let lit = lit_steps(&steps.table, lens, direction, index_of, absorption);
        let curves = AbsorptionCurves::new(&Absorbers::default(), [0.0; 2]);
        Self::added(steps.clone(), lit, surfaces, lens.wavelength, curves)
    }
}

impl<C> Transmission<C> {
    /// Adds light to the steps of a lens that is traced from the film, for rays that each have their own wavelength,
    /// nm, within `range`.
    pub fn steps_at_wavelengths<S: KernelScalar>(
        steps: LensSteps<S, C>,
        lens: &Lens,
        coatings: &[SurfaceCoating],
        absorbers: &Absorbers,
        range: [f64; 2],
    ) -> LensSteps<S, Self> {
        let mut surfaces = Vec::new();
        // Media with the same index at the lens's own wavelength may have different indices at other wavelengths.
        let index_of = |surface: usize, media| {
            surfaces.push(stack(&coatings[surface], media, 1.0));
            Some(surfaces.len() - 1)
        };
        let absorption = |medium: Option<usize>| {
            medium.and_then(|medium| absorbers.behind(medium)).map_or(Absorption::None, Absorption::Curve)
        };
        let lit = lit_steps(&steps.table, lens, Direction::FilmToScene, index_of, absorption);
        let curves = AbsorptionCurves::new(absorbers, range);
        Self::added(steps, lit, surfaces, lens.wavelength, curves)
    }

    /// Adds the light's steps `lit` to the steps of a lens; `wavelength` is the lens's own, nm.
    fn added<S>(
        steps: LensSteps<S, C>,
        lit: Box<[LitStep]>,
        surfaces: Vec<LaneSurface>,
        wavelength: f64,
        curves: AbsorptionCurves,
    ) -> LensSteps<S, Self> {
        let LensSteps { table, carried } = steps;
        let absorbs = lit.iter().any(|step| !matches!(step.before, Absorption::None));
        let (surfaces, wavelength) = (surfaces.into(), wavelength as f32);
        LensSteps { table, carried: Self { carried, steps: lit, surfaces, wavelength, curves, absorbs } }
    }
}

/// Returns the optical properties of the steps of a lens. `index_of` returns the index, among the distinct surfaces, of
/// a surface that is given by its number from the scene and its media in the order of the light. `absorption` returns
/// the absorption of the medium behind a surface.
fn lit_steps<S: Scalar>(
    table: &Table<S>,
    lens: &Lens,
    direction: Direction,
    mut index_of: impl FnMut(usize, [f64; 2]) -> Option<usize>,
    absorption: impl Fn(Option<usize>) -> Absorption,
) -> Box<[LitStep]> {
    let last = lens.surfaces.len() - 1;
    let first_index = first_index(lens, direction);
    let mut is_first = true;
    let step = |(step, along): (&Step<S>, &usize)| {
        let surface = if direction == Direction::FilmToScene { last - along } else { *along };
        let own = &lens.surfaces[surface];
        let (media, medium) = match direction {
            Direction::FilmToScene => ([own.n_film, own.n_scene], Some(surface)),
            Direction::SceneToFilm => ([own.n_scene, own.n_film], surface.checked_sub(1)),
        };
        let is_crossed = step.refracts();
        // Before the first surface, the light is not in the lens.
        let medium = if is_crossed && std::mem::take(&mut is_first) { None } else { medium };
        LitStep {
            surface: if is_crossed { index_of(surface, media) } else { None },
            indices: media.map(|index| (index / first_index) as f32),
            before: if is_crossed { absorption(medium) } else { Absorption::None },
        }
    };
    table.steps.iter().zip(&table.surfaces).map(step).collect()
}

/// Returns the index of the medium before the first surface, to which the kernel's indices are relative.
fn first_index(lens: &Lens, direction: Direction) -> f64 {
    let [n_scene, n_film] = lens.outer_indices();
    match direction {
        Direction::FilmToScene => n_film,
        Direction::SceneToFilm => n_scene,
    }
}

/// Returns a surface with its layers, between `media`, which are in the order of the light, for rays whose indices are
/// relative to `unit`. The optical thickness of a layer stays the same.
fn stack(coating: &SurfaceCoating, media: [f64; 2], unit: f64) -> LaneSurface {
    let side = AirSide::of(media);
    let mut layers = side.map_or_else(Vec::new, |_| coating.from_air());
    for layer in &mut layers {
        *layer = Layer { index: layer.index / unit, thickness: layer.thickness * unit };
    }
    LaneSurface::stack(&layers, side == Some(AirSide::First))
}

/// The data of a vector of rays with their light.
#[derive(Clone, Copy, Debug)]
pub struct LitState<L: Lanes, T> {
    carried: T,
    light: LaneLight<L::Single>,
}

impl<S: KernelScalar, C: Carried<S>> Carried<S> for Transmission<C> {
    type State<L: Lanes<Scalar = S>> = LitState<L, C::State<L>>;
    type Media<L: Lanes<Scalar = S>> = C::Media<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, wavelengths: L) -> Self::State<L> {
        LitState {
            carried: self.carried.start(cpu, wavelengths),
            light: LaneLight::unpolarised(L::single_cpu(cpu)),
        }
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
        let LitStep { surface, indices: [n, n_behind], before } = steps[number];
        let (single, crossing) = (L::single_cpu(cpu), crossing.single(cpu));
        let number = |number: f32| L::Single::splat(single, number);
        let LitState { carried: state, light } = state;
        let (indices, wavelength) = match carried.light(state) {
            Some(([square, square_behind], wavelengths)) => {
                ([square.single().sqrt(), square_behind.single().sqrt()], wavelengths.single())
            }
            None => ([number(n), number(n_behind)], number(*wavelength)),
        };
        match before {
            Absorption::None => {}
            Absorption::Fixed(coefficient) => light.absorb(crossing.distance, number(coefficient)),
            Absorption::Curve(glass) => {
                let coefficient = curves.coefficient(single, glass, wavelength);
                light.absorb(crossing.distance, coefficient * indices[0]);
            }
        }
        if let Some(surface) = surface {
            // Layers have absolute indices.
            let share = match carried.first_index(cpu, state) {
                None => surfaces[surface].share(single, crossing.facing, indices, wavelength),
                Some(unit) => {
                    let unit = unit.single();
                    let [facing, indices] = [crossing.facing, indices].map(|both| both.map(|own| own * unit));
                    surfaces[surface].share(single, facing, indices, wavelength)
                }
            };
            light.cross(single, &crossing, indices[0], share);
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter_frame<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        state: &mut Self::State<L>,
        rotation: &[[S; 3]; 3],
    ) {
        let mut single = [[0.0_f32; 3]; 3];
        for (own, number) in single.as_flattened_mut().iter_mut().zip(rotation.as_flattened()) {
            *own = number.to_f64() as f32;
        }
        state.light.enter_frame(L::single_cpu(cpu), &single);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn turn_round<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &mut Self::State<L>) {
        state.light.turn_round(L::single_cpu(cpu));
    }

    #[inline(always)]
    fn light<L: Lanes<Scalar = S>>(&self, state: &Self::State<L>) -> Option<([L; 2], L)> {
        self.carried.light(&state.carried)
    }

    #[inline(always)]
    fn first_index<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &Self::State<L>) -> Option<L> {
        self.carried.first_index(cpu, &state.carried)
    }

    #[inline(always)]
    fn per_last_index<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &Self::State<L>) -> Option<L> {
        self.carried.per_last_index(cpu, &state.carried)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn left<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, state: &Self::State<L>) -> L {
        let power = state.light.power();
        let single = L::single_cpu(cpu);
        let left = L::widened(if self.absorbs { power * state.light.unabsorbed(single) } else { power });
        left * self.carried.left(cpu, &state.carried)
    }
}
