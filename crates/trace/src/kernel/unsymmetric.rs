//! Surfaces that are not symmetric about their axis, and changes of frame, in lanes. Geometry, notation and the proof of
//! the first crossing are those of [`UnsymmetricSheet`]: a cylinder is intersected in closed form, another surface by
//! steps that cannot skip a crossing. A lane that has arrived, or is blocked, stays; the steps end when all lanes do.

use std::ops::{Add, Div, Mul, Sub};

use super::{
    apertures::Apertures,
    asphere::Common,
    carried::Carried,
    dispersion::Media,
    ray_lanes::{Crossing, RayLanes},
    surface::{CompiledSurface, Transfer},
};
use realistic_base::numeric::{Arithmetic, Gradient, Real};
use realistic_optics::{
    prescription::UnsymmetricConstants,
    trace::{CylinderSheet, FrameChange, SheetBounds, UnsymmetricSheet},
};
use realistic_simd::{Compiled, Cpu, Lanes, Scalar};

/// A change to the frame of the next surface, which does not share the axis of the last one.
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    /// Transfer to the vertex at which the frame changes.
    pub transfer: Transfer<S>,
    pub rotation: [[S; 3]; 3],
    pub offset: [S; 3],
}

impl<S: Scalar> Frame<S> {
    pub fn new(change: &FrameChange<f64>, transfer: Transfer<S>) -> Self {
        Self {
            transfer,
            rotation: change.rotation.map(|row| row.map(S::from_f64)),
            offset: change.offset.map(S::from_f64),
        }
    }
}

/// A cylinder whose section is a conic.
#[derive(Clone, Copy, Debug)]
pub struct LaneCylinder<S> {
    pub transfer: Transfer<S>,
    pub is_in_x: bool,
    pub c: S,
    /// 1 + k.
    pub kappa: S,
    pub common: Common<S>,
}

/// A toroid or a biconic.
#[derive(Clone, Debug)]
pub struct LaneSheet<S> {
    pub transfer: Transfer<S>,
    pub constants: UnsymmetricConstants<S>,
    /// Factors of Vx² + Vy² in the bound of φ'', within the clear aperture and up to the reach.
    pub inside: S,
    pub beyond: S,
    /// The squares of the clear semi-diameter and of the reach.
    pub rim: S,
    pub reach: S,
    /// The greatest z up to the reach.
    pub highest: S,
    pub tolerance: S,
    pub common: Common<S>,
}

/// A step that only lenses need which are not round.
#[derive(Clone, Debug)]
pub enum GeneralStep<S> {
    /// A change to the frame of the next surface.
    Frame(Frame<S>),
    /// A cylinder whose section is a conic.
    Cylinder(LaneCylinder<S>),
    /// A toroid or a biconic.
    Sheet(LaneSheet<S>),
}

impl<S: Scalar> LaneCylinder<S> {
    pub fn new(
        sheet: &UnsymmetricSheet<f64>,
        cylinder: &CylinderSheet<f64>,
        surface: &CompiledSurface<'_>,
        transfer: Transfer<S>,
    ) -> Self {
        Self {
            transfer,
            is_in_x: cylinder.is_in_x,
            c: S::from_f64(cylinder.curvature),
            kappa: S::from_f64(cylinder.kappa),
            common: Common::new(surface, 0.0, [sheet.inside.extent[0], sheet.tolerance]),
        }
    }
}

impl<S: Scalar> LaneSheet<S> {
    pub fn new(sheet: &UnsymmetricSheet<f64>, surface: &CompiledSurface<'_>, transfer: Transfer<S>) -> Self {
        let number = S::from_f64;
        let [inside, beyond] = [&sheet.inside, &sheet.beyond].map(|bounds: &SheetBounds| number(bounds.bend));
        Self {
            transfer,
            constants: sheet.constants.map(number),
            inside,
            beyond,
            rim: number(sheet.rim),
            reach: number(sheet.reach),
            highest: number(sheet.beyond.extent[1]),
            tolerance: number(sheet.tolerance * (S::EPSILON / f64::EPSILON)),
            common: Common::new(surface, 0.0, [sheet.beyond.extent[0], sheet.tolerance]),
        }
    }
}

