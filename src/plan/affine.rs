//! Numbers that are known to lie somewhere: affine arithmetic over a box.
//!
//! A quantity that depends on the box's three coordinates, each scaled to [-1, 1], is kept as its linear part and a
//! bound of all the rest: x = mid + Σ slope_i ε_i + error, |error| <= `rest`. What two quantities
//! share then cancels where intervals would count it twice (L. H. de Figueiredo and J. Stolfi, "Affine Arithmetic:
//! Concepts and Applications", *Numerical Algorithms* 37, 2004; square root and reciprocal by their Chebyshev
//! approximations there, §4). Every operation adds more than its own rounding to the rest.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::numeric::Real;

/// Coordinates of a box.
pub const AXES: usize = 3;

/// A quantity over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// At the box's centre, but for the rest.
    pub mid: f64,
    /// By each coordinate.
    pub slopes: [f64; AXES],
    /// Bound of everything that is not linear.
    pub rest: f64,
}

/// Added to the rest by each operation, relative to the numbers in it: several times their rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl Affine {
    const ALL: Self = Self { mid: 0.0, slopes: [0.0; AXES], rest: f64::INFINITY };

    /// The coordinate numbered `axis` of a box, between two numbers.
    pub fn coordinate(axis: usize, [from, to]: [f64; 2]) -> Self {
        let mut slopes = [0.0; AXES];
        slopes[axis] = (to - from) / 2.0;
        Self { mid: f64::midpoint(from, to), slopes, rest: 0.0 }.rounded()
    }

    /// Something between two numbers.
    pub fn between([from, to]: [f64; 2]) -> Self {
        Self { mid: f64::midpoint(from, to), slopes: [0.0; AXES], rest: (to - from).abs() / 2.0 }.rounded()
    }

    fn radius(&self) -> f64 {
        self.slopes.iter().fold(self.rest, |sum, slope| sum + slope.abs())
    }

    /// The least and the greatest that it can be.
    pub fn range(&self) -> [f64; 2] {
        let radius = self.radius() * (1.0 + ROUNDING);
        [self.mid - radius, self.mid + radius]
    }

    fn rounded(mut self) -> Self {
        self.rest += ROUNDING * (self.mid.abs() + self.radius()) + f64::MIN_POSITIVE;
        self
    }

    /// `slope` times this plus `offset`, within `rest` of it.
    fn linear(self, slope: f64, offset: f64, rest: f64) -> Self {
        Self {
            mid: slope * self.mid + offset,
            slopes: self.slopes.map(|x| slope * x),
            rest: slope.abs() * self.rest + rest + ROUNDING * offset.abs(),
        }
        .rounded()
    }

    fn reciprocal(self) -> Self {
        let [low, high] = self.range();
        if high < 0.0 {
            return -(-self).reciprocal();
        }
        if !(low > 0.0 && high.is_finite()) {
            return Self::ALL;
        }
        let (ends, middle) = (1.0 / low + 1.0 / high, 2.0 / (low * high).sqrt());
        self.linear(-1.0 / (low * high), (ends + middle) / 2.0, (ends - middle) / 2.0)
    }
}

impl Add for Affine {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            mid: self.mid + other.mid,
            slopes: std::array::from_fn(|i| self.slopes[i] + other.slopes[i]),
            rest: self.rest + other.rest + ROUNDING * (self.mid.abs() + other.mid.abs()),
        }
        .rounded()
    }
}

impl Sub for Affine {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Affine {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mid: -self.mid, slopes: self.slopes.map(|x| -x), rest: self.rest }
    }
}

impl Mul for Affine {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.radius(), other.radius());
        Self {
            mid: self.mid * other.mid,
            slopes: std::array::from_fn(|i| self.mid * other.slopes[i] + other.mid * self.slopes[i]),
            rest: self.mid.abs() * other.rest + other.mid.abs() * self.rest + a * b,
        }
        .rounded()
    }
}

