//! Conics in lanes: intersection by the solution of a quadratic equation in closed form.
//!
//! Let A = c (n² + k Vz²), g = Vz - c (x Vx + y Vy) on the vertex plane, and e = √(g² - A c u) = N·V at the hit. With
//! these, t = c u/(g + e) = (g - e)/A, the root at which the ray crosses toward the side ahead. The hit lies on the
//! half or the sheet that contains the vertex if q > 0 there. It is the first crossing if the other root, at t + 2 e/A,
//! does not lie between the hit and the start of the ray.

use super::{
    super::{
        apertures::Apertures,
        dispersion::Media,
        ray_lanes::{Crossing, RayLanes},
    },
    figure::{Common, Conic},
};
use realistic_base::numeric::Real;
use realistic_simd::{Cpu, Lanes};

/// The normal N = (-m x, -m y, q) where rays meet a surface, not a unit vector.
#[derive(Clone, Copy)]
pub struct Normal<L> {
    pub m: L,
    pub q: L,
    /// N·V.
    pub facing: L,
    /// N·N.
    pub square: L,
    /// Distance along the rays from the previous surface, in units of V.
    pub distance: L,
}

impl<L: Lanes, A: Apertures<L>> RayLanes<L, A> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn conic(
        &mut self,
        cpu: Cpu<L>,
        conic: &Conic<L::Scalar>,
        media: impl Media<L>,
        minus_z: L,
        lead: L,
    ) -> Crossing<L> {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        let c = L::splat(cpu, conic.c);
        let [to_plane, from] = self.reach_plane(cpu, &conic.common, minus_z, lead);
        let along = self.y.mul_add(self.vy, self.x * self.vx);
        let g = c.neg_mul_add(along, self.vz);
        let a = (self.vz * self.vz)
            .mul_add(L::splat(cpu, conic.ck), media.times_square(L::splat(cpu, conic.cn2)));
        let cu = c * self.height_squared();
        let square = a.neg_mul_add(cu, g * g);
        let e = square.sqrt();
        let near = zero.less(g);
        let t = L::select(near, cu, g - e) / L::select(near, g + e, a);
        self.advance(t);
        let z = t * self.vz;
        let q = z.mul_add(L::splat(cpu, conic.minus_kappa_c), one);
        let square_of_normal = q.mul_add(q, L::splat(cpu, conic.c2) * self.height_squared());
        self.keep(zero.less(q));
        self.keep(from.less_equal(t));
        self.keep((zero - a * (t - from)).less(e + e));
        self.height = z;
        let normal = Normal { m: c, q, facing: e, square: square_of_normal, distance: to_plane + t };
        self.bend_at(cpu, &conic.common, media, normal)
    }

    /// Moves rays to the plane from which the surface is approached, `minus_z` plus `common.start` ahead. Returns two
    /// distances in units of V: to this plane, and from this plane to the first point where the rays may meet the
    /// surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn reach_plane(&mut self, cpu: Cpu<L>, common: &Common<L::Scalar>, minus_z: L, lead: L) -> [L; 2] {
        self.go_forward(cpu);
        let inverse = L::splat(cpu, L::Scalar::ONE) / self.vz;
        let to_plane = (minus_z + L::splat(cpu, common.start)) * inverse;
        self.advance(to_plane);
        let last = L::splat(cpu, -common.slack) - (lead + to_plane);
        [to_plane, last.larger(L::splat(cpu, common.lowest) * inverse)]
    }

    /// Tests the aperture and returns Γ, for V' = V + Γ N, and the new N·V. Γ = K/(N·V + √((N·V)² + K N·N)), and
    /// -2 N·V/N·N at a mirror; `facing` is N·V, `square` N·N.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn gain(
        &mut self,
        cpu: Cpu<L>,
        common: &Common<L::Scalar>,
        media: impl Media<L>,
        facing: L,
        square: L,
    ) -> [L; 2] {
        self.meet_aperture(cpu, self.height_squared(), L::splat(cpu, common.aperture));
        let step = media.index_step(cpu, common.index_step);
        let facing_squared = facing * facing;
        let after_squared = step.mul_add(square, facing_squared);
        self.keep_root(cpu, media.lesser(common.rarer, facing_squared, after_squared));
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let after = after_squared.sqrt();
        let gain = if common.is_mirror { (zero - facing - facing) / square } else { step / (facing + after) };
        [gain, after]
    }

    /// Tests the aperture and refracts or reflects at a point of the surface. Behind a mirror z is reversed.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn bend_at(
        &mut self,
        cpu: Cpu<L>,
        common: &Common<L::Scalar>,
        media: impl Media<L>,
        Normal { m, q, facing, square, distance }: Normal<L>,
    ) -> Crossing<L> {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let [gain, after] = self.gain(cpu, common, media, facing, square);
        let across = m * gain;
        self.vx = across.neg_mul_add(self.x, self.vx);
        self.vy = across.neg_mul_add(self.y, self.vy);
        self.vz = gain.mul_add(q, self.vz);
        if common.is_mirror {
            self.vz = zero - self.vz;
        }
        let minus_m = zero - m;
        self.crossing([minus_m * self.x, minus_m * self.y, q], Some(square), [facing, after], distance)
    }
}
