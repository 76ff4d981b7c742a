//! Exact refraction at a single aspheric interface. Computes the refracted ray and its derivatives, the ray's margin to
//! missing the interface, and the effect of the rounding of the surface itself. It uses the profile's formula, a scan
//! for the first crossing and Snell's law in vector form, and shares nothing with the walk.

use realistic_optics::{
    lens::{Figure, Surface},
    prescription::{Asphere, FIRST_POWER},
    trace::{Blocked, Direction, Real},
};

use super::{
    double_double::{DoubleDouble, Vector, difference, norm},
    exact::ExactRay,
    scan::{Profile, Scan},
};

/// A single aspheric interface.
#[derive(Clone, Debug)]
pub(super) struct Aspheric {
    figure: Figure,
    /// 1 for light toward the scene, -1 for light toward the film.
    sign: f64,
    scan: Scan,
    /// Refractive indices before and after the interface.
    n: [f64; 2],
}

/// Distance along a ray to its first crossing of the interface, mm.
pub(super) type Crossing = Result<DoubleDouble, Blocked>;

/// The intersection of a ray with an interface.
pub(super) enum Met {
    /// The ray meets the interface.
    At {
        /// Cosine of the angle of incidence.
        cosine: f64,
        /// Rate at which the normal turns with position there, 1/mm.
        steepness: f64,
        /// Distance from the ray's point, mm.
        distance: f64,
    },
    /// The ray misses the interface.
    Nowhere {
        /// Least distance from the surface along the axis, mm.
        nearest: f64,
    },
}

/// Steps along a ray between the points at which its distance from the surface is evaluated.
const STEPS: u32 = 400;

impl Aspheric {
    /// Builds the interface of a surface with this figure.
    pub fn new(figure: &Figure, surface: &Surface, direction: Direction) -> Self {
        let n = [surface.n_scene, surface.n_film];
        let (sign, n) = match direction {
            Direction::SceneToFilm => (-1.0, n),
            Direction::FilmToScene => (1.0, [n[1], n[0]]),
        };
        Self { figure: *figure, sign, scan: Scan::new(figure, -sign), n }
    }

    /// Finds the first crossing of a ray, in the frame of the vertex, with the interface.
    pub fn crossing(&self, before: &ExactRay) -> Crossing {
        let [point, direction] = [before.point, before.direction].map(|v| self.turned(v));
        self.scan.first_crossing(point, direction)
    }

    /// Returns, in any number type, the ray after the interface, which the ray crosses at `t`. One step of Newton's
    /// method, which does not move the point, supplies the derivatives of dual numbers.
    pub fn through<R: Real>(
        &self,
        point: [R; 3],
        direction: [R; 3],
        t: DoubleDouble,
    ) -> Result<[[R; 3]; 2], Blocked> {
        let dot = |a: [R; 3], b: [R; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let length = dot(direction, direction).sqrt();
        let [start, d] = [self.turned(point), self.turned(direction).map(|d| d / length)];
        let at = |t: R| -> [R; 3] { std::array::from_fn(|i| start[i] + t * d[i]) };
        let normal = |[x, y, _]: [R; 3]| {
            let Profile { height, slope, root } = self.scan.profile(x * x + y * y);
            (height, root, [-(slope * x), -(slope * y), root])
        };
        let [high, low] = t.digits();
        let t = R::from_f64(high) + R::from_f64(low);
        let [_, _, z] = at(t);
        let (height, root, across) = normal(at(t));
        let point = at(t + (height - z) * root / dot(across, d));
        let (_, _, normal) = normal(point);
        let size = dot(normal, normal).sqrt();
        let normal = normal.map(|component| component / size);
        let [n, n_after] = self.n.map(R::from_f64);
        let cosine = n * dot(normal, d);
        let square = cosine * cosine + (n_after - n) * (n_after + n);
        if !(square > R::ZERO) {
            return Err(Blocked::Reflected);
        }
        let bend = square.sqrt() - cosine;
        let after = std::array::from_fn(|i| (n * d[i] + bend * normal[i]) / n_after);
        Ok([self.turned(point), self.turned(after)])
    }

    /// Converts a vector's z from +z of lens space to the direction of travel, or back.
    fn turned<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        [x, y, if self.sign > 0.0 { z } else { -z }]
    }

