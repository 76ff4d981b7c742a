//! Polynomials in three variables, several at once, by nested Horner schemes, over lanes.

use crate::trace::{
    Real,
    kernel::{Cpu, Lanes},
};

/// The monomials of each polynomial of an odd order.
pub fn monomials(order: usize) -> usize {
    exponents((order - 1) / 2).len()
}

/// The exponents (i, j, k) of u, v, w up to a total degree, in the order in which [`sum`] reads their
/// coefficients.
pub(crate) fn exponents(degree: usize) -> Vec<[usize; 3]> {
    let mut all = Vec::new();
    for i in (0..=degree).rev() {
        for j in (0..=degree - i).rev() {
            all.extend((0..=degree - i - j).rev().map(|k| [i, j, k]));
        }
    }
    all
}

/// The `P` sums of coefficient x u^i v^j w^k by nested Horner schemes, in the order of
/// [`exponents`].
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn sum<L: Lanes, const P: usize>(
    cpu: Cpu<L>,
    terms: &[[L::Scalar; P]],
    degree: usize,
    [u, v, w]: [L; 3],
) -> [L; P] {
    let zero = [L::splat(cpu, Real::ZERO); P];
    let mut at = 0;
    let mut whole = zero;
    for i in (0..=degree).rev() {
        let mut in_v = zero;
        for j in (0..=degree - i).rev() {
            let mut in_w = zero;
            let end = at + degree - i - j + 1;
            for term in &terms[at..end] {
                for p in 0..P {
                    in_w[p] = in_w[p].mul_add(w, L::splat(cpu, term[p]));
                }
            }
            at = end;
            for p in 0..P {
                in_v[p] = in_v[p].mul_add(v, in_w[p]);
            }
        }
        for p in 0..P {
            whole[p] = whole[p].mul_add(u, in_v[p]);
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::kernel::{OneLane, Portable};

    #[test]
    fn the_nested_scheme_is_the_plain_sum() {
        for degree in 0..6 {
            let terms: Vec<[f64; 4]> = exponents(degree)
                .into_iter()
                .map(|[i, j, k]| std::array::from_fn(|p| ((7 * i + 5 * j + 3 * k + p) % 11) as f64 - 5.0))
                .collect();
            assert_eq!(terms.len(), (degree + 1) * (degree + 2) * (degree + 3) / 6);
            let at = [0.3, -0.7, 0.9];
            let nested = sum(OneLane::cpu(), &terms, degree, at.map(|x: f64| Portable([x])));
            for p in 0..4 {
                let Portable([nested]) = nested[p];
                let plain: f64 = exponents(degree)
                    .into_iter()
                    .zip(&terms)
                    .map(|(e, term)| term[p] * (0..3).map(|d| at[d].powi(e[d] as i32)).product::<f64>())
                    .sum();
                assert!((nested - plain).abs() < 1e-12, "degree {degree}: {nested} {plain}");
            }
        }
    }
}
