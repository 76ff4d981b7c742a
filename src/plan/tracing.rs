//! How rays are taken through a lens: the one decision of a plan.
//!
//! A [`Tracing`] is named here, chosen by the plan, and matched once, where a camera compiles what traces its rays.

use std::fmt;

use crate::lens::refraction::Refraction;

/// What rays are computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double precision.
    F64,
    /// Single precision.
    F32,
}

impl Precision {
    /// What may be asked for, by name; `None` leaves the precision to the plan. A precision is written by its first name.
    pub const NAMES: [(&'static str, Option<Self>); 5] = [
        ("auto", None),
        ("f64", Some(Self::F64)),
        ("f32", Some(Self::F32)),
        ("double", Some(Self::F64)),
        ("single", Some(Self::F32)),
    ];
}

/// How rays are asked for: the call, not their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// By a call for one ray, or for one and its differentials.
    One,
    /// By a call for many.
    Many,
}

impl Entry {
    /// Each of them.
    pub const ALL: [Self; 2] = [Self::One, Self::Many];
}

/// In the words of a plan.
impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::One => "one by one",
            Self::Many => "in batches",
        })
    }
}

/// A way to take rays through a lens. `Fit` is what polynomials are once they are fitted; a candidate has none yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tracing<Fit = ()> {
    /// Every surface, by the compiled kernel.
    Exact(Precision),
    /// The whole lens by polynomials.
    Polynomials {
        /// Their order: odd; of order 1, the thick lens.
        order: usize,
        /// What they are evaluated in.
        precision: Precision,
        /// Their coefficients.
        fit: Fit,
    },
    /// Surface after surface by a named method of refraction, one ray at a time.
    Refracted(Refraction, Precision),
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let own = Self::NAMES.iter().find(|(_, precision)| *precision == Some(*self));
        f.pad(own.map_or("", |(name, _)| name))
    }
}

/// Its name, as reports have it.
impl<Fit> fmt::Display for Tracing<Fit> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Exact(precision) => format!("exact, {precision}"),
            Self::Polynomials { order: 1, precision, .. } => format!("thick lens, {precision}"),
            Self::Polynomials { order, precision, .. } => {
                format!("polynomials of order {order}, {precision}")
            }
            Self::Refracted(refraction, precision) => format!("{refraction:?}, {precision}"),
        };
        f.pad(&name)
    }
}
