//! The dispersion formulas of glass catalogues, except Sellmeier's formula with three terms. They give the index at a
//! wavelength in µm. This module also defines the wavelengths, nm, at which catalogues state indices and at which
//! glasses are evaluated.

use std::ops::RangeInclusive;

/// Wavelength of the helium d line, nm, which is the default wavelength, rounded as in parameters and most files.
pub const D_LINE: f64 = 587.56;
/// The wavelengths, nm, that are interpreted as the d line: from [`D_LINE`] to its exact wavelength, 587.5618.
pub const D_LINES: RangeInclusive<f64> = D_LINE..=587.5618;
/// Wavelength of the hydrogen F line, nm.
pub const F_LINE: f64 = 486.13;
/// Wavelength of the hydrogen C line, nm.
pub const C_LINE: f64 = 656.27;

/// The wavelengths, nm, at which lenses are traced and glasses can have an index.
pub const VALID_WAVELENGTHS: RangeInclusive<f64> = 200.0..=2000.0;

/// The wavelengths, nm, at which a glass of unknown range is used. A glass of known range may also be used outside its
/// range, with a warning, but only at these wavelengths. At shorter wavelengths glasses absorb, and formulas diverge.
pub const ORDINARY_WAVELENGTHS: RangeInclusive<f64> = 300.0..=2000.0;

/// A dispersion formula with its constants, λ in µm. The variants cover every formula of an AGF catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formula {
    /// n² = A + D λ² + Σ B λ²/(λ² - C): Sellmeier's formula with up to five terms.
    Sellmeier {
        /// A and D.
        rest: [f64; 2],
        /// B1 … B5.
        b: [f64; 5],
        /// C1 … C5, µm².
        c: [f64; 5],
    },
    /// n² = Σ `A_p` λ^p over the even powers p from [`LOWEST_POWER`] to [`HIGHEST_POWER`]: Schott's formula of 1966 and
    /// its extensions.
    Polynomial([f64; 10]),
    /// n = A + B/λ + C/λ^3.5 (A. E. Conrady, *Applied Optics and Optical Design*).
    Conrady([f64; 3]),
    /// n = A + B L + C L² + D λ² + E λ⁴ + F λ⁶ with L = 1/(λ² - 0.028) (M. Herzberger, *Optica Acta* 6, 1959).
    Herzberger([f64; 6]),
}

/// The resonance in the L of Herzberger's formula, µm². It lies near the ultraviolet resonance of most glasses.
pub const HERZBERGER: f64 = 0.028;

/// The lowest power of [`Formula::Polynomial`], which belongs to its first constant.
pub const LOWEST_POWER: i32 = -12;
/// The highest power of [`Formula::Polynomial`], which belongs to its last constant.
pub const HIGHEST_POWER: i32 = 6;

impl Formula {
    /// Returns the index at `wavelength` µm; NaN if n² is negative.
    pub fn index(&self, wavelength: f64) -> f64 {
        let square = wavelength * wavelength;
        match self {
            Self::Sellmeier { rest: [constant, slope], b, c } => {
                let terms: f64 = b.iter().zip(c).map(|(b, c)| b * square / (square - c)).sum();
                (constant + slope * square + terms).sqrt()
            }
            Self::Polynomial(constants) => {
                let sum = constants.iter().rev().fold(0.0, |sum, constant| sum * square + constant);
                // Horner's rule factors out the lowest power, which is even and negative.
                (sum * square.powi(LOWEST_POWER / 2)).sqrt()
            }
            Self::Conrady([a, b, c]) => a + b / wavelength + c / wavelength.powf(3.5),
            Self::Herzberger([a, b, c, d, e, f]) => {
                let l = (square - HERZBERGER).recip();
                a + l * (b + l * c) + square * (d + square * (e + square * f))
            }
        }
    }
}
