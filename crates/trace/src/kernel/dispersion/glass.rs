//! Dispersion formulas of glasses in lanes. They give the difference between n² at given wavelengths and n² at the
//! lens's own wavelength. This difference is small, and so is its rounding error, also in single precision.

use realistic_base::numeric::Real;
use realistic_optics::prescription::{
    Medium,
    glass::{Dispersion, DispersionTerms, HERZBERGER, refractive_index},
};
use realistic_simd::{Cpu, Lanes, Scalar};

/// Wavelengths of a vector of rays, µm, in the forms that the formulas use.
#[derive(Clone, Copy)]
pub struct LightLanes<L> {
    wavelength: L,
    /// λ².
    square: L,
    /// λ₀² - λ², λ₀ being the lens's own wavelength.
    shorter: L,
}

impl<L: Lanes> LightLanes<L> {
    /// Converts wavelengths in nm; `own` is λ₀², µm².
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn new(cpu: Cpu<L>, nanometres: L, own: L::Scalar) -> Self {
        let wavelength = nanometres * L::splat(cpu, L::Scalar::from_f64(1e-3));
        let shorter = wavelength.neg_mul_add(wavelength, L::splat(cpu, own));
        Self { wavelength, square: wavelength * wavelength, shorter }
    }
}

/// A medium, given by n² at any wavelength.
#[derive(Clone, Debug)]
pub struct LaneGlass<S> {
    /// n² at the lens's own wavelength.
    pub square: S,
    change: Change<S>,
}

/// The change of n² from the lens's own wavelength to another.
#[derive(Clone, Debug)]
enum Change<S> {
    None,
    OfSquare(Sum<S>),
    /// A sum that yields the change of n rather than n², and twice the index at the lens's own wavelength.
    OfIndex(Sum<S>, S),
}

/// The terms of a formula, minus their values at the lens's own wavelength.
#[derive(Clone, Debug)]
enum Sum<S> {
    /// (λ₀² - λ²) (Σ w/(s λ² - c) - `slope`).
    Poles {
        slope: S,
        poles: Box<[Pole<S>]>,
    },
    Powers {
        rising: Box<[S]>,
        falling: Box<[S]>,
        own: S,
    },
    Conrady([S; 2], S),
    Herzberger {
        of_l: [S; 2],
        rising: [S; 3],
        own: S,
    },
}

#[derive(Clone, Copy, Debug)]
struct Pole<S> {
    weight: S,
    /// Scale that keeps the denominator near 1 for a distant resonance.
    scale: S,
    center: S,
}

impl<S: Scalar> LaneGlass<S> {
    /// Builds a medium; `own` is the lens's own wavelength, nm.
    pub fn new(medium: &Medium, own: f64) -> Self {
        let index = refractive_index(*medium, own);
        let change = match Dispersion::of(medium) {
            Dispersion::None => Change::None,
            Dispersion::Terms { of_square: true, terms } => Change::OfSquare(Sum::new(&terms, own)),
            Dispersion::Terms { of_square: false, terms } => {
                Change::OfIndex(Sum::new(&terms, own), S::from_f64(2.0 * index))
            }
        };
        Self { square: S::from_f64(index * index), change }
    }

    /// Returns the medium with its n² at the lens's own wavelength divided by that of another medium. The changes stay
    /// the same.
    #[must_use]
    pub fn relative_to(self, other: &Self) -> Self {
        Self { square: S::from_f64(self.square.to_f64() / other.square.to_f64()), ..self }
    }

    /// Whether the index is the same at every wavelength.
    pub fn is_fixed(&self) -> bool {
        matches!(self.change, Change::None)
    }

    /// Returns n² minus n² at the lens's own wavelength.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn change<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, light: &LightLanes<L>) -> L {
        match &self.change {
            Change::None => L::splat(cpu, S::ZERO),
            Change::OfSquare(sum) => sum.at(cpu, light),
            Change::OfIndex(sum, twice) => {
                let change = sum.at(cpu, light);
                change * (change + L::splat(cpu, *twice))
            }
        }
    }
}

