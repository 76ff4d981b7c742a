//! Numbers of 106 bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use realistic_optics::trace::Real;
use twofloat::TwoFloat;

/// A number of 106 bits: the unevaluated sum of two doubles (T. J. Dekker, "A floating-point technique
/// for extending the available precision", 1971).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct DoubleDouble(TwoFloat);

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for DoubleDouble {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}

operator!(Add add, Sub sub, Mul mul);

impl Div for DoubleDouble {
    type Output = Self;
    /// Long division in three digits of a double each. The division of twofloat computes the remainder
    /// without a fused multiply-add, so its quotients are only as accurate as a double.
    fn div(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let first = a.hi() / b.hi();
        if first == 0.0 || !first.is_finite() {
            return Self(TwoFloat::from(first));
        }
        let rest = a - b * first;
        let second = rest.hi() / b.hi();
        let third = (rest - b * second).hi() / b.hi();
        Self(TwoFloat::new_add(first, second) + third)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for DoubleDouble {
    const ZERO: Self = Self(TwoFloat::from_f64(0.0));
    const ONE: Self = Self(TwoFloat::from_f64(1.0));
    /// 2^-104: a few units in the last place of the type's operations.
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;

    fn from_f64(number: f64) -> Self {
        Self(TwoFloat::from(number))
    }

    fn to_f64(self) -> f64 {
        self.0.hi()
    }

    fn sqrt(self) -> Self {
        let root = self.0.hi().sqrt();
        if !(root > 0.0 && root.is_finite()) {
            return Self(TwoFloat::from(root));
        }
        // One step of Newton's iteration doubles the number of correct digits.
        Self((self.0 - TwoFloat::new_mul(root, root)) / (2.0 * root) + root)
    }
}
