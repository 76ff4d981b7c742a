//! The terms T of a surface and dT/du, u = r², in lanes, for several vectors side by side.

use super::super::lanes::{Cpu, Lanes, Scalar};
use crate::numeric::Real;

/// T as two polynomials in u, the one of the even powers and the other of the odd ones over r³.
#[derive(Clone, Debug)]
pub struct Terms<S> {
    /// Coefficients, the highest power's first; at least one.
    even: Box<[S]>,
    odd: Box<[S]>,
    /// The square of the rim's radius.
    pub rim: S,
}

impl<S: Scalar> Terms<S> {
    /// Of the coefficients of u, u², … and of r u, r u², …, inside a rim of this radius squared.
    pub fn new(even: &[f64], odd: &[f64], rim: f64) -> Self {
        let reversed = |terms: &[f64]| terms.iter().rev().map(|&term| S::from_f64(term)).collect::<Vec<_>>();
        let mut even = reversed(even);
        even.push(S::ZERO);
        Self { even: even.into(), odd: reversed(odd).into(), rim: S::from_f64(rim) }
    }

    /// T and dT/du at each u; beyond the rim, of the paraboloid that goes on there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn at<L: Lanes<Scalar = S>, const U: usize>(&self, cpu: Cpu<L>, u: &[L; U]) -> [[L; U]; 2] {
        let rim = L::splat(cpu, self.rim);
        let mut inside = *u;
        for i in 0..U {
            inside[i] = u[i].smaller(rim);
        }
        let [mut value, mut slope] = nested(cpu, &self.even, &inside);
        if !self.odd.is_empty() {
            let [odd, odd_slope] = nested(cpu, &self.odd, &inside);
            let three_halves = L::splat(cpu, S::from_f64(1.5));
            for i in 0..U {
                let r = inside[i].sqrt();
                value[i] = (r * inside[i]).mul_add(odd[i], value[i]);
                let by_u = inside[i].mul_add(odd_slope[i], three_halves * odd[i]);
                slope[i] = r.mul_add(by_u, slope[i]);
            }
        }
        for i in 0..U {
            value[i] = (u[i] - inside[i]).mul_add(slope[i], value[i]);
        }
        [value, slope]
    }
}

/// A polynomial and its derivative, by Horner's rule.
#[cfg_attr(not(debug_assertions), inline(always))]
fn nested<L: Lanes, const U: usize>(cpu: Cpu<L>, coefficients: &[L::Scalar], at: &[L; U]) -> [[L; U]; 2] {
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
