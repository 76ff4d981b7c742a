//! One trait for the number types of ray tracing: f64, f32, and the wider types of the laboratory. Also vectors of
//! three components, with products and lengths that keep digits which a plain expression would lose.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number type: `f64`, `f32`, and any other type with which a test or report traces rays.
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
    /// Returns the number of this type that is nearest to `number`.
    fn from_f64(number: f64) -> Self;
    /// Returns the nearest double-precision number.
    fn to_f64(self) -> f64;
    /// Returns the square root; NaN for a negative number.
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

/// Returns the dot product.
#[inline]
pub fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the cross product, each component within 1.5 ulp (see [`difference_of_products`]).
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        difference_of_products(a[j], b[k], a[k], b[j])
    })
}

/// Returns a b - c d within 1.5 ulp, by Kahan's algorithm (C.-P. Jeannerod, N. Louvet and J.-M. Muller, "Further
/// analysis of Kahan's algorithm for the accurate computation of 2 x 2 determinants", 2013).
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let error = c.mul_add(-d, product);
    a.mul_add(b, -product) + error
}

/// Scales a very long or very short vector by a power of two, so that products of its components with lengths neither
/// overflow nor underflow.
pub fn in_range(v: [f64; 3]) -> [f64; 3] {
    const FAR_OUT: f64 = f64::from_bits((1023 + 400) << 52);
    const BACK: f64 = f64::from_bits((1023 + 600) << 52);
    let largest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest > FAR_OUT {
        v.map(|x| x / BACK)
    } else if largest < FAR_OUT.recip() {
        v.map(|x| x * BACK)
    } else {
        v
    }
}

/// Returns the unit vector along `v`, whatever the size of its components; NaN for a vector of length 0.
pub fn unit(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Scaling first keeps the squares of very small or large components in range.
    let scaled = v.map(|x| x / largest);
    let norm = dot(scaled, scaled).sqrt();
    scaled.map(|x| x / norm)
}
