//! A sphere met from anywhere, or from its vertex plane: the steps that are no links.

use super::{
    lanes::{Cpu, Lanes},
    march::Ray,
    table::{Rim, Sphere},
};
use crate::trace::Real;

impl<L: Lanes> Ray<L> {
    /// `PLAIN`: the sphere is (see [`Sphere::plain`]).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn sphere<const PLAIN: bool>(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        mut minus_z: L,
        lead: Option<L>,
    ) {
        let minus_c = L::splat(cpu, sphere.minus_c);
        let mut lead = lead.unwrap_or(L::splat(cpu, L::Scalar::ZERO));
        if !PLAIN && sphere.far {
            let t = minus_z / self.vz;
            self.advance(t);
            (minus_z, lead) = (L::splat(cpu, L::Scalar::ZERO), t);
        }
        let across = self.y.mul_add(self.vy, self.x * self.vx);
        let along = minus_z.neg_mul_add(self.vz, across);
        let half_c = L::splat(cpu, sphere.half_c);
        let f = half_c.mul_add(minus_z.mul_add(minus_z, self.height_squared()), minus_z);
        let g = minus_c.mul_add(along, self.vz);
        let minus_2phi = f * L::splat(cpu, sphere.minus_2cn2);
        let square = g.mul_add(g, minus_2phi);
        let square_after = g.mul_add(g, minus_2phi + L::splat(cpu, sphere.index_step));
        let [before, after] = L::sqrt_pair(square, square_after);
        let strong = (g - before) * L::splat(cpu, sphere.per_cn2);
        let t = if PLAIN || sphere.strong {
            strong
        } else {
            L::select(L::splat(cpu, L::Scalar::ZERO).less(g), (f + f) / (g + before), strong)
        };
        self.advance(t);
        self.pass::<PLAIN>(cpu, sphere, t.mul_sub(self.vz, minus_z), [square, square_after], [before, after]);
        if !PLAIN && sphere.tests.onward {
            self.keep(L::splat(cpu, -sphere.slack).less_equal(lead + t));
        }
    }

    /// A sphere met from its vertex plane with slopes s. With G = g/Vz = 1 - c (x, y)·s and
    /// E² = (e/Vz)² = G² - 2 c n² f (1 + s²), z = t Vz = (G - E) Vz²/(c n²): nothing waits for Vz, itself a root.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn first_sphere(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        [sx, sy]: [L; 2],
        stretch: L,
        way: L,
    ) {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        if sphere.tests.forward {
            self.go_forward(cpu);
        }
        let across = self.y.mul_add(sy, self.x * sx);
        let g = L::splat(cpu, sphere.minus_c).mul_add(across, L::splat(cpu, L::Scalar::ONE));
        let f = L::splat(cpu, sphere.half_c) * self.height_squared();
        let stretched = stretch.mul_add(f * L::splat(cpu, sphere.minus_2cn2), g * g);
        let square = stretched * self.cos2;
        let square_after = stretched.mul_add(self.cos2, L::splat(cpu, sphere.index_step));
        let [e, after] = L::sqrt_pair(stretched, square_after);
        let strong = (g - e) * (self.cos2 * L::splat(cpu, sphere.per_cn2));
        let z = if sphere.strong { strong } else { L::select(zero.less(g), (f + f) / (g + e), strong) };
        self.x = z.mul_add(sx, self.x);
        self.y = z.mul_add(sy, self.y);
        // Vz goes on to change: the test's slack is in units of the one before.
        let slack = self.vz * L::splat(cpu, -sphere.slack);
        self.pass::<false>(cpu, sphere, z, [square, square_after], [e * self.vz, after]);
        if sphere.tests.onward {
            self.keep(slack.less_equal(way + z));
        }
    }

    /// Through a sphere's aperture at the height `z` and on behind it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn pass<const PLAIN: bool>(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        z: L,
        [square, square_after]: [L; 2],
        [before, after]: [L; 2],
    ) {
        let minus_c = L::splat(cpu, sphere.minus_c);
        let slope = minus_c.mul_add(z, L::splat(cpu, L::Scalar::ONE));
        self.bend(minus_c, after - before, slope);
        (self.height, self.root) = (if PLAIN || sphere.hands_slope { slope } else { z }, after);
        self.keep_root(cpu, if sphere.index_step < L::Scalar::ZERO { square_after } else { square });
        let least = if let Rim::Slope(least) = sphere.rim { least } else { L::Scalar::ZERO };
        self.keep(L::splat(cpu, least).less_equal(slope));
        if !PLAIN && let Rim::Height(most) = sphere.rim {
            self.keep(self.height_squared().less_equal(L::splat(cpu, most)));
        }
    }
}
