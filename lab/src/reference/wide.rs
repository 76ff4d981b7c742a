//! Floating-point numbers of 256 bits, 77 decimal digits.

use std::{
    cmp::Ordering,
    ops::{Add, Div, Mul, Neg, Sub},
};

use realistic_optics::trace::Real;

/// Number of 64-bit digits of a mantissa.
const DIGITS: usize = 4;
/// Bits of a mantissa.
const BITS: i64 = 64 * DIGITS as i64;

/// A number of 256 bits. Operations cut off what lies beyond their last bit. There is no infinity: what has no value is
/// NaN.
#[derive(Clone, Copy, Debug)]
pub struct Wide {
    is_negative: bool,
    /// The number is its mantissa, at least 1/2 and below 1, times 2 to this power; [`NAN`] for NaN.
    exponent: i64,
    /// The mantissa as an integer, least digit first: its highest bit is 1, or it is the number 0.
    mantissa: [u64; DIGITS],
}

const NAN: i64 = i64::MAX;

impl Wide {
    const NOT_A_NUMBER: Self = Self { is_negative: false, exponent: NAN, mantissa: [0; DIGITS] };

    /// Builds the number of a mantissa, least digit first and of more digits than a number has, times 2 to the power
    /// `exponent`.
    fn of(is_negative: bool, exponent: i64, mut mantissa: [u64; 2 * DIGITS]) -> Self {
        let Some(first) = mantissa.iter().rposition(|digit| *digit != 0) else { return Self::ZERO };
        let shift = 64 * (2 * DIGITS - 1 - first) + mantissa[first].leading_zeros() as usize;
        shift_up(&mut mantissa, shift);
        let mantissa = std::array::from_fn(|i| mantissa[DIGITS + i]);
        Self { is_negative, exponent: exponent - shift as i64, mantissa }
    }

    fn is_zero(self) -> bool {
        self.mantissa == [0; DIGITS] && self.exponent != NAN
    }

    fn is_nan(self) -> bool {
        self.exponent == NAN
    }

    /// Returns the number times 2 to the power `power`.
    fn scaled(self, power: i64) -> Self {
        if self.is_zero() || self.is_nan() { self } else { Self { exponent: self.exponent + power, ..self } }
    }

    /// Compares the magnitudes of two numbers that are not NaN.
    fn compare_magnitudes(self, other: Self) -> Ordering {
        match (self.is_zero(), other.is_zero()) {
            (true, true) => Ordering::Equal,
            (true, false) => Ordering::Less,
            (false, true) => Ordering::Greater,
            (false, false) => {
                let digits = |number: Self| number.mantissa.into_iter().rev();
                self.exponent.cmp(&other.exponent).then_with(|| digits(self).cmp(digits(other)))
            }
        }
    }
}

/// Multiplies a mantissa by 2 to the power `by`, which loses no bits.
fn shift_up(mantissa: &mut [u64; 2 * DIGITS], by: usize) {
    let (digits, bits) = (by / 64, by % 64);
    for i in (0..2 * DIGITS).rev() {
        let digit = |below: usize| i.checked_sub(digits + below).map_or(0, |at| mantissa[at]);
        mantissa[i] = if bits == 0 { digit(0) } else { digit(0) << bits | digit(1) >> (64 - bits) };
    }
}

/// Returns a mantissa in the upper half of twice as many digits, divided by 2 to the power `by`.
fn shifted_down(mantissa: [u64; DIGITS], by: usize) -> [u64; 2 * DIGITS] {
    let (digits, bits) = (by / 64, by % 64);
    let digit = |at: usize| match at.checked_sub(DIGITS) {
        Some(at) if at < DIGITS => mantissa[at],
        _ => 0,
    };
    std::array::from_fn(|i| {
        let at = i + digits;
        if bits == 0 { digit(at) } else { digit(at) >> bits | digit(at + 1) << (64 - bits) }
    })
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is_nan() || other.is_nan() {
            return Self::NOT_A_NUMBER;
        }
        let (large, small) =
            if self.compare_magnitudes(other).is_lt() { (other, self) } else { (self, other) };
        let apart = large.exponent - small.exponent;
        // Beyond that, the smaller number changes no bit that is kept.
        if small.is_zero() || apart > 2 * BITS - 2 {
            return large;
        }
        // One bit stays free for the carry.
        let a = shifted_down(large.mantissa, 1);
        let b = shifted_down(small.mantissa, 1 + apart as usize);
        let mut sum = [0; 2 * DIGITS];
        let mut carry = false;
        let is_sum = large.is_negative == small.is_negative;
        let step = if is_sum { u64::overflowing_add } else { u64::overflowing_sub };
        for (i, digit) in sum.iter_mut().enumerate() {
            let (part, first) = step(a[i], b[i]);
            let (part, second) = step(part, u64::from(carry));
            (*digit, carry) = (part, first || second);
        }
        Self::of(large.is_negative, large.exponent + 1, sum)
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { is_negative: !self.is_negative, ..self }
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_nan() || other.is_nan() {
            return Self::NOT_A_NUMBER;
        }
        let mut product = [0; 2 * DIGITS];
        for (i, a) in self.mantissa.into_iter().enumerate() {
            let mut carry = 0;
            for (j, b) in other.mantissa.into_iter().enumerate() {
                let sum = u128::from(a) * u128::from(b) + u128::from(product[i + j]) + carry;
                product[i + j] = sum as u64;
                carry = sum >> 64;
            }
            product[i + DIGITS] = carry as u64;
        }
        Self::of(self.is_negative != other.is_negative, self.exponent + other.exponent, product)
    }
}

