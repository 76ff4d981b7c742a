//! The numbers that rays are traced in: one trait over f64 and f32, which the laboratory extends to wider ones.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number type: `f64`, `f32`, and whatever else a test or report wants to trace with.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The distance from 1 to the next larger number, in double precision.
    const EPSILON: f64;
    /// The nearest number of this type.
    fn from_f64(number: f64) -> Self;
    /// The nearest double.
    fn to_f64(self) -> f64;
    /// The square root, NaN below 0.
    #[must_use]
    fn sqrt(self) -> Self;
}

macro_rules! real {
    ($($float:ident),*) => {$(
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: f64 = $float::EPSILON as f64;
            #[allow(clippy::cast_possible_truncation)]
            fn from_f64(number: f64) -> Self {
                number as $float
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
        }
    )*};
}

real!(f64, f32);