impl<S: Scalar> Sum<S> {
    fn new(terms: &DispersionTerms, own: f64) -> Self {
        let round = |numbers: &[f64]| numbers.iter().map(|&number| S::from_f64(number)).collect();
        let wavelength = own * 1e-3;
        let square = wavelength * wavelength;
        let l = (square - HERZBERGER).recip();
        // Horner's rule; the constant is 0.
        let powers = |numbers: &[f64], of: f64| of * numbers.iter().rev().fold(0.0, |sum, a| sum * of + a);
        match terms {
            DispersionTerms::Poles { slope, poles } => {
                let pole = |&[weight, center]: &[f64; 2]| {
                    let scale = center.abs().max(1.0).recip();
                    Pole {
                        weight: S::from_f64(weight * scale / (square - center)),
                        scale: S::from_f64(scale),
                        center: S::from_f64(center * scale),
                    }
                };
                let used = poles.iter().filter(|[weight, _]| *weight != 0.0);
                Self::Poles { slope: S::from_f64(*slope), poles: used.map(pole).collect() }
            }
            DispersionTerms::Powers { rising, falling } => Self::Powers {
                rising: round(rising),
                falling: round(falling),
                own: S::from_f64(powers(rising, square) + powers(falling, square.recip())),
            },
            DispersionTerms::Conrady([b, c]) => {
                let own = b / wavelength + c / wavelength.powf(3.5);
                Self::Conrady([*b, *c].map(S::from_f64), S::from_f64(own))
            }
            DispersionTerms::Herzberger { of_l, rising } => Self::Herzberger {
                of_l: of_l.map(S::from_f64),
                rising: rising.map(S::from_f64),
                own: S::from_f64(powers(of_l, l) + powers(rising, square)),
            },
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, light: &LightLanes<L>) -> L {
        let one = L::splat(cpu, S::ONE);
        match self {
            Self::Poles { slope, poles } => {
                // All poles are summed in one fraction: a division costs as much as several multiplications.
                let (mut over, mut under) = (L::splat(cpu, S::ZERO), one);
                for pole in poles {
                    let from = light.square.mul_sub(L::splat(cpu, pole.scale), L::splat(cpu, pole.center));
                    over = under.mul_add(L::splat(cpu, pole.weight), over * from);
                    under = under * from;
                }
                light.shorter * (over / under - L::splat(cpu, *slope))
            }
            Self::Powers { rising, falling, own } => {
                let falling = horner(cpu, falling, one / light.square);
                horner(cpu, rising, light.square) + (falling - L::splat(cpu, *own))
            }
            Self::Conrady([b, c], own) => {
                let inverse = one / light.wavelength;
                let steep = (inverse * inverse) * (inverse * inverse.sqrt());
                let sum = steep.mul_sub(L::splat(cpu, *c), L::splat(cpu, *own));
                inverse.mul_add(L::splat(cpu, *b), sum)
            }
            Self::Herzberger { of_l, rising, own } => {
                let l = one / (light.square - L::splat(cpu, S::from_f64(HERZBERGER)));
                horner(cpu, rising, light.square) + (horner(cpu, of_l, l) - L::splat(cpu, *own))
            }
        }
    }
}

/// Evaluates a polynomial without a constant.
#[cfg_attr(not(debug_assertions), inline(always))]
fn horner<L: Lanes>(cpu: Cpu<L>, numbers: &[L::Scalar], of: L) -> L {
    let mut sum = L::splat(cpu, L::Scalar::ZERO);
    let mut k = numbers.len();
    while k > 0 {
        k -= 1;
        sum = sum.mul_add(of, L::splat(cpu, numbers[k]));
    }
    sum * of
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::glass::Formula;
    use realistic_simd::{OneLane, Portable};

    /// Returns a medium for each formula.
    fn media() -> Vec<Medium> {
        let b = [1.039_612_12, 0.231_792_344, 1.010_469_45];
        let c = [0.006_000_698_67, 0.020_017_914_4, 103.560_653];
        vec![
            Medium::Air,
            Medium::Glass { n_d: 1.5168, abbe: None },
            Medium::Glass { n_d: 1.5168, abbe: Some(64.17) },
            Medium::Glass { n_d: 1.9, abbe: Some(12.0) },
            Medium::Sellmeier { b, c },
            Medium::Formula(Formula::Sellmeier {
                rest: [1.1, -0.012],
                b: [0.9, 0.25, 1.0, 0.05, 0.0],
                c: [0.006, 0.02, 103.0, 0.03, 0.0],
            }),
            // Schott's formula of 1966 for BK7.
            Medium::Formula(Formula::Polynomial([
                0.0,
                0.0,
                -9.6e-7,
                9.0e-6,
                1.66e-4,
                0.010_646,
                2.271_289,
                -0.010_108_077,
                0.0,
                0.0,
            ])),
            Medium::Formula(Formula::Conrady([1.48, 0.016, 0.000_5])),
            Medium::Formula(Formula::Herzberger([1.5, 0.006, 0.000_2, -0.003, 0.000_1, -0.000_01])),
        ]
    }

    #[test]
    fn lanes_have_the_index_of_each_formula() {
        for medium in media() {
            for own in [587.56, 400.0, 1000.0] {
                let (double, single) =
                    (LaneGlass::<f64>::new(&medium, own), LaneGlass::<f32>::new(&medium, own));
                let square_of_own = (own * 1e-3) * (own * 1e-3);
                for nm in (380..=780).step_by(10).map(f64::from) {
                    let exact = refractive_index(medium, nm).powi(2) - refractive_index(medium, own).powi(2);
                    let light = LightLanes::new(OneLane::cpu(), Portable([nm]), square_of_own);
                    let Portable([change]) = double.change(OneLane::cpu(), &light);
                    assert!((change - exact).abs() < 4e-15, "{medium:?} {own} {nm}: {change} {exact}");
                    let light = LightLanes::new(OneLane::cpu(), Portable([nm as f32]), square_of_own as f32);
                    let Portable([change]) = single.change(OneLane::cpu(), &light);
                    let off = f64::from(change) - exact;
                    // The bound is two units in the last place of n² itself. Glasses that disperse more than any real
                    // glass come near it.
                    let bound = 2.0 * f64::from(f32::EPSILON) * refractive_index(medium, nm).powi(2);
                    assert!(off.abs() < bound, "{medium:?} {own} {nm}: {change} {exact}");
                }
            }
        }
    }
}
