//! Four polynomials in three variables at once, by nested Horner schemes.

use crate::trace::Real;

/// A number with a multiply-add of one rounding.
pub trait Fused: Real {
    /// a b + c.
    #[must_use]
    fn fused(self, b: Self, c: Self) -> Self;
}

impl Fused for f32 {
    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
}

impl Fused for f64 {
    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
}

/// The exponents (i, j, k) of u, v, w up to a total degree, in the order in which [`sum`] reads their
/// coefficients.
pub(super) fn exponents(degree: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..=degree).rev().flat_map(move |i| {
        (0..=degree - i).rev().flat_map(move |j| (0..=degree - i - j).rev().map(move |k| [i, j, k]))
    })
}

/// a b + c in `L` lanes; `FUSED` where the processor does it in one operation.
#[inline(always)]
fn step<R: Fused, const L: usize, const FUSED: bool>(a: &mut [R; L], b: &[R; L], c: &[R; L]) {
    for lane in 0..L {
        a[lane] = if FUSED { a[lane].fused(b[lane], c[lane]) } else { a[lane] * b[lane] + c[lane] };
    }
}

/// The four sums of coefficient x u^i v^j w^k, in `L` lanes.
#[inline(always)]
pub(super) fn sum<R: Fused, const L: usize, const FUSED: bool>(
    terms: &[[R; 4]],
    degree: usize,
    [u, v, w]: [&[R; L]; 3],
) -> [[R; L]; 4] {
    let zero = [[R::ZERO; L]; 4];
    let mut terms = terms.iter();
    let mut whole = zero;
    for i in (0..=degree).rev() {
        let mut in_v = zero;
        for j in (0..=degree - i).rev() {
            let mut in_w = zero;
            for term in terms.by_ref().take(degree - i - j + 1) {
                for p in 0..4 {
                    step::<R, L, FUSED>(&mut in_w[p], w, &[term[p]; L]);
                }
            }
            for p in 0..4 {
                step::<R, L, FUSED>(&mut in_v[p], v, &in_w[p]);
            }
        }
        for p in 0..4 {
            step::<R, L, FUSED>(&mut whole[p], u, &in_v[p]);
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nested_scheme_is_the_plain_sum() {
        for degree in 0..6 {
            let terms: Vec<[f64; 4]> = exponents(degree)
                .map(|[i, j, k]| std::array::from_fn(|p| ((7 * i + 5 * j + 3 * k + p) % 11) as f64 - 5.0))
                .collect();
            assert_eq!(terms.len(), (degree + 1) * (degree + 2) * (degree + 3) / 6);
            let at = [0.3, -0.7, 0.9];
            let nested = sum::<f64, 1, true>(&terms, degree, [&[at[0]], &[at[1]], &[at[2]]]);
            for p in 0..4 {
                let plain: f64 = exponents(degree)
                    .zip(&terms)
                    .map(|(e, term)| term[p] * (0..3).map(|d| at[d].powi(e[d] as i32)).product::<f64>())
                    .sum();
                assert!((nested[p][0] - plain).abs() < 1e-12, "degree {degree}: {} {plain}", nested[p][0]);
            }
        }
    }
}
