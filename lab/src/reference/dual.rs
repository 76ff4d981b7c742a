//! Dual numbers, which carry their derivatives and give exact Jacobians.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use realistic_optics::trace::Real;

/// Number of coordinates of a ray: three of the point, three of the direction.
pub(crate) const N: usize = 6;

/// A number with its derivatives with respect to the ray's six coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual {
    pub value: f64,
    pub slopes: [f64; N],
}

impl Dual {
    fn chained(self, value: f64, own: f64, other: Self, others: f64) -> Self {
        Self { value, slopes: std::array::from_fn(|i| own * self.slopes[i] + others * other.slopes[i]) }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.chained(self.value + other.value, 1.0, other, 1.0)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.chained(self.value - other.value, 1.0, other, -1.0)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.chained(self.value * other.value, other.value, other, self.value)
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.chained(quotient, other.value.recip(), other, -quotient / other.value)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slopes: self.slopes.map(|slope| -slope) }
    }
}

impl PartialEq for Dual {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialOrd for Dual {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl Real for Dual {
    const ZERO: Self = Self { value: 0.0, slopes: [0.0; N] };
    const ONE: Self = Self { value: 1.0, slopes: [0.0; N] };
    const EPSILON: f64 = f64::EPSILON;

    fn from_f64(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }

    fn to_f64(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self { value: root, slopes: self.slopes.map(|slope| slope / (2.0 * root)) }
    }
}
