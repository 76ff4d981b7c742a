//! The terms T of a surface and dT/ds, s = u/unit, u = r², in lanes, for several vectors side by side.

use super::super::lanes::{Cpu, Lanes, Scalar};
use crate::{numeric::Real, trace::aspheric::Aspheric};

/// T as two polynomials in s, that of the even powers and that of the odd ones over s √s.
#[derive(Clone, Debug)]
pub struct Terms<S> {
    /// Coefficients, the highest power's first; at least one.
    even: Box<[S]>,
    odd: Box<[S]>,
    /// s at the rim.
    pub rim: S,
    /// 1/unit, a power of two.
    pub per_unit: S,
}

impl<S: Scalar> Terms<S> {
    /// Of a surface.
    pub fn new(aspheric: &Aspheric<f64>) -> Self {
        let reversed = |terms: &[f64]| terms.iter().rev().map(|&term| S::from_f64(term)).collect::<Vec<_>>();
        let mut even = reversed(&aspheric.even);
        even.push(S::ZERO);
        Self {
            even: even.into(),
            odd: reversed(&aspheric.odd).into(),
            rim: S::from_f64(aspheric.rim / aspheric.unit),
            per_unit: S::from_f64(aspheric.unit.recip()),
        }
    }

    /// T and dT/ds at each s; beyond the rim, of the paraboloid that goes on there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn at<L: Lanes<Scalar = S>, const U: usize>(&self, cpu: Cpu<L>, s: &[L; U]) -> [[L; U]; 2] {
        let rim = L::splat(cpu, self.rim);
        let mut inside = *s;
        for i in 0..U {
            inside[i] = s[i].smaller(rim);
        }
        let [mut value, mut slope] = nested(cpu, &self.even, &inside);
        if !self.odd.is_empty() {
            // d(s √s O)/ds = √s (3 O/2 + s O').
            let [odd, odd_slope] = nested(cpu, &self.odd, &inside);
            let three_halves = L::splat(cpu, S::from_f64(1.5));
            for i in 0..U {
                let root = inside[i].sqrt();
                value[i] = (root * inside[i]).mul_add(odd[i], value[i]);
                let by_root = inside[i].mul_add(odd_slope[i], three_halves * odd[i]);
                slope[i] = root.mul_add(by_root, slope[i]);
            }
        }
        for i in 0..U {
            value[i] = (s[i] - inside[i]).mul_add(slope[i], value[i]);
        }
        [value, slope]
    }
}

/// A polynomial and its derivative, by Horner's rule.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn nested<L: Lanes, const U: usize>(cpu: Cpu<L>, coefficients: &[L::Scalar], at: &[L; U]) -> [[L; U]; 2] {
    let first = L::splat(cpu, coefficients[0]);
    let (mut value, mut slope) = ([first; U], [L::splat(cpu, L::Scalar::ZERO); U]);
    for &coefficient in &coefficients[1..] {
        let coefficient = L::splat(cpu, coefficient);
        for i in 0..U {
            slope[i] = slope[i].mul_add(at[i], value[i]);
            value[i] = value[i].mul_add(at[i], coefficient);
        }
    }
    [value, slope]
}
