//! Transmission of a surface in lanes, computed from n cos I on both sides of the surface. A bare surface uses
//! Fresnel's equations. A coated surface uses the transfer matrix ([`super::stack`]) or, at one wavelength,
//! polynomials.
//!
//! A bare surface with S = (n cos I + n' cos I')² and A = (n² + n'²) S - (n'² - n²)² has
//!
//! T_s = 4 n cos I n' cos I'/S,  T_p = T_s (2 n n' S/A)²,  t_s t_p = T_s 2 n n' S/A.
//!
//! These are the usual forms, with the denominator of p multiplied by that of s, so that one division serves both.

use std::f64::consts::{PI, TAU};

use super::{boundary::Boundary, stack::Share};
use realistic_optics::prescription::Layer;
use realistic_simd::{Compiled, Cpu, Lanes, cos_sin};

/// The effect of a surface on transmitted light ([`Share`]): half the sum and half the difference of the shares of s
/// and p, and the real and imaginary part of the product of their amplitudes.
pub(super) type ShareLanes<L> = [L; 4];

/// A surface between two media, for lanes of single precision.
#[derive(Clone, Debug)]
pub(super) enum LaneSurface {
    /// A coated surface at one wavelength.
    Fitted(FittedShare),
    /// Any surface at any wavelength.
    Stack(LaneStack),
}

/// The [`ShareLanes`] of a coated surface, divided by n cos I in the rarer medium, as polynomials. The variable is n'
/// cos I' - n cos I, denser minus rarer, scaled to [-1, 1]; a lower degree suffices in this variable than in the
/// cosine. Without the division, the shares of grazing rays would have large relative errors.
#[derive(Clone, Debug)]
pub(super) struct FittedShare {
    /// Whether the rarer medium is before the surface.
    is_rarer_before: bool,
    /// Factor and constant that scale n' cos I' - n cos I, behind minus before.
    scale: [f32; 2],
    /// Coefficients of the four polynomials, the highest power first.
    coefficients: Box<[[f32; 4]]>,
}

/// The layers of a surface between two media.
#[derive(Clone, Debug)]
pub(super) struct LaneStack {
    /// n², 1/n², and 2π times the thickness, nm, of each layer, listed from the air on.
    layers: Box<[[f32; 3]]>,
    /// Whether the air is before the surface.
    is_air_before: bool,
}

/// Lowest and highest degree of the polynomials. One to three layers need degrees from 6 to 8.
const LEAST_DEGREE: usize = 3;
const MOST_DEGREE: usize = 14;
/// Number of cosines at which the polynomials' error is measured.
const CHECKED: usize = 64;
/// Value of n cos I used for grazing incidence, where p has no admittance.
const GRAZING: f64 = 1e-9;

impl LaneSurface {
    /// Fits polynomials to a boundary, with a relative error of at most `goal`, for rays that come from the medium with
    /// the index `index_before` and whose n cos I is relative to the index `unit`; `None` if the stack is too thick for
    /// polynomials.
    pub fn fitted(boundary: &Boundary, index_before: f64, goal: f64, unit: f64) -> Option<Self> {
        let [rarer, denser] = boundary.ordered();
        let step = denser * denser - rarer * rarer;
        // The variable at normal and at grazing incidence.
        let [least, most] = [denser - rarer, step.sqrt()];
        let (middle, half) = (f64::midpoint(least, most), (most - least) / 2.0);
        let at = |x: f64| {
            let difference = middle + half * x;
            let facing = ((step / difference - difference) / 2.0).max(GRAZING);
            let cosine = (facing / rarer).min(1.0);
            let Share { s, p, cross: [re, im] } = boundary.computed(rarer, cosine).transmitted;
            [f64::midpoint(s, p), (s - p) / 2.0, re, im].map(|number| number / facing)
        };
        let checked: Vec<(f64, [f64; 4])> =
            (0..=CHECKED).map(|k| 2.0 * k as f64 / CHECKED as f64 - 1.0).map(|x| (x, at(x))).collect();
        let error = |polynomials: &[[f64; 4]]| {
            let off = |&(x, exact): &(f64, [f64; 4])| {
                let value = value(polynomials, x);
                (0..4).fold(0.0, |most, i| (value[i] - exact[i]).abs().max(most)) / exact[0]
            };
            checked.iter().map(off).fold(0.0, f64::max)
        };
        let fit = |degree| Some(interpolate(degree, at)).filter(|fit| error(fit) <= goal);
        // The highest degree is tried first: if it does not fit the stack, no other degree needs to be tried.
        let highest = fit(MOST_DEGREE)?;
        let least_fit = (LEAST_DEGREE..MOST_DEGREE).find_map(fit).unwrap_or(highest);
        let is_rarer_before = index_before == rarer;
        let factor = if is_rarer_before { half.recip() } else { -half.recip() };
        Some(Self::Fitted(FittedShare {
            is_rarer_before,
            scale: [factor * unit, -middle / half].map(|number| number as f32),
            coefficients: least_fit
                .iter()
                .rev()
                .map(|numbers| numbers.map(|number| (number * unit) as f32))
                .collect(),
        }))
    }

