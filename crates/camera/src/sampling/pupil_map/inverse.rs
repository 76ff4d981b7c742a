//! The inverse of the map: takes points of the plane; returns the area per sample there, if there are any samples.
//!
//! The map keeps the order of rows, so bisection finds the two knots about a y. Between them eta is linear in |Y|,
//! which gives Y; m and g there give X.

use super::{CELLS, GridLocation, PupilMap};
use realistic_base::numeric::Real;
use realistic_simd::{Cpu, Lanes};

impl PupilMap {
    /// Returns the areas, over π, per sample at points (x, y) of the plane; NaN at points outside the disk's image.
    /// Vectors are bisected side by side, since each look-up waits for the one before.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn areas<L: Lanes, const U: usize>(
        &self,
        cpu: Cpu<L>,
        locations: &[GridLocation<L>; U],
        points: &[[L; 2]; U],
    ) -> [L; U] {
        let number = |number: f64| L::splat(cpu, L::Scalar::from_f64(number));
        let (zero, one, per_cell) = (number(0.0), number(1.0), number((CELLS as f64).recip()));
        let mut lowers = [zero.less(zero); U];
        for u in 0..U {
            let y = points[u][1];
            lowers[u] = if self.is_symmetric {
                y.less(zero)
            } else {
                let [eta, ..] = self.cell_of(cpu, &locations[u], zero, lowers[u]);
                y.less(eta[0] + eta[1])
            };
        }
        // Heights of rows over their half of the map grow with |Y|. The lower half of a symmetric map uses the rows of
        // the upper half.
        let mut flipped = [zero.less(zero); U];
        let mut sought = [zero; U];
        for u in 0..U {
            let y = points[u][1];
            sought[u] = L::select(lowers[u], zero - y, y);
            flipped[u] = if self.is_symmetric { zero.less(zero) } else { lowers[u] };
        }
        let mut knots = [zero; U];
        let mut step = (CELLS / 2) as f64;
        while step >= 1.0 {
            for u in 0..U {
                let middle = knots[u] + number(step);
                let [[end, slope], ..] = self.cell_of(cpu, &locations[u], middle, lowers[u]);
                // 1 - |Y| is the square of `left`.
                let left = middle.neg_mul_add(per_cell, one);
                let height = (left * left).mul_add(slope, end);
                let height = L::select(flipped[u], zero - height, height);
                knots[u] = L::select(height.less_equal(sought[u]), middle, knots[u]);
            }
            step *= 0.5;
        }
        let mut areas = [zero; U];
        for u in 0..U {
            let [[end, slope], middle, half] = self.cell_of(cpu, &locations[u], knots[u], lowers[u]);
            let y = if self.is_symmetric { sought[u] } else { points[u][1] };
            let v = ((y - end) / slope).smaller(one);
            let width = v.mul_add(half[1], half[0]) * locations[u].taper;
            let middle = v.mul_add(middle[1], middle[0]);
            let (across, aside) = ((points[u][0] - middle) / width, one - v);
            let is_inside = across.mul_add(across, aside * aside).less_equal(one);
            let area = width * slope.abs();
            areas[u] = L::select(L::both(is_inside, zero.less(area)), area, number(f64::NAN));
        }
        areas
    }
}
