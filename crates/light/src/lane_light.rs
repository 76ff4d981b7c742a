//! Polarised light along rays, in lanes of single precision. Each lane has a Stokes vector, as [`Light`](super::Light)
//! does, computed by the same equations.

use super::lane_surface::ShareLanes;
use realistic_simd::{Cpu, Lanes};
use realistic_trace::kernel::Crossing;

/// The light of a vector of rays.
#[derive(Clone, Copy, Debug)]
pub struct LaneLight<L> {
    /// I, Q, U and V.
    stokes: [L; 4],
    /// Vector perpendicular to the last plane of incidence, of any length; 0 before the first plane.
    across: [L; 3],
    /// Exponent of absorption, Σ α l.
    exponent: L,
}

/// Share of the vector perpendicular to the previous plane of incidence that is added to the vector perpendicular to
/// the next plane. Near normal incidence the sum is nearly the old vector: rounding would give the new vector an
/// arbitrary direction, and s and p are equal. At other angles the sum turns the plane by less than this share divided
/// by the sine of incidence, which changes the transmission by less than 1e-6.
const REMEMBERED: f32 = 1e-4;
/// Approximate fourth power of the sine of incidence up to which there is no plane of incidence.
const AXIAL: f32 = 1e-30;
/// Largest exponent of absorption: the remaining light is below the rounding error of any other light in single
/// precision.
const DARK: f32 = 64.0;
/// Number of times that an exponent is halved, to at most 1/2, before the series is summed; the result is squared as
/// often.
const HALVINGS: u32 = 7;
/// Highest power of the series, which leaves an error of 1e-7 at 1/2.
const LAST_POWER: u32 = 7;

impl<L: Lanes<Scalar = f32>> LaneLight<L> {
    /// Returns unpolarised light of power 1.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn unpolarised(cpu: Cpu<L>) -> Self {
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        Self { stokes: [one, zero, zero, zero], across: [zero; 3], exponent: zero }
    }

    /// Absorbs light along `distance` with this coefficient per unit of distance.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn absorb(&mut self, distance: L, coefficient: L) {
        self.exponent = distance.mul_add(coefficient, self.exponent);
    }

    /// Applies the effect of a surface. The normal in `crossing` is a unit vector; `index` is n before the surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn cross(&mut self, cpu: Cpu<L>, crossing: &Crossing<L>, index: L, [m, d, re, im]: ShareLanes<L>) {
        let Crossing { normal: [nx, ny, nz], facing: [before, behind], v: [vx, vy, vz], .. } = *crossing;
        // N × V is the same before and behind the surface. To select the old vector where the new one vanishes would be
        // slower: the compiler would turn the selection into masked stores, which the processor does not forward to the
        // loads at the next surface.
        let (old, remembered) = (self.across, L::splat(cpu, REMEMBERED));
        let new = [
            remembered.mul_add(old[0], nz.neg_mul_add(vy, ny * vz)),
            remembered.mul_add(old[1], nx.neg_mul_add(vz, nz * vx)),
            remembered.mul_add(old[2], ny.neg_mul_add(vx, nx * vy)),
        ];
        self.across = new;
        // Cosine and sine of the angle from the old plane to the new one, about V before the surface: old × new = sine
        // V/|V|, times the lengths of both vectors. Cosine and sine are scaled by the z component of V.
        let z = (behind - before).neg_mul_add(nz, vz);
        let cosine = dot(old, new) * z;
        let sine = index * old[1].neg_mul_add(new[0], old[0] * new[1]);
        let square = sine.mul_add(sine, cosine * cosine);
        // The inverse is 0 before the first plane and on the axis, where Q and U are 0.
        let inverse = (L::splat(cpu, 1.0) / square).or_zero(L::splat(cpu, AXIAL).less(square));
        let cosine_2 = sine.neg_mul_add(sine, cosine * cosine) * inverse;
        let sine_2 = ((sine + sine) * cosine) * inverse;
        let [power, q, u, v] = self.stokes;
        let (q, u) = (sine_2.mul_add(u, cosine_2 * q), sine_2.neg_mul_add(q, cosine_2 * u));
        self.stokes = [
            d.mul_add(q, m * power),
            d.mul_add(power, m * q),
            im.neg_mul_add(v, re * u),
            im.mul_add(u, re * v),
        ];
    }

    /// Reverses the z axis, as behind a mirror that loses no light (see [`Light`](super::Light)).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn turn_round(&mut self, cpu: Cpu<L>) {
        self.across[2] = L::splat(cpu, 0.0) - self.across[2];
    }

    /// Takes the light to a frame that is turned by a rotation, given by rows.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn enter_frame(&mut self, cpu: Cpu<L>, rotation: &[[f32; 3]; 3]) {
        let old = self.across;
        for (across, &[a, b, c]) in self.across.iter_mut().zip(rotation) {
            *across = dot([L::splat(cpu, a), L::splat(cpu, b), L::splat(cpu, c)], old);
        }
    }

    /// Returns the share of the power that remains behind the surfaces.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn power(&self) -> L {
        self.stokes[0]
    }

    /// Returns the share that absorption leaves, exp(-Σ α l).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn unabsorbed(&self, cpu: Cpu<L>) -> L {
        let number = |number: f32| L::splat(cpu, number);
        let x = self.exponent.smaller(number(DARK)) * number(0.5_f32.powi(HALVINGS as i32));
        // exp(-x) = 1 - x (1 - x/2 (1 - x/3 …)).
        let one = number(1.0);
        let mut left = one;
        let mut power = LAST_POWER;
        while power > 0 {
            left = (x * number((power as f32).recip())).neg_mul_add(left, one);
            power -= 1;
        }
        for _ in 0..HALVINGS {
            left = left * left;
        }
        left
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}
