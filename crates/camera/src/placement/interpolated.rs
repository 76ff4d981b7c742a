//! The transform of a moving camera at each ray's time, in lanes: the interpolation of [`Moving`], but
//! without computing a quaternion per ray.
//!
//! Let a be the fraction of the motion's duration, h half the angle between the two rotations R0 and R1, k
//! the axis of R0⁻¹ R1, and K the matrix with K v = k × v. The great arc between the quaternions is R(a) = R0
//! (I + 2 sin ha cos ha K + 2 sin² ha K²) (O. Rodrigues 1840). With the stretch (1 - a) S0 + a S1, the
//! transform is a sum of six matrices that are known beforehand,
//!
//! M(a) = Σ f(a) M, f = 1 - a, a, (1 - a) sc, a sc, (1 - a) ss, a ss, with sc = sin ha cos ha, ss = sin² ha,
//!
//! and no term exceeds the sum by more than a factor of a rotation's entries. Sine and cosine are Taylor
//! series in a², with ha <= π/2; their terms alternate in sign and shrink, so that the truncation error is
//! less than the first omitted term. The series end where a term is below an eighth of a rounding error:
//! after at most 11 terms each in double precision and 7 in single, fewer for a small rotation.
//!
//! Entries differ from those of the spherical interpolation in double precision by at most sixteen machine
//! epsilons of the largest entry: 3.6e-15 in double precision, 1.9e-6 in single (tested).

use glam::{DMat3, DVec3};

use super::{
    motion::{MotionParts, Moving},
    shutter::time_at,
    transform::largest_entry,
};
use realistic_simd::{Compiled, Cpu, Lanes};
use realistic_trace::kernel::KernelScalar;

/// The transform of a moving camera; the linear part is stored divided by a scale.
#[derive(Clone, Debug)]
pub struct Interpolated<S> {
    shutter: [f32; 2],
    start: S,
    duration: S,
    /// Position of the camera-space origin at both ends of the motion.
    origins: [[S; 2]; 3],
    /// Coefficients of the six factors for each entry of the matrix, by rows.
    linear: [[[S; 6]; 3]; 3],
    /// Coefficients of (sin ha)/a and cos ha as polynomials in a², the highest power first.
    sine: Box<[S]>,
    cosine: Box<[S]>,
    /// A power of two by which the linear part is divided.
    scale: f64,
    /// Factor by which points are multiplied first: the units of camera space per unit of the points, times
    /// the scale.
    before: S,
    /// Largest matrix entries at both ends of the motion, divided by the scale.
    sizes: [S; 2],
    /// Whether directions stay unit vectors up to rounding.
    is_rigid: bool,
}

/// Rays transformed to the world.
#[derive(Clone, Copy, Debug)]
pub struct PlacedRays<L> {
    pub point: [L; 3],
    /// Directions, not normalised, whose squared lengths are in the number range.
    pub direction: [L; 3],
    /// Ratio of the length that the transform gives a direction to the length of `direction`.
    pub stretch: L,
}

/// Largest number of lanes of any vector.
const MOST_LANES: usize = 16;

