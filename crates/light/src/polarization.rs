//! Polarised light along a ray: the Stokes vector of initially unpolarised light, carried from surface to surface (E.
//! Hecht, *Optics*, chapter 8; the frames are those of R. Chipman, "Polarization analysis of optical systems", *Optical
//! Engineering* 28, 1989).
//!
//! Let s be perpendicular to the plane of incidence, p = k × s, and c = `a_s a_p*`. A surface transforms (I, Q, U, V)
//! to
//!
//! I' = m I + d Q, Q' = d I + m Q, U' + i V' = c (U + i V), where m and d are half the sum and half the difference of
//! the shares of s and p. Between two surfaces Q + i U turns by twice the angle from one plane of incidence to the
//! next.
//!
//! For rays in a plane with the axis, the remaining share is half the sum of two products over all surfaces: the
//! product of the shares of s and the product of the shares of p. This differs from the product of the surfaces' mean
//! shares.

use super::stack::Share;
use realistic_base::numeric::dot;

/// Light along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Remaining share of the power, from 1.
    pub power: f64,
    q: f64,
    u: f64,
    v: f64,
    /// Vector perpendicular to the last plane of incidence, of any length; 0 before the first plane.
    across: [f64; 3],
}

/// Squared sine of incidence below which the plane of incidence counts as undefined; s and p then differ by far less
/// than the rounding error of double precision.
const NORMAL: f64 = 1e-24;

impl Light {
    /// Unpolarised light of power 1.
    pub(crate) const UNPOLARISED: Self = Self { power: 1.0, q: 0.0, u: 0.0, v: 0.0, across: [0.0; 3] };

    /// Applies the effect of a surface to the light of a ray. `normal` is a unit vector; `v` is the direction of the
    /// ray, a vector of any length.
    #[inline]
    pub fn meet(&mut self, v: [f64; 3], normal: [f64; 3], share: Share) {
        let squared = dot(v, v);
        let across = cross(normal, v);
        if dot(across, across) > NORMAL * squared {
            self.turn(across, v, squared);
        }
        let Share { s, p, cross: [re, im] } = share;
        let (m, d) = (f64::midpoint(s, p), (s - p) / 2.0);
        (self.power, self.q) = (m * self.power + d * self.q, d * self.power + m * self.q);
        (self.u, self.v) = (re * self.u - im * self.v, im * self.u + re * self.v);
    }

    /// Scales the light by a share.
    #[inline]
    pub fn dim(&mut self, share: f64) {
        for part in [&mut self.power, &mut self.q, &mut self.u, &mut self.v] {
            *part *= share;
        }
    }

    /// Reverses the z axis, as a path does behind a mirror. The sign of p changes twice: because p is k × s in the
    /// reversed frame, and because the reflected p is defined by its component along the surface.
    #[inline]
    pub(crate) fn turn_round(&mut self) {
        self.across[2] = -self.across[2];
    }

    /// Takes the light to a frame that is turned against the last one by a rotation, given by rows.
    #[inline]
    pub(crate) fn enter_frame(&mut self, rotation: &[[f64; 3]; 3]) {
        self.across = rotation.map(|row| dot(row, self.across));
    }

    /// Transforms Q and U to another plane of incidence, which is perpendicular to `across`.
    #[inline]
    fn turn(&mut self, across: [f64; 3], v: [f64; 3], squared: f64) {
        let old = std::mem::replace(&mut self.across, across);
        // The cosine and the sine of the angle between the planes, both times the lengths of the two vectors.
        let cosine = dot(old, across);
        let sine = dot(cross(old, across), v) / squared.sqrt();
        let (cosine_2, sine_2, lengths) =
            (cosine * cosine - sine * sine, 2.0 * sine * cosine, cosine * cosine + sine * sine);
        if lengths > 0.0 {
            let (cosine_2, sine_2) = (cosine_2 / lengths, sine_2 / lengths);
            (self.q, self.u) = (cosine_2 * self.q + sine_2 * self.u, cosine_2 * self.u - sine_2 * self.q);
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