    /// Returns Σ |`A_i`| r^i and Σ i |`A_i`| r^(i - 1), which are the shift and the tilt of the surface per relative
    /// rounding error of its terms.
    pub fn rounding(&self, r: f64) -> [f64; 2] {
        terms(&self.figure.asphere).fold([0.0; 2], |[moved, tilted], (power, term)| {
            [moved + term.abs() * r.powi(power), tilted + f64::from(power) * term.abs() * r.powi(power - 1)]
        })
    }

    /// Finds the intersection of a ray, in the frame of the vertex, with the interface.
    pub fn met(&self, before: &ExactRay, crossing: Crossing) -> Met {
        match crossing {
            Ok(t) => {
                let point: Vector = std::array::from_fn(|i| before.point[i] + t * before.direction[i]);
                let [x, y, _] = point.map(Real::to_f64);
                let [dx, dy, dz] = before.direction.map(Real::to_f64);
                let r = x.hypot(y);
                // z toward the scene is -sagitta: the unnormalised normal is (slope x/r, slope y/r, 1).
                let slope = self.slope(r);
                let across = if r > 0.0 { slope * (x * dx + y * dy) / r } else { 0.0 };
                let step = 1e-4 * self.figure.rim;
                let turn = (self.slope(r + step) - self.slope((r - step).abs())).abs() / (2.0 * step);
                let sideways = slope.abs() / r.max(step);
                Met::At {
                    cosine: (dz + across).abs() / slope.hypot(1.0),
                    steepness: turn.max(sideways).min(1e3 / self.figure.rim),
                    distance: norm(difference(point, before.point)),
                }
            }
            Err(_) => Met::Nowhere { nearest: self.nearest(before) },
        }
    }

    /// Returns the margin of the start of the search, which is the ray's own point or the height of the surface's
    /// lowest point, whichever comes later. The margin is the distance along the axis, mm, between the surface and the
    /// ray at that start, divided by the amplification of an error in the height of the lowest point. It is infinite
    /// inside the clear aperture, where the start lies before the surface.
    pub fn start(&self, before: &ExactRay) -> f64 {
        let [p, d]: [[f64; 3]; 2] = [before.point, before.direction].map(|v| v.map(Real::to_f64));
        let [low, high] = self.figure.bounds.sagitta;
        let lowest = if self.sign > 0.0 { -high } else { -low };
        let t = ((lowest - p[2]) / d[2]).max(0.0);
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| p[i] + t * d[i]);
        let r = x.hypot(y);
        if r < 0.999 * self.figure.rim {
            return f64::INFINITY;
        }
        // At the equator the slope is infinite, so it is evaluated a little inside the equator.
        let steepness = self.slope(r.min(0.999 * self.figure.rim)).abs() * d[0].hypot(d[1]) / d[2].abs();
        (z + self.figure.sagitta(r)).abs() / (1.0 + steepness)
    }

    /// Returns the length, mm, to which the rounding error of the height of the surface's lowest point is relative.
    pub fn size(&self) -> f64 {
        let [low, high] = self.figure.bounds.sagitta;
        self.figure.bounds.terms_size + self.figure.rim + high - low
    }

    fn slope(&self, r: f64) -> f64 {
        let Asphere { radius, conic, .. } = self.figure.asphere;
        let root = (1.0 - (1.0 + conic) * (r / radius).powi(2)).max(1e-12).sqrt();
        let bent = r.min(self.figure.rim);
        let terms: f64 = terms(&self.figure.asphere)
            .map(|(power, term)| f64::from(power) * term * bent.powi(power - 1))
            .sum();
        r / radius / root + terms * r / bent.max(f64::MIN_POSITIVE)
    }

    /// Returns the least distance along the axis, mm, between the surface and the part of the ray that lies within
    /// three edge radii of the axis.
    fn nearest(&self, before: &ExactRay) -> f64 {
        let [p, d]: [Vector; 2] = [before.point, before.direction];
        let (p, d) = (p.map(Real::to_f64), d.map(Real::to_f64));
        let reach = 4.0 * self.figure.rim + norm(before.point);
        (0..=STEPS)
            .map(|step| {
                let t = reach * (2.0 * f64::from(step) / f64::from(STEPS) - 0.5);
                let [x, y, z]: [f64; 3] = std::array::from_fn(|i| p[i] + t * d[i]);
                let r = x.hypot(y);
                if r > 3.0 * self.figure.rim { f64::INFINITY } else { (z + self.figure.sagitta(r)).abs() }
            })
            .fold(f64::INFINITY, f64::min)
    }
}

fn terms(asphere: &Asphere) -> impl Iterator<Item = (i32, f64)> + '_ {
    (FIRST_POWER as i32..).zip(asphere.terms)
}