    /// Returns the surface with its layers, listed from the air on.
    pub fn stack(from_air: &[Layer], is_air_before: bool) -> Self {
        let layer = |Layer { index, thickness }: &Layer| {
            [index * index, (index * index).recip(), TAU * thickness].map(|number| number as f32)
        };
        Self::Stack(LaneStack { layers: from_air.iter().map(layer).collect(), is_air_before })
    }

    /// Returns the effect of the surface on rays. `facing` is n cos I before and behind the surface, `indices` is n on
    /// the same sides, and `wavelength` is in nm.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn share<L: Lanes<Scalar = f32>>(
        &self,
        cpu: Cpu<L>,
        facing: [L; 2],
        indices: [L; 2],
        wavelength: L,
    ) -> ShareLanes<L> {
        match self {
            Self::Fitted(fitted) => fitted.share(cpu, facing),
            Self::Stack(stack) if stack.layers.is_empty() => bare(cpu, facing, indices),
            Self::Stack(stack) => {
                let mut share = [facing[0]; 4];
                L::apart(cpu, StackShare { cpu, stack, facing, indices, wavelength, share: &mut share });
                share
            }
        }
    }
}

impl FittedShare {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn share<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, [before, behind]: [L; 2]) -> ShareLanes<L> {
        let rarer = if self.is_rarer_before { before } else { behind };
        let x = (behind - before).mul_add(L::splat(cpu, self.scale[0]), L::splat(cpu, self.scale[1]));
        let mut sums = [x; 4];
        for (sum, coefficient) in sums.iter_mut().zip(self.coefficients[0]) {
            *sum = L::splat(cpu, coefficient);
        }
        for coefficients in &self.coefficients[1..] {
            for (sum, coefficient) in sums.iter_mut().zip(coefficients) {
                *sum = sum.mul_add(x, L::splat(cpu, *coefficient));
            }
        }
        for sum in &mut sums {
            *sum = *sum * rarer;
        }
        sums
    }
}

/// Returns the effect of a bare surface, by Fresnel's equations.
#[cfg_attr(not(debug_assertions), inline(always))]
fn bare<L: Lanes<Scalar = f32>>(
    cpu: Cpu<L>,
    [before, behind]: [L; 2],
    [n, n_behind]: [L; 2],
) -> ShareLanes<L> {
    let (square, square_behind) = (n * n, n_behind * n_behind);
    let step = square_behind - square;
    let sum = before + behind;
    let sum = sum * sum;
    let a = step.neg_mul_add(step, (square + square_behind) * sum);
    let inverse = L::splat(cpu, 1.0) / (sum * a);
    let product = before * behind;
    let twice = product + product;
    let s = (twice + twice) * (a * inverse);
    let ratio = ((n + n) * n_behind) * (sum * (sum * inverse));
    let both = s * ratio;
    let p = both * ratio;
    let half = L::splat(cpu, 0.5);
    [half * (s + p), half * (s - p), both, L::splat(cpu, 0.0)]
}

/// The complex fields B and C, of s or of p, on the near side of a stack.
#[derive(Clone, Copy)]
struct Fields<L> {
    b: [L; 2],
    c: [L; 2],
}

impl<L: Lanes> Fields<L> {
    /// Puts a layer in front of the stack. The layer is given by its admittance and the reciprocal of its admittance,
    /// and by the cosine and the sine of its phase.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn behind(self, [admittance, inverse]: [L; 2], [cos, sin]: [L; 2]) -> Self {
        let Self { b: [br, bi], c: [cr, ci] } = self;
        let (over, times) = (sin * inverse, sin * admittance);
        Self {
            b: [over.neg_mul_add(ci, cos * br), over.mul_add(cr, cos * bi)],
            c: [times.neg_mul_add(bi, cos * cr), times.mul_add(br, cos * ci)],
        }
    }

    /// Returns `b` B + `c` C.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sum(self, b: L, c: L) -> [L; 2] {
        [b.mul_add(self.b[0], c * self.c[0]), b.mul_add(self.b[1], c * self.c[1])]
    }
}