impl<S: KernelScalar> Interpolated<S> {
    /// Prepares a motion for times in a shutter's interval and for points whose unit is `units` units of
    /// camera space.
    pub fn new(moving: &Moving, shutter: [f32; 2], units: f64) -> Self {
        let Moving { ends, parts: [from, to], start, duration } = moving;
        let is_rigid = ends.iter().all(|end| end.is_rigid());
        // The scale lies between the sizes of both ends, so that numbers are in range at either end.
        let [first, last] = ends.each_ref().map(|end| largest_entry(end.linear()));
        let scale = if is_rigid { 1.0 } else { (first * last).sqrt().log2().floor().exp2() };
        let (half, axis) = turn(from, to);
        let cross = DMat3::from_cols(
            DVec3::new(0.0, axis.z, -axis.y),
            DVec3::new(-axis.z, 0.0, axis.x),
            DVec3::new(axis.y, -axis.x, 0.0),
        );
        let rotation = DMat3::from_quat(from.rotation);
        let (once, twice) = (rotation * cross * 2.0, rotation * cross * cross * 2.0);
        let [s0, s1] = [from.stretch, to.stretch];
        // The first end enters as given, not as the product of its parts.
        let matrices = [ends[0].linear(), rotation * s1, once * s0, once * s1, twice * s0, twice * s1];
        let entry =
            |row: usize, column: usize| matrices.map(|matrix| S::from_f64(matrix.col(column)[row] / scale));
        let series = |first: f64, power: usize| taylor(first, half, power, S::EPSILON / 8.0);
        Self {
            shutter,
            start: S::from_f64(*start),
            duration: S::from_f64(*duration),
            origins: [0, 1, 2].map(|k| [from.origin[k], to.origin[k]].map(S::from_f64)),
            linear: [0, 1, 2].map(|row| [0, 1, 2].map(|column| entry(row, column))),
            sine: series(half, 1),
            cosine: series(1.0, 0),
            scale,
            before: S::from_f64(units * scale),
            sizes: [first / scale, last / scale].map(S::from_f64),
            is_rigid,
        }
    }

    /// Whether directions stay unit vectors up to rounding.
    pub fn is_rigid(&self) -> bool {
        self.is_rigid
    }

    /// Transforms points and directions to the world at the given fractions of the shutter's interval. It is
    /// compiled once for all models and groups.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        [x, y, z]: [L; 3],
        direction: [L; 3],
        time_numbers: &[f32],
    ) -> PlacedRays<L> {
        let before = L::splat(cpu, self.before);
        let mut rays = PlacedRays { point: [x * before, y * before, z * before], direction, stretch: x };
        L::apart(cpu, Placing { cpu, to_world: self, time_numbers, rays: &mut rays });
        rays
    }

    /// Computes [`Self::lanes`], inlined, for points that have already been multiplied by the factor.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn placed<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        [x, y, z]: [L; 3],
        [dx, dy, dz]: [L; 3],
        time_numbers: &[f32],
    ) -> PlacedRays<L> {
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        // Computes exactly the times that the rays carry.
        let mut times = [0.0; MOST_LANES];
        for (time, number) in times[..L::WIDTH].iter_mut().zip(time_numbers) {
            *time = time_at(self.shutter, *number);
        }
        let time = L::load_single(cpu, &times[..L::WIDTH]);
        let a = ((time - L::splat(cpu, self.start)) / L::splat(cpu, self.duration)).larger(zero).smaller(one);
        let b = one - a;
        let square = a * a;
        let (sine, cosine) = (a * horner(cpu, &self.sine, square), horner(cpu, &self.cosine, square));
        let (sc, ss) = (sine * cosine, sine * sine);
        let factors = [b, a, b * sc, a * sc, b * ss, a * ss];
        let (mut point, mut direction) = ([x; 3], [dx; 3]);
        let mut row = 0;
        while row < 3 {
            let [from, to] = self.origins[row];
            let [xx, yy, zz] = &self.linear[row];
            let (xx, yy, zz) = (sum(cpu, xx, &factors), sum(cpu, yy, &factors), sum(cpu, zz, &factors));
            let origin = b.mul_add(L::splat(cpu, from), a * L::splat(cpu, to));
            point[row] = x.mul_add(xx, y.mul_add(yy, z.mul_add(zz, origin)));
            direction[row] = dx.mul_add(xx, dy.mul_add(yy, dz * zz));
            row += 1;
        }
        if self.is_rigid {
            return PlacedRays { point, direction, stretch: one };
        }
        // From one end of the motion to the other, lengths may change by many powers of ten, so directions
        // are divided by a length that changes linearly.
        let [first, last] = self.sizes;
        let size = b.mul_add(L::splat(cpu, first), a * L::splat(cpu, last));
        let shorter = one / size;
        let [u, v, w] = direction;
        let direction = [u * shorter, v * shorter, w * shorter];
        PlacedRays { point, direction, stretch: size * L::splat(cpu, S::from_f64(self.scale)) }
    }
}