/// A vector as a number of a formula.
#[derive(Clone, Copy)]
struct LaneNumber<L>(L);

/// Defines the operators of [`LaneNumber`].
macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl<L: Lanes> $trait for LaneNumber<L> {
            type Output = Self;
            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
    )*};
}

operators!(Add add +, Sub sub -, Mul mul *, Div div /);

/// Defines methods of one line.
macro_rules! methods {
    ($(fn $method:ident($($parameters:tt)*) = $value:expr;)*) => {$(
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $method($($parameters)*) -> Self {
            $value
        }
    )*};
}

impl<L: Lanes> Arithmetic for LaneNumber<L> {
    type Constant = L;
    methods! {
        fn sqrt(self) = Self(self.0.sqrt());
        fn squared(self) = Self(self.0 * self.0);
        fn times(self, factor: L) = Self(self.0 * factor);
        fn plus(self, term: L) = Self(self.0 + term);
        fn taken_from(self, minuend: L) = Self(minuend - self.0);
        fn dividing(self, dividend: L) = Self(dividend / self.0);
    }
}

/// Returns the constants of a surface in every lane.
#[cfg_attr(not(debug_assertions), inline(always))]
fn splat<L: Lanes>(cpu: Cpu<L>, constants: &UnsymmetricConstants<L::Scalar>) -> UnsymmetricConstants<L> {
    match *constants {
        UnsymmetricConstants::Toroid { is_in_x, one, c, bend, terms, rotation } => {
            let mut all = [L::splat(cpu, one); realistic_optics::prescription::PROFILE_TERMS];
            for (lane, &term) in all.iter_mut().zip(&terms) {
                *lane = L::splat(cpu, term);
            }
            UnsymmetricConstants::Toroid {
                is_in_x,
                one: L::splat(cpu, one),
                c: L::splat(cpu, c),
                bend: L::splat(cpu, bend),
                terms: all,
                rotation: L::splat(cpu, rotation),
            }
        }
        UnsymmetricConstants::Biconic { one, c, bend } => UnsymmetricConstants::Biconic {
            one: L::splat(cpu, one),
            c: [L::splat(cpu, c[0]), L::splat(cpu, c[1])],
            bend: [L::splat(cpu, bend[0]), L::splat(cpu, bend[1])],
        },
    }
}

/// A step for vectors of rays, packed so that [`Lanes::far_apart`] can take it in a function that all callers share.
pub struct GeneralSteps<'a, L: Lanes, A, C: Carried<L::Scalar>> {
    pub cpu: Cpu<L>,
    pub step: &'a GeneralStep<L::Scalar>,
    pub carried: &'a C,
    /// Number of the step in the table.
    pub number: usize,
    pub rays: &'a mut [RayLanes<L, A>],
    pub states: &'a mut [C::State<L>],
}

impl<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>> Compiled for GeneralSteps<'_, L, A, C> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        let Self { cpu, step, carried, number, rays, states } = self;
        match step {
            GeneralStep::Frame(frame) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    ray.frame(cpu, frame);
                    carried.enter_frame(cpu, state, &frame.rotation);
                }
            }
            GeneralStep::Cylinder(cylinder) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    let crossing = ray.cylinder(cpu, cylinder, carried.media(state));
                    cylinder.common.cross(cpu, carried, number, state, &crossing);
                }
            }
            GeneralStep::Sheet(sheet) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    let crossing = ray.sheet(cpu, sheet, carried.media(state));
                    sheet.common.cross(cpu, carried, number, state, &crossing);
                }
            }
        }
    }
}

