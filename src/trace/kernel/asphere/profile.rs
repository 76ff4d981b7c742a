//! The height of a surface above its vertex plane in lanes, by its distance from the axis.

use super::{
    super::lanes::{Cpu, Lanes, Scalar},
    terms::Terms,
};
use crate::trace::aspheric::Aspheric;

/// The profile of an aspheric surface.
#[derive(Clone, Debug)]
pub struct Profile<S> {
    c: S,
    /// (1 + k) c².
    bend: S,
    terms: Terms<S>,
}

impl<S: Scalar> Profile<S> {
    pub fn new(aspheric: &Aspheric<f64>) -> Self {
        let c = aspheric.curvature;
        Self { c: S::from_f64(c), bend: S::from_f64(aspheric.kappa * c * c), terms: Terms::new(aspheric) }
    }

    /// z along the travel at the squared distance u from the axis; NaN where the conic has ended.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn height<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, u: L) -> L {
        let one = L::splat(cpu, S::ONE);
        let [[terms], _] = self.terms.at(cpu, &[u * L::splat(cpu, self.terms.per_unit)]);
        let root = L::splat(cpu, self.bend).neg_mul_add(u, one).sqrt();
        L::splat(cpu, self.c) * u / (one + root) + terms
    }
}
