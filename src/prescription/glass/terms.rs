//! What of an index depends on the wavelength, as sums of simple terms: a medium in, the terms that vectors of wavelengths
//! are put into out. The same formulas as in `formula`, `two_numbers` and `sellmeier`, less their constants.

use super::{
    formula::{Formula, HERZBERGER, LOWEST_POWER},
    two_numbers,
};
use crate::prescription::interfaces::Medium;

/// How an index changes with the wavelength λ, µm.
#[derive(Clone, Debug, PartialEq)]
pub enum Dispersion {
    /// Not at all.
    None,
    /// n or n² less a constant.
    Terms {
        /// n², else n.
        of_square: bool,
        /// What is summed.
        terms: Terms,
    },
}

/// Terms of a formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Terms {
    /// `slope` λ² + Σ w/(λ² - C).
    Poles {
        /// Of λ².
        slope: f64,
        /// w and C, µm².
        poles: Vec<[f64; 2]>,
    },
    /// Σ a λ^(2 p) over p = 1, 2, … and over p = -1, -2, ….
    Powers {
        /// Of λ², λ⁴, ….
        rising: Vec<f64>,
        /// Of λ^-2, λ^-4, ….
        falling: Vec<f64>,
    },
    /// b/λ + c/λ^3.5.
    Conrady([f64; 2]),
    /// Σ b L^p + Σ d λ^(2 p), L = 1/(λ² - 0.028), over p = 1, 2, ….
    Herzberger {
        /// Of L, L².
        of_l: [f64; 2],
        /// Of λ², λ⁴, λ⁶.
        rising: [f64; 3],
    },
}

impl Dispersion {
    /// That of a medium.
    pub fn of(medium: &Medium) -> Self {
        let of_index = |terms| Self::Terms { of_square: false, terms };
        let of_square = |terms| Self::Terms { of_square: true, terms };
        // B λ²/(λ² - C) is B + B C/(λ² - C).
        let poles = |b: &[f64], c: &[f64]| b.iter().zip(c).map(|(b, c)| [b * c, *c]).collect();
        match medium {
            Medium::Air | Medium::Glass { abbe: None, .. } => Self::None,
            Medium::Glass { n_d, abbe: Some(abbe) } => {
                let [inverse, slope, pole] = two_numbers::terms(*n_d, *abbe);
                of_index(Terms::Poles { slope, poles: vec![[inverse, 0.0], [pole, HERZBERGER]] })
            }
            Medium::Sellmeier(constants) => {
                of_square(Terms::Poles { slope: 0.0, poles: poles(&constants.b, &constants.c) })
            }
            Medium::Formula(Formula::Sellmeier { rest: [_, slope], b, c }) => {
                let poles = poles(b, c);
                of_square(Terms::Poles { slope: *slope, poles })
            }
            Medium::Formula(Formula::Polynomial(constants)) => {
                let lowest = (-LOWEST_POWER / 2) as usize;
                let falling = constants[..lowest].iter().rev().copied().collect();
                of_square(Terms::Powers { rising: constants[lowest + 1..].to_vec(), falling })
            }
            Medium::Formula(Formula::Conrady([_, b, c])) => of_index(Terms::Conrady([*b, *c])),
            Medium::Formula(Formula::Herzberger([_, b, c, d, e, f])) => {
                of_index(Terms::Herzberger { of_l: [*b, *c], rising: [*d, *e, *f] })
            }
        }
    }
}