/// Steps of Newton's iteration, each of which doubles the number of correct bits, from the 53 of a double.
const NEWTON_STEPS: usize = 3;

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if self.is_nan() || other.is_nan() || other.is_zero() {
            return Self::NOT_A_NUMBER;
        }
        let divisor = Self { exponent: 0, ..other };
        let mut reciprocal = Self::from_f64(divisor.to_f64().recip());
        for _ in 0..NEWTON_STEPS {
            reciprocal = reciprocal + reciprocal * (Self::ONE - divisor * reciprocal);
        }
        let quotient = self * reciprocal;
        (quotient + reciprocal * (self - divisor * quotient)).scaled(-other.exponent)
    }
}

impl PartialEq for Wide {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        if self.is_nan() || other.is_nan() {
            return None;
        }
        let sign = |number: &Self| match number {
            zero if zero.is_zero() => 0,
            negative if negative.is_negative => -1,
            _ => 1,
        };
        let size = self.compare_magnitudes(*other);
        let within = if self.is_negative { size.reverse() } else { size };
        Some(sign(self).cmp(&sign(other)).then(within))
    }
}

impl Real for Wide {
    const ZERO: Self = Self { is_negative: false, exponent: 0, mantissa: [0; DIGITS] };
    const ONE: Self = Self { is_negative: false, exponent: 1, mantissa: [0, 0, 0, 1 << 63] };
    /// 2^-252: a few units in the last place of the type's operations.
    const EPSILON: f64 = f64::from_bits((1023 - 252) << 52);

    fn from_f64(number: f64) -> Self {
        if !number.is_finite() {
            return Self::NOT_A_NUMBER;
        }
        // A subnormal number is made normal.
        let (size, power) = if number.abs() < f64::MIN_POSITIVE {
            (number.abs() * 2.0_f64.powi(64), -64)
        } else {
            (number.abs(), 0)
        };
        if size == 0.0 {
            return Self::ZERO;
        }
        let bits = size.to_bits();
        let mut mantissa = [0; 2 * DIGITS];
        mantissa[2 * DIGITS - 1] = (bits & ((1 << 52) - 1) | 1 << 52) << 11;
        let exponent = (bits >> 52).cast_signed() - 1022;
        Self::of(number < 0.0, exponent + power, mantissa)
    }

    fn to_f64(self) -> f64 {
        if self.is_nan() {
            return f64::NAN;
        }
        let [rest @ .., first] = self.mantissa;
        // One bit says that others follow, so that the conversion rounds to the nearest number.
        let first = first | u64::from(rest != [0; DIGITS - 1]);
        let power = self.exponent.clamp(-2000, 2000) - 64;
        let (half, other) = (power / 2, power - power / 2);
        let size = first as f64 * 2.0_f64.powi(half as i32) * 2.0_f64.powi(other as i32);
        if self.is_negative { -size } else { size }
    }

    fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        if self.is_nan() || self.is_negative {
            return Self::NOT_A_NUMBER;
        }
        let odd = self.exponent.rem_euclid(2);
        let number = Self { exponent: odd, ..self };
        let mut reciprocal = Self::from_f64(number.to_f64().sqrt().recip());
        let half = |number: Self| number.scaled(-1);
        for _ in 0..NEWTON_STEPS {
            reciprocal = reciprocal + half(reciprocal * (Self::ONE - number * (reciprocal * reciprocal)));
        }
        let root = number * reciprocal;
        (root + half(reciprocal * (number - root * root))).scaled((self.exponent - odd) / 2)
    }
}
