//! How rays are taken through a lens: the one decision of a plan.
//!
//! A [`Tracing`] is named here, chosen by the plan, and matched once, where a camera compiles what traces its rays.

use std::fmt;

use crate::lens::refraction::Refraction;

/// What rays are computed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Double precision.
    F64,
    /// Single precision.
    F32,
}

/// A way to take rays through a lens. `Fit` is what polynomials are once they are fitted; a candidate has none yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tracing<Fit = ()> {
    /// Every surface, by the compiled kernel.
    Exact(Arithmetic),
    /// The whole lens by polynomials.
    Polynomials {
        /// Their order: odd; of order 1, the thick lens.
        order: usize,
        /// What they are evaluated in.
        arithmetic: Arithmetic,
        /// Their coefficients.
        fit: Fit,
    },
    /// Surface after surface by a named method of refraction, one ray at a time.
    Refracted(Refraction, Arithmetic),
}

impl<Fit> Tracing<Fit> {
    /// Whether rays traced side by side take less time than one after the other.
    pub(crate) fn gains_side_by_side(&self) -> bool {
        !matches!(self, Self::Refracted(..))
    }
}

impl fmt::Display for Arithmetic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        })
    }
}

/// Its name, as reports have it.
impl<Fit> fmt::Display for Tracing<Fit> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Exact(arithmetic) => format!("exact, {arithmetic}"),
            Self::Polynomials { order: 1, arithmetic, .. } => format!("thick lens, {arithmetic}"),
            Self::Polynomials { order, arithmetic, .. } => {
                format!("polynomials of order {order}, {arithmetic}")
            }
            Self::Refracted(refraction, arithmetic) => format!("{refraction:?}, {arithmetic}"),
        };
        f.pad(&name)
    }
}