/// The effect of a stack, as work for a function of its own: inlined at every step of the kernel, it would make up most
/// of the code.
struct StackShare<'a, L> {
    cpu: Cpu<L>,
    stack: &'a LaneStack,
    facing: [L; 2],
    indices: [L; 2],
    wavelength: L,
    share: &'a mut ShareLanes<L>,
}

impl<L: Lanes<Scalar = f32>> Compiled for StackShare<'_, L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        *self.share = self.stack.share(self.cpu, self.facing, self.indices, self.wavelength);
    }
}

impl LaneStack {
    /// Computes the transfer matrix of all layers. To avoid divisions in the admittances of p, the fields of p are
    /// multiplied by n cos I of the last medium, and their sum is multiplied by n cos I of the first medium.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn share<L: Lanes<Scalar = f32>>(
        &self,
        cpu: Cpu<L>,
        [before, behind]: [L; 2],
        [n, n_behind]: [L; 2],
        wavelength: L,
    ) -> ShareLanes<L> {
        let number = |number: f32| L::splat(cpu, number);
        let (zero, one, grazing) = (number(0.0), number(1.0), number(GRAZING as f32));
        let (first, last, n_first, n_last) =
            if self.is_air_before { (before, behind, n, n_behind) } else { (behind, before, n_behind, n) };
        let (square_first, square_last) = (n_first * n_first, n_last * n_last);
        // n² sin² is the same in every layer.
        let sine = first.neg_mul_add(first, square_first);
        let per_wavelength = one / wavelength;
        let mut s = Fields { b: [one, zero], c: [last, zero] };
        let mut p = Fields { b: [last, zero], c: [square_last, zero] };
        let mut k = self.layers.len();
        while k > 0 {
            k -= 1;
            let [square, per_square, thickness] = self.layers[k];
            let (square, per_square) = (L::splat(cpu, square), L::splat(cpu, per_square));
            let along = (square - sine).larger(grazing).sqrt();
            let turn = cos_sin(cpu, (L::splat(cpu, thickness) * per_wavelength) * along);
            let inverse = one / along;
            s = s.behind([along, inverse], turn);
            p = p.behind([square * inverse, along * per_square], turn);
        }
        let ([sr, si], [pr, pi]) = (s.sum(first, one), p.sum(square_first, first));
        let (ds, dp) = (si.mul_add(si, sr * sr), pi.mul_add(pi, pr * pr));
        let inverse = one / (ds * dp);
        let power = number(4.0) * (first * last);
        let indices = n * n_behind;
        let (s, p) = (power * (dp * inverse), (power * (indices * indices)) * (ds * inverse));
        let both = (power * indices) * inverse;
        let half = number(0.5);
        [half * (s + p), half * (s - p), both * si.mul_add(pi, sr * pr), both * si.neg_mul_add(pr, sr * pi)]
    }
}

/// Returns the coefficients, from the lowest power on, of the polynomials of a degree that pass through the values at
/// Chebyshev's nodes.
fn interpolate(degree: usize, at: impl Fn(f64) -> [f64; 4]) -> Vec<[f64; 4]> {
    let count = degree + 1;
    let angle = |k: usize| PI * (k as f64 + 0.5) / count as f64;
    let values: Vec<[f64; 4]> = (0..count).map(|k| at(angle(k).cos())).collect();
    let mut powers = vec![[0.0; 4]; count];
    // Chebyshev's polynomials T_j and T_(j+1) in powers of x.
    let (mut here, mut next) = (vec![0.0; count + 1], vec![0.0; count + 1]);
    (here[0], next[1]) = (1.0, 1.0);
    for j in 0..count {
        let scale = if j == 0 { 1.0 } else { 2.0 } / count as f64;
        for i in 0..4 {
            let sum: f64 = (0..count).map(|k| values[k][i] * (j as f64 * angle(k)).cos()).sum();
            for (power, part) in powers.iter_mut().zip(&here) {
                power[i] += scale * sum * part;
            }
        }
        let mut after: Vec<f64> = here.iter().map(|part| -part).collect();
        for power in 0..count {
            after[power + 1] += 2.0 * next[power];
        }
        (here, next) = (next, after);
    }
    powers
}

/// Evaluates polynomials with coefficients from the lowest power on.
fn value(polynomials: &[[f64; 4]], x: f64) -> [f64; 4] {
    polynomials.iter().rev().fold([0.0; 4], |sum, numbers| std::array::from_fn(|i| sum[i] * x + numbers[i]))
}
