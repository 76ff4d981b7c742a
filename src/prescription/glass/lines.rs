//! The spectral lines at which catalogues state indices, and the wavelengths, nm, at which glasses are asked for theirs.

/// Wavelength of the helium d line, nm, at which n_d is given.
pub const D_LINE: f64 = 587.56;
/// Wavelength of the hydrogen F line, nm.
pub const F_LINE: f64 = 486.13;
/// Wavelength of the hydrogen C line, nm.
pub const C_LINE: f64 = 656.27;

/// The wavelengths, nm, at which the formulas are used.
pub const VALID_WAVELENGTHS: std::ops::RangeInclusive<f64> = 300.0..=2000.0;
