//! Complex numbers.

use std::ops::{Add, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct C(pub f64, pub f64);

impl Add for C {
    type Output = C;
    fn add(self, b: C) -> C {
        C(self.0 + b.0, self.1 + b.1)
    }
}

impl Sub for C {
    type Output = C;
    fn sub(self, b: C) -> C {
        C(self.0 - b.0, self.1 - b.1)
    }
}

impl Mul for C {
    type Output = C;
    fn mul(self, b: C) -> C {
        C(self.0 * b.0 - self.1 * b.1, self.0 * b.1 + self.1 * b.0)
    }
}

impl C {
    /// Returns the squared modulus.
    pub fn square(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }

    /// Divides by another number.
    pub fn over(self, b: C) -> C {
        let square = b.square();
        self * C(b.0 / square, -b.1 / square)
    }

    /// Returns the exponential of i times the number.
    pub fn turned(self) -> C {
        let size = (-self.1).exp();
        C(size * self.0.cos(), size * self.0.sin())
    }

    /// Returns the square root of a real number: positive, or on the positive imaginary axis.
    pub fn root(square: f64) -> C {
        if square >= 0.0 { C(square.sqrt(), 0.0) } else { C(0.0, (-square).sqrt()) }
    }
}
