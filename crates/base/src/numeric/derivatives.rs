//! Numbers that carry derivatives, and intervals (A. Griewank and A. Walther, *Evaluating Derivatives*, on the forward
//! mode; R. E. Moore, *Interval Analysis*). A formula is written once, over [`Arithmetic`], and gives values, gradients,
//! or bounds of second derivatives over a region.

use std::ops::{Add, Div, Mul, Sub};

use super::Real;

/// Numbers with the four operations, among themselves and with constants, and the square root.
pub trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The type of constants, whose derivatives are 0.
    type Constant: Copy;
    /// Returns the square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Returns the square.
    #[must_use]
    fn squared(self) -> Self;
    /// Returns this number times `factor`.
    #[must_use]
    fn times(self, factor: Self::Constant) -> Self;
    /// Returns this number plus `term`.
    #[must_use]
    fn plus(self, term: Self::Constant) -> Self;
    /// Returns `minuend` minus this number.
    #[must_use]
    fn taken_from(self, minuend: Self::Constant) -> Self;
    /// Returns `dividend` divided by this number.
    #[must_use]
    fn dividing(self, dividend: Self::Constant) -> Self;
}

impl<R: Real> Arithmetic for R {
    type Constant = R;
    fn sqrt(self) -> Self {
        Real::sqrt(self)
    }
    fn squared(self) -> Self {
        self * self
    }
    fn times(self, factor: R) -> Self {
        self * factor
    }
    fn plus(self, term: R) -> Self {
        self + term
    }
    fn taken_from(self, minuend: R) -> Self {
        minuend - self
    }
    fn dividing(self, dividend: R) -> Self {
        dividend / self
    }
}

/// Defines the operators of a type from expressions of the two operands.
macro_rules! operators {
    ($type:ident: $($trait:ident $method:ident |$a:ident, $b:ident| $result:expr;)*) => {$(
        impl<N: Arithmetic> $trait for $type<N> {
            type Output = Self;
            #[cfg_attr(not(debug_assertions), inline(always))]
            #[allow(clippy::suspicious_arithmetic_impl, reason = "derivatives of a product have sums")]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self, other);
                $result
            }
        }
    )*};
}

/// A number with its derivatives by x and y.
#[derive(Clone, Copy, Debug)]
pub struct Gradient<N> {
    /// The value.
    pub value: N,
    /// The derivative by x.
    pub x: N,
    /// The derivative by y.
    pub y: N,
}

operators! { Gradient:
    Add add |a, b| Self { value: a.value + b.value, x: a.x + b.x, y: a.y + b.y };
    Sub sub |a, b| Self { value: a.value - b.value, x: a.x - b.x, y: a.y - b.y };
    Mul mul |a, b| Self {
        value: a.value * b.value,
        x: a.x * b.value + a.value * b.x,
        y: a.y * b.value + a.value * b.y,
    };
    Div div |a, b| {
        let value = a.value / b.value;
        Self { value, x: (a.x - value * b.x) / b.value, y: (a.y - value * b.y) / b.value }
    };
}

