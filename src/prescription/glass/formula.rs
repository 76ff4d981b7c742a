//! The dispersion formulas of glass catalogues beside Sellmeier's three terms: a wavelength in µm in, an index out. And the
//! wavelengths, nm, at which catalogues state indices and at which glasses are evaluated.

use std::ops::RangeInclusive;

/// Wavelength of the helium d line, nm, with the digits that parameters and most files have: the default.
pub const D_LINE: f64 = 587.56;
/// The wavelengths, nm, that mean the d line: from [`D_LINE`] to the line's own, 587.5618.
pub const D_LINES: RangeInclusive<f64> = D_LINE..=587.5618;
/// Wavelength of the hydrogen F line, nm.
pub const F_LINE: f64 = 486.13;
/// Wavelength of the hydrogen C line, nm.
pub const C_LINE: f64 = 656.27;

/// The wavelengths, nm, at which lenses are traced: those at which any glass has an index here.
pub const VALID_WAVELENGTHS: RangeInclusive<f64> = 200.0..=2000.0;

/// The wavelengths, nm, at which a glass of which no range is known is used, and up to which the range of another may be
/// exceeded with a warning. Below, glasses absorb, and formulas go astray.
pub const ORDINARY_WAVELENGTHS: RangeInclusive<f64> = 300.0..=2000.0;

/// A dispersion formula with its constants, λ in µm. All the formulas of an AGF catalogue are among these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formula {
    /// n² = A + D λ² + Σ B λ²/(λ² - C): Sellmeier's with up to five terms.
    Sellmeier {
        /// A and D.
        rest: [f64; 2],
        /// B1 … B5.
        b: [f64; 5],
        /// C1 … C5, µm².
        c: [f64; 5],
    },
    /// n² = Σ `A_p` λ^p over the even powers p from [`LOWEST_POWER`] to [`HIGHEST_POWER`]: Schott's formula of 1966 and its
    /// extensions.
    Polynomial([f64; 10]),
    /// n = A + B/λ + C/λ^3.5 (A. E. Conrady, *Applied Optics and Optical Design*).
    Conrady([f64; 3]),
    /// n = A + B L + C L² + D λ² + E λ⁴ + F λ⁶ with L = 1/(λ² - 0.028) (M. Herzberger, *Optica Acta* 6, 1959).
    Herzberger([f64; 6]),
}

/// The resonance, µm², in Herzberger's L: that of most glasses in the ultraviolet, about.
pub const HERZBERGER: f64 = 0.028;

/// The lowest power of [`Formula::Polynomial`], that of its first constant.
pub const LOWEST_POWER: i32 = -12;
/// The highest power of [`Formula::Polynomial`], that of its last constant.
pub const HIGHEST_POWER: i32 = 6;

impl Formula {
    /// The index at `wavelength` µm; not a number where the formula has no root.
    pub fn index(&self, wavelength: f64) -> f64 {
        let square = wavelength * wavelength;
        match self {
            Self::Sellmeier { rest: [constant, slope], b, c } => {
                let terms: f64 = b.iter().zip(c).map(|(b, c)| b * square / (square - c)).sum();
                (constant + slope * square + terms).sqrt()
            }
            Self::Polynomial(constants) => {
                let sum = constants.iter().rev().fold(0.0, |sum, constant| sum * square + constant);
                // Horner's rule leaves out the lowest power, even and below 0.
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