/// The work of [`Interpolated::lanes`].
struct Placing<'a, L: Lanes> {
    cpu: Cpu<L>,
    to_world: &'a Interpolated<L::Scalar>,
    time_numbers: &'a [f32],
    rays: &'a mut PlacedRays<L>,
}

impl<L: Lanes<Scalar: KernelScalar>> Compiled for Placing<'_, L> {
    #[inline(always)]
    fn run(self) {
        let PlacedRays { point, direction, .. } = *self.rays;
        *self.rays = self.to_world.placed(self.cpu, point, direction, self.time_numbers);
    }
}

/// Returns half the angle from one rotation to the other along the shorter arc, 0 to π/2, and the axis of
/// this rotation in the frame of `from`; the axis is the zero vector if the angle is 0.
fn turn(from: &MotionParts, to: &MotionParts) -> (f64, DVec3) {
    let end = if from.rotation.dot(to.rotation) < 0.0 { -to.rotation } else { to.rotation };
    let relative = from.rotation.conjugate() * end;
    let along = DVec3::new(relative.x, relative.y, relative.z);
    (along.length().atan2(relative.w), along.normalize_or_zero())
}

/// Returns the terms of the Taylor series of the sine (from power 1) or the cosine (from power 0) that exceed
/// `least`, the highest power first.
fn taylor<S: KernelScalar>(first: f64, half: f64, mut power: usize, least: f64) -> Box<[S]> {
    let mut terms = vec![S::from_f64(first)];
    let mut term = first;
    loop {
        term *= -half * half / ((power + 1) * (power + 2)) as f64;
        power += 2;
        if !(term.abs() > least) {
            break;
        }
        terms.push(S::from_f64(term));
    }
    terms.reverse();
    terms.into()
}

/// Evaluates a polynomial whose coefficients are given from the highest power on.
#[cfg_attr(not(debug_assertions), inline(always))]
fn horner<L: Lanes>(cpu: Cpu<L>, coefficients: &[L::Scalar], at: L) -> L {
    let mut value = L::splat(cpu, coefficients[0]);
    for &coefficient in &coefficients[1..] {
        value = value.mul_add(at, L::splat(cpu, coefficient));
    }
    value
}

