//! The terms of the polynomials. This module converts a ray at the film to the variables of the polynomials, and
//! evaluates sums of monomials in these variables.
//!
//! Let x be the position and s the slopes of a ray at the film, both two-dimensional vectors; p = s + vergence · x is
//! the slope relative to the pupil's centre. x and p are scaled to the unit disk, so that the equations of the fit are
//! well conditioned ([`Scaling`]). The polynomials are in u = 2 x·x - 1, v = x·p and w = 2 p·p - 1. Several polynomials
//! are evaluated at once, by nested Horner schemes ([`sum`]).

use realistic_optics::{lens::Ray, trace::Real};
use realistic_simd::{Cpu, Lanes, Scalar};

/// Position and slopes of a ray in the film plane.
type FilmCoordinates = ([f64; 2], [f64; 2]);

/// Conversion of a ray at the film to the variables of the polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// z of the film, lens space, mm.
    pub film: f64,
    /// Vergence, 1/mm: the slope from the film position x toward the pupil's centre is -vergence · x.
    pub vergence: f64,
    /// Reciprocal of the largest film height, 1/mm.
    pub film_scale: f64,
    /// Reciprocal of the largest slope relative to the pupil's centre.
    pub pupil_scale: f64,
}

impl Scaling {
    /// Fits the scaling to the range of film and pupil that the rays cover. A ray is given by its position and slopes
    /// at the film.
    pub fn of(film: f64, rays: &[FilmCoordinates]) -> Self {
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let (product, square) =
            rays.iter().fold((0.0, 0.0), |(p, s), &(x, slope)| (p + dot(x, slope), s + dot(x, x)));
        let vergence = if square > 0.0 { -product / square } else { 0.0 };
        let largest = |length: &dyn Fn(&FilmCoordinates) -> f64| {
            let most = rays.iter().map(length).fold(0.0, f64::max).sqrt();
            if most > 0.0 { most.recip() } else { 1.0 }
        };
        let about = |x: [f64; 2], s: [f64; 2]| [s[0] + vergence * x[0], s[1] + vergence * x[1]];
        Self {
            film,
            vergence,
            film_scale: largest(&|&(x, _)| dot(x, x)),
            pupil_scale: largest(&|&(x, s)| dot(about(x, s), about(x, s))),
        }
    }

    pub(super) fn at_film(ray: &Ray, film: f64) -> FilmCoordinates {
        let [x, y, z] = ray.origin;
        let [dx, dy, dz] = ray.direction;
        let slopes = [dx / dz, dy / dz];
        ([x + slopes[0] * (film - z), y + slopes[1] * (film - z)], slopes)
    }

    /// Returns the scaled film position, the scaled pupil position, and their invariants in [-1, 1].
    pub fn variables(&self, x: [f64; 2], slopes: [f64; 2]) -> ([f64; 2], [f64; 2], [f64; 3]) {
        let p = [0, 1].map(|i| (slopes[i] + self.vergence * x[i]) * self.pupil_scale);
        let x = x.map(|x| x * self.film_scale);
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        (x, p, [2.0 * dot(x, x) - 1.0, dot(x, p), 2.0 * dot(p, p) - 1.0])
    }

    /// Returns the scaling for rays in lanes of the precision `S`.
    pub fn lane_scaling<S: Scalar>(&self) -> LaneScaling<S> {
        LaneScaling {
            vergence: S::from_f64(self.vergence),
            film_scale: S::from_f64(self.film_scale),
            pupil_scale: S::from_f64(self.pupil_scale),
        }
    }
}

/// A [`Scaling`] for lanes of the precision `S`.
#[derive(Clone, Copy, Debug)]
pub struct LaneScaling<S> {
    vergence: S,
    film_scale: S,
    pupil_scale: S,
}

impl<S: Scalar> LaneScaling<S> {
    /// Returns [`Scaling::variables`] of rays, given by their film points, mm, and slopes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn variables<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        [x, y]: [L; 2],
        [sx, sy]: [L; 2],
    ) -> ([L; 2], [L; 2], [L; 3]) {
        let one = L::splat(cpu, S::ONE);
        let two = one + one;
        let (vergence, scale) = (L::splat(cpu, self.vergence), L::splat(cpu, self.pupil_scale));
        let (px, py) = (vergence.mul_add(x, sx) * scale, vergence.mul_add(y, sy) * scale);
        let scale = L::splat(cpu, self.film_scale);
        let (x, y) = (x * scale, y * scale);
        let u = two.mul_sub(y.mul_add(y, x * x), one);
        let v = y.mul_add(py, x * px);
        let w = two.mul_sub(py.mul_add(py, px * px), one);
        ([x, y], [px, py], [u, v, w])
    }
}

/// Returns the number of monomials of each polynomial of an odd order.
pub fn monomials(order: usize) -> usize {
    exponents((order - 1) / 2).len()
}

/// Returns the exponents (i, j, k) of u, v, w up to a total degree, in the order in which [`sum`] reads their
/// coefficients.
pub fn exponents(degree: usize) -> Vec<[usize; 3]> {
    let mut all = Vec::new();
    for i in (0..=degree).rev() {
        for j in (0..=degree - i).rev() {
            all.extend((0..=degree - i - j).rev().map(|k| [i, j, k]));
        }
    }
    all
}

/// Returns `P` sums of a coefficient times u^i v^j w^k for each of `U` vectors of rays, by nested Horner schemes. The
/// terms are in the order of [`exponents`]. Each coefficient is broadcast once for all vectors.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn sum<L: Lanes, const P: usize, const U: usize>(
    cpu: Cpu<L>,
    terms: &[[L::Scalar; P]],
    degree: usize,
    rays: &[[L; 3]; U],
) -> [[L; P]; U] {
    let zero = [[L::splat(cpu, Real::ZERO); P]; U];
    let mut at = 0;
    let mut whole = zero;
    for i in (0..=degree).rev() {
        let mut in_v = zero;
        for j in (0..=degree - i).rev() {
            let mut in_w = zero;
            let end = at + degree - i - j + 1;
            for term in &terms[at..end] {
                for p in 0..P {
                    let term = L::splat(cpu, term[p]);
                    for u in 0..U {
                        in_w[u][p] = in_w[u][p].mul_add(rays[u][2], term);
                    }
                }
            }
            at = end;
            for u in 0..U {
                for p in 0..P {
                    in_v[u][p] = in_v[u][p].mul_add(rays[u][1], in_w[u][p]);
                }
            }
        }
        for u in 0..U {
            for p in 0..P {
                whole[u][p] = whole[u][p].mul_add(rays[u][0], in_v[u][p]);
            }
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_simd::{OneLane, Portable};

    #[test]
    fn the_nested_scheme_is_the_plain_sum() {
        for degree in 0..6 {
            let terms: Vec<[f64; 4]> = exponents(degree)
                .into_iter()
                .map(|[i, j, k]| std::array::from_fn(|p| ((7 * i + 5 * j + 3 * k + p) % 11) as f64 - 5.0))
                .collect();
            assert_eq!(terms.len(), (degree + 1) * (degree + 2) * (degree + 3) / 6);
            let at = [0.3, -0.7, 0.9];
            let [nested] = sum(OneLane::cpu(), &terms, degree, &[at.map(|x: f64| Portable([x]))]);
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
