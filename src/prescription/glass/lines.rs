//! The spectral lines at which catalogues state indices, and the wavelengths, nm, at which glasses are asked for theirs.

use std::ops::RangeInclusive;

/// Wavelength of the helium d line, nm, at which n_d is given.
pub const D_LINE: f64 = 587.56;
/// Wavelength of the hydrogen F line, nm.
pub const F_LINE: f64 = 486.13;
/// Wavelength of the hydrogen C line, nm.
pub const C_LINE: f64 = 656.27;

/// The wavelengths, nm, at which lenses are traced: those at which any glass has an index here.
pub const VALID_WAVELENGTHS: RangeInclusive<f64> = 200.0..=2000.0;

/// The wavelengths, nm, at which a glass of which no range is known is used, and up to which the range of another may be
/// exceeded with a warning. Below, glasses absorb, and formulas go astray.
pub const ORDINARY_WAVELENGTHS: RangeInclusive<f64> = 300.0..=2000.0;
