//! The inverse of the map, which returns the area per sample at a point of the plane, if there are samples at
//! that point.
//!
//! The map preserves the order of rows, so bisection finds the two knots on either side of a given y. Between
//! these knots eta is linear in |Y|, which gives Y; m and g at this Y then give X.

use super::{CELLS, GridLocation, PupilMap};
use realistic_base::numeric::Real;
use realistic_simd::{Cpu, Lanes};

impl PupilMap {
    /// Returns the areas per sample, divided by π, at points (x, y) of the plane; NaN at points outside the
    /// image of the disk. Several vectors are bisected side by side, because each look-up has to wait for the
    /// previous one.
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
        // The heights of the rows in each half of the map grow with |Y|. The lower half of a symmetric map
        // uses the rows of the upper half.
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