impl<N: Arithmetic> Arithmetic for Gradient<N> {
    type Constant = N::Constant;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let twice = value + value;
        Self { value, x: self.x / twice, y: self.y / twice }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn squared(self) -> Self {
        let twice = self.value + self.value;
        Self { value: self.value.squared(), x: twice * self.x, y: twice * self.y }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn times(self, factor: N::Constant) -> Self {
        Self { value: self.value.times(factor), x: self.x.times(factor), y: self.y.times(factor) }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn plus(self, term: N::Constant) -> Self {
        Self { value: self.value.plus(term), ..self }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn taken_from(self, minuend: N::Constant) -> Self {
        let value = self.value.taken_from(minuend);
        Self { value, x: self.x - (self.x + self.x), y: self.y - (self.y + self.y) }
    }
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn dividing(self, dividend: N::Constant) -> Self {
        let value = self.value.dividing(dividend);
        let per = value / self.value;
        let (x, y) = (per * self.x, per * self.y);
        Self { value, x: x - (x + x), y: y - (y + y) }
    }
}

/// A number with its first and second derivatives by x and y.
#[derive(Clone, Copy, Debug)]
pub struct Hessian<N> {
    /// The value.
    pub value: N,
    /// The derivatives by x and y.
    pub first: [N; 2],
    /// The second derivatives: by x twice, by both, by y twice.
    pub second: [N; 3],
}

/// The components of the second derivatives.
const PAIRS: [[usize; 2]; 3] = [[0, 0], [0, 1], [1, 1]];

impl<N: Arithmetic> Hessian<N> {
    /// Returns g(self) for a function with the value and the first and second derivatives `g`.
    fn composed(self, [value, slope, bend]: [N; 3]) -> Self {
        let second = |i: usize| {
            let [a, b] = PAIRS[i];
            bend * self.first[a] * self.first[b] + slope * self.second[i]
        };
        Self {
            value,
            first: self.first.map(|first| slope * first),
            second: [second(0), second(1), second(2)],
        }
    }
}

operators! { Hessian:
    Add add |a, b| Self {
        value: a.value + b.value,
        first: std::array::from_fn(|i| a.first[i] + b.first[i]),
        second: std::array::from_fn(|i| a.second[i] + b.second[i]),
    };
    Sub sub |a, b| Self {
        value: a.value - b.value,
        first: std::array::from_fn(|i| a.first[i] - b.first[i]),
        second: std::array::from_fn(|i| a.second[i] - b.second[i]),
    };
    Mul mul |a, b| Self {
        value: a.value * b.value,
        first: std::array::from_fn(|i| a.first[i] * b.value + a.value * b.first[i]),
        second: std::array::from_fn(|i| {
            let [j, k] = PAIRS[i];
            a.second[i] * b.value + a.first[j] * b.first[k] + a.first[k] * b.first[j] + a.value * b.second[i]
        }),
    };
    Div div |a, b| {
        // By the product's rule for a = q b.
        let value = a.value / b.value;
        let first = [0, 1].map(|i: usize| (a.first[i] - value * b.first[i]) / b.value);
        let second = std::array::from_fn(|i| {
            let [j, k] = PAIRS[i];
            (a.second[i] - first[j] * b.first[k] - first[k] * b.first[j] - value * b.second[i]) / b.value
        });
        Self { value, first, second }
    };
}

impl<N: Arithmetic<Constant = f64>> Arithmetic for Hessian<N> {
    type Constant = f64;
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let slope = root.dividing(0.5);
        self.composed([root, slope, (slope / self.value).times(-0.5)])
    }
    fn squared(self) -> Self {
        let twice = self.value.times(2.0);
        self.composed([self.value.squared(), twice, self.value.times(0.0).plus(2.0)])
    }
    fn times(self, factor: f64) -> Self {
        Self {
            value: self.value.times(factor),
            first: self.first.map(|number| number.times(factor)),
            second: self.second.map(|number| number.times(factor)),
        }
    }
    fn plus(self, term: f64) -> Self {
        Self { value: self.value.plus(term), ..self }
    }
    fn taken_from(self, minuend: f64) -> Self {
        self.times(-1.0).plus(minuend)
    }
    fn dividing(self, dividend: f64) -> Self {
        let inverse = self.value.dividing(1.0);
        let square = inverse.squared();
        self.composed([inverse, square.times(-1.0), (square * inverse).times(2.0)]).times(dividend)
    }
}

/// An interval that contains a number. Operations widen it by their own rounding errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// Returns the interval with these ends, widened by rounding. NaN becomes an infinite end.
    fn around(ends: &[f64]) -> Self {
        let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if ends.iter().any(|end| end.is_nan()) {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        let margin = |end: f64| 2.0 * f64::EPSILON * end.abs() + f64::MIN_POSITIVE;
        Self { low: low - margin(low), high: high + margin(high) }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::around(&[self.low + other.low, self.high + other.high])
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::around(&[self.low - other.high, self.high - other.low])
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self::around(&[a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high])
    }
}

impl Div for Interval {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "a quotient is the product with the reciprocal")]
    fn div(self, other: Self) -> Self {
        self * other.dividing(1.0)
    }
}

