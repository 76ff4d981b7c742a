//! The reference: the exact walk in double-double numbers of 106 bits.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use twofloat::TwoFloat;

use realistic::{
    lens::{Lens, refraction::Refraction},
    numeric::in_range,
    trace::{Blocked, Direction, Path, Ray, Real},
};

/// A number of 106 bits: the unevaluated sum of two doubles (T. J. Dekker, "A floating-point technique
/// for extending the available precision", 1971).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble(TwoFloat);

impl DoubleDouble {
    /// The sum of two doubles, exactly.
    pub fn sum(high: f64, low: f64) -> Self {
        Self(TwoFloat::new_add(high, low))
    }
}

impl PartialOrd for DoubleDouble {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.partial_cmp(&other.0)
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for DoubleDouble {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}

operator!(Add add, Sub sub, Mul mul);

impl Div for DoubleDouble {
    type Output = Self;
    /// Long division in three digits of a double each. twofloat's own forms the remainder without a fused
    /// multiply-add, and its quotients hold no more than a double's digits.
    fn div(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let first = a.hi() / b.hi();
        if first == 0.0 || !first.is_finite() {
            return Self(TwoFloat::from(first));
        }
        let rest = a - b * first;
        let second = rest.hi() / b.hi();
        let third = (rest - b * second).hi() / b.hi();
        Self(TwoFloat::new_add(first, second) + third)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for DoubleDouble {
    const ZERO: Self = Self(TwoFloat::from_f64(0.0));
    const ONE: Self = Self(TwoFloat::from_f64(1.0));
    /// 2^-104: a few units in the last place of the type's own operations.
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;

    fn from_f64(number: f64) -> Self {
        Self(TwoFloat::from(number))
    }

    fn to_f64(self) -> f64 {
        self.0.hi()
    }

    fn sqrt(self) -> Self {
        let root = self.0.hi().sqrt();
        if !(root > 0.0 && root.is_finite()) {
            return Self(TwoFloat::from(root));
        }
        // One step of Newton's iteration doubles the root's digits.
        Self((self.0 - TwoFloat::new_mul(root, root)) / (2.0 * root) + root)
    }
}

/// A lens traced in double-double numbers.
#[derive(Clone, Debug)]
pub struct Reference(Path<DoubleDouble>);

/// What the reference says of a ray that gets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactRay {
    /// The point on the last surface, in the frame of its vertex (z along +z of lens space), mm.
    pub point: [DoubleDouble; 3],
    /// The unit direction after it.
    pub direction: [DoubleDouble; 3],
}

impl Reference {
    /// The reference for a lens and a direction of travel.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        Self(Path::new(lens, direction, Refraction::Fused))
    }

    /// Traces a ray whose components are taken as exact; the direction may have any length.
    ///
    /// # Errors
    /// The reason why it is blocked.
    pub fn trace(&self, ray: Ray) -> Result<ExactRay, Blocked> {
        let origin = ray.origin.map(DoubleDouble::from_f64);
        let direction = in_range(ray.direction).map(DoubleDouble::from_f64);
        let (point, direction) = self.0.trace_in_full(origin, direction)?;
        Ok(ExactRay { point, direction })
    }
}

impl ExactRay {
    /// Distance in mm between this point and that of a ray in lens space, whose last vertex lies at
    /// `vertex`.
    pub fn position_error(&self, ray: &Ray, vertex: f64) -> f64 {
        let [x, y, z] = ray.origin;
        let point = [x, y, z].map(DoubleDouble::from_f64);
        let vertex = DoubleDouble::from_f64(vertex);
        distance([point[0], point[1], point[2] - vertex], self.point)
    }

    /// Distance in mm of this point from the line of a ray in lens space with a unit direction, for models whose
    /// rays start elsewhere. This ray is one toward the scene, its last vertex the lens's first, z = 0.
    pub fn distance_from_line(&self, ray: &Ray) -> f64 {
        let origin = ray.origin.map(DoubleDouble::from_f64);
        let offset = [0, 1, 2].map(|i| self.point[i] - origin[i]);
        let moment = cross(offset, ray.direction.map(DoubleDouble::from_f64));
        distance(moment, [DoubleDouble::ZERO; 3])
    }

    /// The ray toward the scene in double precision, its last vertex the lens's first, z = 0.
    pub fn nearest(&self) -> Ray {
        let nearest = |vector: [DoubleDouble; 3]| vector.map(Real::to_f64);
        Ray { origin: nearest(self.point), direction: nearest(self.direction) }
    }

    /// Angle in rad between this direction and a unit vector.
    pub fn direction_error(&self, ray: &Ray) -> f64 {
        distance(ray.direction.map(DoubleDouble::from_f64), self.direction)
    }
}

fn cross(a: [DoubleDouble; 3], b: [DoubleDouble; 3]) -> [DoubleDouble; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn distance(a: [DoubleDouble; 3], b: [DoubleDouble; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).to_f64().powi(2)).sum::<f64>().sqrt()
}
