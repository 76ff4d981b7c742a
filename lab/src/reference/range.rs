//! Intervals of numbers, and intervals with the derivative along a ray.

use super::form::Number;

/// A closed interval of numbers.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub low: f64,
    pub high: f64,
}

/// An interval of values of a function of the distance along a ray, and that of its derivative.
#[derive(Clone, Copy)]
pub(super) struct Slope {
    pub value: Range,
    pub slope: Range,
}

/// Margin for rounding, relative to the operands of a sum.
pub(super) const ROUNDING: f64 = 256.0 * f64::EPSILON;

impl Range {
    /// Returns the interval between two numbers in either order, widened by the rounding margin; all numbers if one of
    /// them is NaN.
    pub fn of([a, b]: [f64; 2]) -> Self {
        if a.is_nan() || b.is_nan() {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let widened = |x: f64, side: f64| if x.is_finite() { x + side * ROUNDING * x.abs() } else { x };
        Self { low: widened(a.min(b), -1.0), high: widened(a.max(b), 1.0) }
    }

    pub fn about(middle: f64, half: f64) -> Self {
        Self::of([middle - half, middle + half])
    }

    /// Returns the square roots of the numbers that have one.
    fn root(self) -> Self {
        Self::of([self.low, self.high].map(|end| end.max(0.0).sqrt()))
    }
}

impl std::ops::Add for Range {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::of([self.low + other.low, self.high + other.high])
    }
}

impl std::ops::Sub for Range {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::of([self.low - other.high, self.high - other.low])
    }
}

impl std::ops::Mul for Range {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let products = [self.low, self.high].map(|a| [a * other.low, a * other.high]);
        let all = products.iter().flatten();
        // 0 times infinity, at the conic's end, gives no bound.
        if all.clone().any(|product| product.is_nan()) {
            return Self::of([f64::NAN; 2]);
        }
        let low = all.clone().fold(f64::INFINITY, |least, product| least.min(*product));
        let high = all.fold(f64::NEG_INFINITY, |most, product| most.max(*product));
        Self::of([low, high])
    }
}

impl std::ops::Div for Range {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.low <= 0.0 && other.high >= 0.0 {
            return Self::of([f64::NAN; 2]);
        }
        self * Self::of([other.low.recip(), other.high.recip()])
    }
}

impl std::ops::Add for Slope {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl std::ops::Sub for Slope {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl std::ops::Mul for Slope {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        Self { value: self.value * other.value, slope }
    }
}

impl std::ops::Div for Slope {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl Number for Slope {
    fn constant(number: f64) -> Self {
        Self { value: Range::of([number; 2]), slope: Range::of([0.0; 2]) }
    }

    fn root(self) -> Self {
        let value = self.value.root();
        Self { value, slope: self.slope / (value + value) }
    }
}