impl Arithmetic for Interval {
    type Constant = f64;
    /// Returns the root; without bounds where the interval contains negative numbers.
    fn sqrt(self) -> Self {
        Self::around(&[self.low.sqrt(), self.high.sqrt()])
    }
    fn squared(self) -> Self {
        let [low, high] = [self.low * self.low, self.high * self.high];
        let contains_zero = self.low <= 0.0 && self.high >= 0.0;
        let Self { low, high } = Self::around(&[low, high]);
        Self { low: if contains_zero { 0.0 } else { low.max(0.0) }, high }
    }
    fn times(self, factor: f64) -> Self {
        Self::around(&[self.low * factor, self.high * factor])
    }
    fn plus(self, term: f64) -> Self {
        Self::around(&[self.low + term, self.high + term])
    }
    fn taken_from(self, minuend: f64) -> Self {
        Self::around(&[minuend - self.low, minuend - self.high])
    }
    fn dividing(self, dividend: f64) -> Self {
        if self.low <= 0.0 && self.high >= 0.0 {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        Self::around(&[dividend / self.low, dividend / self.high])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A formula with every operation.
    fn formula<N: Arithmetic<Constant = f64>>(x: N, y: N) -> N {
        let root = (x.squared().times(0.3) - (y * x).times(0.1)).taken_from(2.0).sqrt();
        (x + y.plus(3.0)) / root.plus(1.5) + y.plus(4.0).dividing(0.7)
    }

    fn value(x: f64, y: f64) -> f64 {
        formula(x, y)
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (x, y, h) = (0.7, -0.4, 1e-4);
        let gradient = {
            let number = |value, x, y| Gradient { value, x, y };
            formula(number(x, 1.0, 0.0), number(y, 0.0, 1.0))
        };
        let hessian = {
            let number = |value, first| Hessian { value, first, second: [0.0; 3] };
            formula(number(x, [1.0, 0.0]), number(y, [0.0, 1.0]))
        };
        let first = [
            (value(x + h, y) - value(x - h, y)) / (2.0 * h),
            (value(x, y + h) - value(x, y - h)) / (2.0 * h),
        ];
        let middle = value(x, y);
        let second = [
            (value(x + h, y) - 2.0 * middle + value(x - h, y)) / (h * h),
            (value(x + h, y + h) - value(x + h, y - h) - value(x - h, y + h) + value(x - h, y - h))
                / (4.0 * h * h),
            (value(x, y + h) - 2.0 * middle + value(x, y - h)) / (h * h),
        ];
        assert_eq!((gradient.value, hessian.value), (middle, middle));
        for (own, expected) in
            [gradient.x, gradient.y].iter().chain(&hessian.first).zip([first, first].concat())
        {
            assert!((own - expected).abs() < 1e-7, "{own} {expected}");
        }
        for (own, expected) in hessian.second.iter().zip(second) {
            assert!((own - expected).abs() < 1e-6, "{own} {expected}");
        }
    }

    #[test]
    fn intervals_contain_every_value_between_their_ends() {
        let [across, along] = [Interval { low: -0.5, high: 0.8 }, Interval { low: -0.9, high: 0.2 }];
        let bounds = formula(across, along);
        for i in 0..=50 {
            for j in 0..=50 {
                let at = |interval: Interval, i: u32| {
                    interval.low + (interval.high - interval.low) * f64::from(i) / 50.0
                };
                let inside = value(at(across, i), at(along, j));
                assert!(bounds.low <= inside && inside <= bounds.high, "{inside} {bounds:?}");
            }
        }
        let unbounded = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
        assert_eq!(Interval { low: -1.0, high: 1.0 }.sqrt(), unbounded);
        assert_eq!(Interval { low: 0.0, high: 1.0 }.dividing(1.0), unbounded);
    }
}