impl Div for Affine {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl)] // The reciprocal is what has a bound.
    fn div(self, other: Self) -> Self {
        self * other.reciprocal()
    }
}

impl PartialOrd for Affine {
    /// `None` where it depends on the place in the box.
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let [low, high] = (*self - *other).range();
        if low > 0.0 {
            Some(Ordering::Greater)
        } else if high < 0.0 {
            Some(Ordering::Less)
        } else {
            None
        }
    }
}

impl Real for Affine {
    const ZERO: Self = Self { mid: 0.0, slopes: [0.0; AXES], rest: 0.0 };
    const ONE: Self = Self { mid: 1.0, ..Self::ZERO };
    const EPSILON: f64 = f64::EPSILON;

    fn from_f64(number: f64) -> Self {
        Self { mid: number, ..Self::ZERO }
    }

    fn to_f64(self) -> f64 {
        self.mid
    }

    const IS_RANGE: bool = true;

    fn magnitude(self) -> f64 {
        let [low, high] = self.range();
        high.max(-low)
    }

    fn estimate(self) -> Self {
        Self { rest: 0.0, ..self }
    }

    fn within(self, rest: f64) -> Self {
        Self { rest: self.rest + rest, ..self }.rounded()
    }

    fn sqrt(self) -> Self {
        let [low, high] = self.range();
        if !(low > 0.0 && high.is_finite()) {
            return Self::ALL;
        }
        let (a, b) = (low.sqrt(), high.sqrt());
        let (ends, middle) = (a * b / (a + b), (a + b) / 4.0);
        self.linear(1.0 / (a + b), (ends + middle) / 2.0, (middle - ends) / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Holds an expression to its value all over a box.
    fn holds(bounds: [[f64; 2]; 3], affine: fn([Affine; 3]) -> Affine, plain: fn([f64; 3]) -> f64) {
        let coordinates = std::array::from_fn(|axis| Affine::coordinate(axis, bounds[axis]));
        let result = affine(coordinates);
        for i in 0..=10 {
            for j in 0..=10 {
                for k in 0..=10 {
                    let place = [i, j, k].map(|n| f64::from(n) / 10.0);
                    let at = std::array::from_fn(|axis| {
                        bounds[axis][0] + place[axis] * (bounds[axis][1] - bounds[axis][0])
                    });
                    let linear: f64 = (0..3).map(|a| result.slopes[a] * (2.0 * place[a] - 1.0)).sum();
                    let off = (plain(at) - result.mid - linear).abs();
                    assert!(off <= result.rest, "{at:?}: {off} is more than {}", result.rest);
                }
            }
        }
    }

    #[test]
    fn every_value_over_the_box_lies_inside_the_bounds() {
        let bounds = [[0.5, 2.0], [-1.0, 3.0], [4.0, 4.5]];
        holds(bounds, |[x, y, z]| x * y - z, |[x, y, z]| x * y - z);
        holds(bounds, |[x, y, z]| y / x + z, |[x, y, z]| y / x + z);
        holds(bounds, |[x, _, z]| (x * z).sqrt() / -z, |[x, _, z]| (x * z).sqrt() / -z);
    }

    #[test]
    fn what_two_quantities_share_cancels() {
        let x = Affine::coordinate(0, [1.0, 2.0]);
        let [low, high] = (x - x).range();
        assert!(low > -1e-13 && high < 1e-13);
    }

    #[test]
    fn a_comparison_is_decided_only_where_it_holds_all_over_the_box() {
        let x = Affine::coordinate(0, [1.0, 2.0]);
        let constant = Affine::from_f64;
        assert!(x > constant(0.9) && x < constant(2.1));
        assert!(!(x > constant(1.5)) && !(x < constant(1.5)));
        assert!(!((x - constant(1.5)).sqrt() > constant(-1e9)), "no root of what may be negative");
        assert!(!(constant(1.0) / (x - constant(1.5)) < constant(1e9)));
    }
}