impl<L: Lanes, A: Apertures<L>> RayLanes<L, A> {
    /// Moves rays to the vertex plane of a surface, as [`Self::reach_plane`] does.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reach_vertex(
        &mut self,
        cpu: Cpu<L>,
        transfer: &Transfer<L::Scalar>,
        common: &Common<L::Scalar>,
    ) -> [L; 2] {
        let lead = self.lead(common.is_led).unwrap_or(L::splat(cpu, L::Scalar::ZERO));
        self.reach_plane(cpu, common, self.minus_z(cpu, transfer), lead)
    }

    /// Takes rays to the frame of the next surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn frame(&mut self, cpu: Cpu<L>, frame: &Frame<L::Scalar>) {
        let z = L::splat(cpu, L::Scalar::ZERO) - self.minus_z(cpu, &frame.transfer);
        let (p, v) = ([self.x, self.y, z], [self.vx, self.vy, self.vz]);
        let (mut moved, mut turned) = (p, v);
        for i in 0..3 {
            let [a, b, c] = frame.rotation[i];
            let (a, b, c) = (L::splat(cpu, a), L::splat(cpu, b), L::splat(cpu, c));
            let offset = L::splat(cpu, frame.offset[i]);
            moved[i] = a.mul_add(p[0], b.mul_add(p[1], c.mul_add(p[2], offset)));
            turned[i] = a.mul_add(v[0], b.mul_add(v[1], c * v[2]));
        }
        [self.x, self.y, self.height] = moved;
        [self.vx, self.vy, self.vz] = turned;
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn cylinder(
        &mut self,
        cpu: Cpu<L>,
        cylinder: &LaneCylinder<L::Scalar>,
        media: impl Media<L>,
    ) -> Crossing<L> {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let (c, kappa) = (L::splat(cpu, cylinder.c), L::splat(cpu, cylinder.kappa));
        let [to_plane, from] = self.reach_vertex(cpu, &cylinder.transfer, &cylinder.common);
        let (u, vu) = if cylinder.is_in_x { (self.x, self.vx) } else { (self.y, self.vy) };
        let a = c * vu.mul_add(vu, kappa * (self.vz * self.vz));
        let cu = c * u;
        let g = cu.neg_mul_add(vu, self.vz);
        let square = g.mul_add(g, zero - a * (cu * u));
        let e = square.sqrt();
        let near = zero.less(g);
        let t = L::select(near, cu * u, g - e) / L::select(near, g + e, a);
        self.advance(t);
        let z = t * self.vz;
        let q = (kappa * c).neg_mul_add(z, one);
        self.keep(zero.less(q));
        self.keep(from.less_equal(t));
        self.keep((zero - a * (t - from)).less(e + e));
        self.height = z;
        let across = zero - c * (if cylinder.is_in_x { self.x } else { self.y });
        let normal = if cylinder.is_in_x { [across, zero, q] } else { [zero, across, q] };
        self.bend_along(cpu, &cylinder.common, media, normal, e, to_plane + t)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sheet(&mut self, cpu: Cpu<L>, sheet: &LaneSheet<L::Scalar>, media: impl Media<L>) -> Crossing<L> {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let [to_plane, from] = self.reach_vertex(cpu, &sheet.transfer, &sheet.common);
        let constants = splat(cpu, &sheet.constants);
        let (rim, reach) = (L::splat(cpu, sheet.rim), L::splat(cpu, sheet.reach));
        let tolerance = L::splat(cpu, sheet.tolerance);
        let across = self.vy.mul_add(self.vy, self.vx * self.vx);
        let (inside, beyond) = (across * L::splat(cpu, sheet.inside), across * L::splat(cpu, sheet.beyond));
        let along = self.y.mul_add(self.vy, self.x * self.vx);
        let start = self.height_squared();
        // x² + y² is a polynomial in t. The steps begin where the ray comes within the reach.
        let begins = from.mul_add(from.mul_add(across, along + along), start).less_equal(reach);
        let root = along.mul_add(along, across * (reach - start)).sqrt();
        let entry = zero - (along + root) / across;
        self.keep(zero.less_equal(L::select(begins, zero, entry - from)));
        let mut t = L::select(begins, from, entry);
        let end = L::splat(cpu, sheet.highest) / self.vz;
        let beside = reach * L::splat(cpu, L::Scalar::from_f64(BESIDE));
        let mut slopes = [zero; 2];
        let mut facing = one;
        // 1 for rays that have not arrived; the others stay, whatever other lanes do.
        let mut going = one;
        for _ in 0..STEPS {
            let x = Gradient {
                value: LaneNumber(t.mul_add(self.vx, self.x)),
                x: LaneNumber(one),
                y: LaneNumber(zero),
            };
            let y = Gradient {
                value: LaneNumber(t.mul_add(self.vy, self.y)),
                x: LaneNumber(zero),
                y: LaneNumber(one),
            };
            let Gradient { value, x, y } = constants.sagitta([x, y]);
            let goes = zero.less(going);
            slopes = [L::select(goes, x.0, slopes[0]), L::select(goes, y.0, slopes[1])];
            let before = t.neg_mul_add(self.vz, value.0);
            facing = L::select(goes, y.0.neg_mul_add(self.vy, x.0.neg_mul_add(self.vx, self.vz)), facing);
            let arrives = L::both(goes, before.abs().less_equal(tolerance));
            let here = t.mul_add(t.mul_add(across, along + along), start);
            let twice = before + before;
            let square = facing * facing;
            let short = twice / (facing + beyond.mul_add(twice, square).sqrt());
            let long = twice / (facing + inside.mul_add(twice, square).sqrt());
            let there = t + long;
            let stays = L::both(
                L::both(here.less_equal(rim), zero.less(long)),
                there.mul_add(there.mul_add(across, along + along), start).less_equal(rim),
            );
            let step = L::select(stays, long, short);
            // A ray that starts behind the surface, or never comes nearer, has no positive step.
            let goes_on = L::both(L::both(t.less_equal(end), here.less_equal(beside)), zero.less(step));
            let is_lost = L::select(goes, L::select(arrives, zero, L::select(goes_on, zero, one)), zero);
            self.keep(is_lost.less(one));
            t = L::select(goes, t + L::select(arrives, before / facing, step), t);
            going = L::select(arrives, zero, going);
            if self.passed_bits() & L::bits(zero.less(going)) == 0 {
                break;
            }
        }
        self.keep(going.less(one));
        self.keep(zero.less(facing));
        self.advance(t);
        self.height = t * self.vz;
        let normal = [zero - slopes[0], zero - slopes[1], one];
        self.bend_along(cpu, &sheet.common, media, normal, facing, to_plane + t)
    }

    /// Tests the aperture and refracts or reflects at a point of a surface, as [`Self::bend_at`] does, for a normal N of
    /// any direction and length; `facing` is N·V.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bend_along(
        &mut self,
        cpu: Cpu<L>,
        common: &Common<L::Scalar>,
        media: impl Media<L>,
        normal: [L; 3],
        facing: L,
        distance: L,
    ) -> Crossing<L> {
        let [nx, ny, nz] = normal;
        let square = nz.mul_add(nz, ny.mul_add(ny, nx * nx));
        let [gain, after] = self.gain(cpu, common, media, facing, square);
        self.vx = gain.mul_add(nx, self.vx);
        self.vy = gain.mul_add(ny, self.vy);
        self.vz = gain.mul_add(nz, self.vz);
        if common.is_mirror {
            self.vz = L::splat(cpu, L::Scalar::ZERO) - self.vz;
        }
        self.crossing(normal, Some(square), [facing, after], distance)
    }
}

/// Maximum number of steps along rays, as in the walk.
const STEPS: usize = 256;
/// Factor by which rounding may move a squared distance beyond the bound on it.
const BESIDE: f64 = 1.0 + 1e-6;