/// Returns the sum of the products of `factors` and `numbers`.
#[cfg_attr(not(debug_assertions), inline(always))]
fn sum<L: Lanes>(cpu: Cpu<L>, numbers: &[L::Scalar; 6], factors: &[L; 6]) -> L {
    let mut sum = factors[5] * L::splat(cpu, numbers[5]);
    let mut k = 5;
    while k > 0 {
        k -= 1;
        sum = factors[k].mul_add(L::splat(cpu, numbers[k]), sum);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::{motion::CameraMotion, transform::CameraToWorld};
    use realistic_simd::{OneLane, Portable};

    /// Returns the position of a point and the directions of the axes in lanes, at a time from 0 to 1.
    fn placed<S: KernelScalar>(motion: &CameraMotion, point: DVec3, time: f32) -> [DVec3; 4]
    where
        Portable<S, 1>: Lanes<Scalar = S>,
    {
        let CameraMotion::Moving(moving) = motion else { panic!("it moves") };
        let interpolated = Interpolated::<S>::new(moving, [0.0, 1.0], 1.0);
        let lanes = |v: DVec3| [v.x, v.y, v.z].map(|number| Portable([S::from_f64(number)]));
        let number = |Portable([number]): Portable<S, 1>| number.to_f64();
        let moved = |point: DVec3, direction: DVec3| {
            interpolated.lanes(OneLane::cpu(), lanes(point), lanes(direction), &[time])
        };
        let at = DVec3::from(moved(point, DVec3::X).point.map(number));
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let PlacedRays { direction, stretch, .. } = moved(DVec3::ZERO, axis);
            DVec3::from(direction.map(number)) * number(stretch)
        });
        [at, x, y, z]
    }

    fn motions() -> Vec<CameraMotion> {
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.4, 1.0, 0.0), DVec3::new(0.0, -0.2, 1.0));
        let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        let axis = DVec3::new(0.6, -0.48, 0.64);
        let turned = |angle: f64| DMat3::from_axis_angle(axis, angle);
        let pairs = [
            (DMat3::IDENTITY, turned(1e-9)),
            (DMat3::IDENTITY, DMat3::IDENTITY * 1e6),
            (turned(0.3), turned(0.7) * shear),
            (turned(3.0) * mirror, turned(-3.0) * mirror * 1e-9),
            (DMat3::IDENTITY * 1e-30, turned(0.5) * 1e15),
            (turned(-1.0), turned(2.14)),
            (shear * 1e3, turned(2.0) * shear),
            (DMat3::from_rotation_x(1.0), DMat3::from_rotation_z(-1.5)),
        ];
        let origins = [DVec3::new(3.0, -2.0, 8.0), DVec3::new(-1.0, 5.0, 7.0)];
        let motion = |(from, to): (DMat3, DMat3)| {
            let [from, to] = [(from, origins[0]), (to, origins[1])]
                .map(|(linear, origin)| CameraToWorld::from_parts(linear, origin));
            CameraMotion::between((from, 0.125), (to, 0.875)).expect("a motion")
        };
        pairs.map(motion).into()
    }

    /// Returns the largest difference from the spherical interpolation, relative to the largest entry and to
    /// the lengths of the points.
    fn worst<S: KernelScalar>() -> f64
    where
        Portable<S, 1>: Lanes<Scalar = S>,
    {
        let point = DVec3::new(0.2, 0.7, -0.4);
        let mut worst = 0.0_f64;
        for motion in motions() {
            for step in 0..=64_u8 {
                let time = f32::from(step) / 64.0;
                let exact = motion.at(time);
                let [at, axes @ ..] = placed::<S>(&motion, point, time);
                let entries = exact.linear().to_cols_array();
                let largest = entries.into_iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
                for (axis, column) in axes.into_iter().zip(exact.linear().to_cols_array_2d()) {
                    worst = worst.max((axis - DVec3::from(column)).abs().max_element() / largest);
                }
                let expected = exact.point(point);
                let scale = largest + exact.origin().length();
                worst = worst.max((at - expected).abs().max_element() / scale);
            }
        }
        worst
    }

    #[test]
    fn lanes_are_the_spherical_interpolation() {
        let [double, single] = [worst::<f64>(), worst::<f32>()];
        assert!(double < 16.0 * f64::EPSILON, "{double:e}");
        assert!(single < 16.0 * f64::from(f32::EPSILON), "{single:e}");
    }

    #[test]
    fn series_end_where_rounding_hides_the_next_term() {
        for (half, least) in [(std::f64::consts::FRAC_PI_2, 11), (0.1, 6), (1e-9, 1), (0.0, 1)] {
            let sine = taylor::<f64>(half, half, 1, f64::EPSILON / 8.0);
            let cosine = taylor::<f64>(1.0, half, 0, f64::EPSILON / 8.0);
            assert!(
                sine.len() <= least && cosine.len() <= least + 1,
                "{half}: {} {}",
                sine.len(),
                cosine.len()
            );
            for a in [0.0, 0.3, 1.0_f64] {
                let value = |terms: &[f64]| terms.iter().fold(0.0, |sum, term| sum * a * a + term);
                assert!((a * value(&sine) - (half * a).sin()).abs() < 3e-16);
                assert!((value(&cosine) - (half * a).cos()).abs() < 3e-16);
            }
        }
    }
}
