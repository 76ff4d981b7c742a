//! A stop with blades, in lanes: a test of [`StopFigure`]'s inequality, without a move of the rays and without a division.

use super::{
    apertures::Apertures,
    lanes::{Cpu, Lanes},
    ray::RayLanes,
    table::BladedStop,
};
use crate::{numeric::Real, trace::blades::StopFigure};

impl<L: Lanes, A: Apertures<L>> RayLanes<L, A> {
    /// At P = z (Vx, Vy)/Vz + (x, y), z the distance along the axis to the stop; all of it times Vz².
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn blades(&mut self, cpu: Cpu<L>, stop: &BladedStop<L::Scalar>) {
        let ahead = self.minus_z(cpu, &stop.transfer);
        let x = ahead.mul_add(self.vx, self.x * self.vz);
        let y = ahead.mul_add(self.vy, self.y * self.vz);
        let (power, limit) = power(cpu, &stop.figure, [x, y], self.vz);
        self.keep(power.less_equal(limit));
    }
}

/// The two sides of the inequality at points that were multiplied with `w`, positive.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn power<L: Lanes>(cpu: Cpu<L>, figure: &StopFigure<L::Scalar>, [x, y]: [L; 2], w: L) -> (L, L) {
    // Of three normals and more, one is less than a right angle from the point.
    let mut most = L::splat(cpu, L::Scalar::ZERO);
    for normal in &figure.normals {
        let product = y.mul_add(L::splat(cpu, normal[1]), x * L::splat(cpu, normal[0]));
        most = product.larger(most);
    }
    // Not a number, where the point is none, also times 0.
    let round = L::splat(cpu, figure.bulge) * y.mul_add(y, x * x);
    let power = (most * w).mul_add(L::splat(cpu, figure.slant), round);
    (power, (w * w) * L::splat(cpu, figure.limit))
}
