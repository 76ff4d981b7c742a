//! Refraction at a surface by Snell's law, n sin I = n' sin I', by four methods.
//!
//! The first three are the methods that P. Heckbert and P. Hanrahan compare ("Derivation of Refraction Formulas" in A.
//! Glassner, ed., *An Introduction to Ray Tracing*, 1989). They perform exactly the operations of that text, so that
//! the operations can be counted. The fourth method is this library's own: it works on optical direction cosines V = n
//! D and needs no division by an index.
//!
//! Directions are unit vectors. `normal` is the unit normal on the side of the refracted light (`incident · normal >
//! 0`). Under total reflection the functions return NaN; callers test for total reflection first.

use realistic_base::numeric::{Real, dot};

/// A method of refraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refraction {
    /// V' = V + (n' cos I' - n cos I) N on optical direction cosines.
    #[default]
    Fused,
    /// Heckbert's method.
    Heckbert,
    /// Whitted's method (1980).
    Whitted,
    /// The "other method" of Heckbert and Hanrahan's comparison.
    Other,
}

impl Refraction {
    /// Every method, with the name that parameters and the command line use.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("fused", Self::Fused),
        ("heckbert", Self::Heckbert),
        ("whitted", Self::Whitted),
        ("other", Self::Other),
    ];
}

type Vector<R> = [R; 3];

/// Whitted's method: 2 square roots, 8 divisions, 17 multiplications, 15 additions.
#[inline]
pub fn whitted<R: Real>(incident: Vector<R>, normal: Vector<R>, n: R, n_after: R) -> Vector<R> {
    let ratio = n_after / n;
    let cos = dot(incident, normal);
    let scaled = incident.map(|x| x / cos);
    let tangent: Vector<R> = std::array::from_fn(|i| scaled[i] - normal[i]);
    let length = ratio * ratio * dot(scaled, scaled) - dot(tangent, tangent);
    let factor = R::ONE / length.sqrt();
    let bent: Vector<R> = std::array::from_fn(|i| factor * tangent[i] + normal[i]);
    let norm = dot(bent, bent).sqrt();
    bent.map(|x| x / norm)
}

/// Heckbert's method: 1 square root, 1 division, 13 multiplications, 8 additions.
#[inline]
pub fn heckbert<R: Real>(incident: Vector<R>, normal: Vector<R>, n: R, n_after: R) -> Vector<R> {
    let ratio = n / n_after;
    let cos = dot(incident, normal);
    let cos_after = (R::ONE - ratio * ratio * (R::ONE - cos * cos)).sqrt();
    let along = cos_after - ratio * cos;
    std::array::from_fn(|i| ratio * incident[i] + along * normal[i])
}

/// The "other method": 1 square root, 4 divisions, 8 multiplications, 8 additions.
#[inline]
pub fn other<R: Real>(incident: Vector<R>, normal: Vector<R>, n: R, n_after: R) -> Vector<R> {
    let ratio = n_after / n;
    let cos = dot(incident, normal);
    let along = (ratio * ratio - R::ONE + cos * cos).sqrt() - cos;
    std::array::from_fn(|i| (incident[i] + along * normal[i]) / ratio)
}

/// The fused form: V' = V + (n' cos I' - n cos I) N, computed from V = n D, `projected` = n cos I = N·V, and
/// `index_step` = n'² - n². The term in brackets is written as a quotient, so that a small index step keeps its digits.
/// `projected` is known from the intersection, and nothing is divided by an index.
#[inline]
pub fn fused<R: Real>(v: Vector<R>, normal: Vector<R>, projected: R, index_step: R) -> Vector<R> {
    let projected_after = (projected * projected + index_step).sqrt();
    let bend = index_step / (projected + projected_after);
    std::array::from_fn(|i| v[i] + bend * normal[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_methods_obey_snell() {
        for (n, n_after) in [(1.0, 1.5), (1.7, 1.0), (1.6, 1.65)] {
            for sine in [0.0_f64, 0.1, 0.5] {
                let incident = [sine * 0.6, sine * 0.8, (1.0 - sine * sine).sqrt()];
                let sine_after = n * sine / n_after;
                let expected = [sine_after * 0.6, sine_after * 0.8, (1.0 - sine_after * sine_after).sqrt()];
                for method in [whitted::<f64>, heckbert, other] {
                    let got = method(incident, [0.0, 0.0, 1.0], n, n_after);
                    for (a, b) in got.iter().zip(expected) {
                        assert!((a - b).abs() < 1e-15, "{got:?} is not {expected:?}");
                    }
                }
                let v = incident.map(|d| n * d);
                let got = fused(v, [0.0, 0.0, 1.0], v[2], n_after * n_after - n * n);
                for (a, b) in got.iter().zip(expected) {
                    assert!((a / n_after - b).abs() < 1e-15, "{got:?} is not {expected:?}");
                }
            }
        }
    }
}
