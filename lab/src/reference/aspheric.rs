//! What the condition of a ray at an asphere is made of: an interface by itself and a ray in; how far the ray is from
//! missing it, and how much the surface's own rounding weighs, out. By the formula of the profile, not by the walk's.

use realistic::{
    lens::{Figure, Lens, Surface, refraction::Refraction},
    prescription::{Asphere, FIRST_POWER},
    trace::{Direction, Path, Real},
};

use super::{
    double_double::{DoubleDouble, Vector, difference, norm},
    exact::ExactRay,
};

/// An aspheric interface by itself.
#[derive(Clone, Debug)]
pub(super) struct Aspheric {
    figure: Figure,
    /// 1 for light toward the scene, -1 for the other.
    sign: f64,
    /// The interface with one index on both sides: a ray goes on as it came.
    unbent: Path<DoubleDouble>,
}

/// Where a ray meets it.
pub(super) enum Met {
    /// There.
    At {
        /// Cosine of the incidence.
        cosine: f64,
        /// How fast the normal turns with the place there, 1/mm.
        steepness: f64,
        /// From the ray's point, mm.
        way: f64,
    },
    /// Nowhere.
    Nowhere {
        /// How near to the surface it comes, along the axis, mm.
        nearest: f64,
    },
}

/// Places of a ray at which its distance from the surface is looked at.
const PLACES: u32 = 400;

impl Aspheric {
    /// Of an interface's figure; `alone` is the lens that it is by itself.
    pub fn new(figure: &Figure, alone: &Lens, direction: Direction) -> Self {
        let surface = alone.surfaces[0];
        let n = if direction == Direction::SceneToFilm { surface.n_scene } else { surface.n_film };
        let surfaces = vec![Surface { n_scene: n, n_film: n, ..surface }];
        let unbent = Lens { surfaces, ..alone.clone() };
        let sign = if direction == Direction::SceneToFilm { -1.0 } else { 1.0 };
        Self { figure: *figure, sign, unbent: Path::new(&unbent, direction, Refraction::Fused) }
    }

    /// Σ |`A_i`| r^i and Σ i |`A_i`| r^(i - 1): what rounding of the terms moves and tilts the surface by.
    pub fn rounding(&self, r: f64) -> [f64; 2] {
        terms(&self.figure.asphere).fold([0.0; 2], |[moved, tilted], (power, term)| {
            [moved + term.abs() * r.powi(power), tilted + f64::from(power) * term.abs() * r.powi(power - 1)]
        })
    }

    /// Where the ray, in the frame of the vertex, meets the interface.
    pub fn met(&self, before: &ExactRay) -> Met {
        match self.unbent.trace_in_full(before.point, before.direction) {
            Ok((point, _)) => {
                let [x, y, _] = point.map(Real::to_f64);
                let [dx, dy, dz] = before.direction.map(Real::to_f64);
                let r = x.hypot(y);
                // z toward the scene is -sagitta: the normal is (slope x/r, slope y/r, 1) but for its length.
                let slope = self.slope(r);
                let across = if r > 0.0 { slope * (x * dx + y * dy) / r } else { 0.0 };
                let step = 1e-4 * self.figure.rim;
                let turn = (self.slope(r + step) - self.slope((r - step).abs())).abs() / (2.0 * step);
                let sideways = slope.abs() / r.max(step);
                Met::At {
                    cosine: (dz + across).abs() / slope.hypot(1.0),
                    steepness: turn.max(sideways).min(1e3 / self.figure.rim),
                    way: norm(difference(point, before.point)),
                }
            }
            Err(_) => Met::Nowhere { nearest: self.nearest(before) },
        }
    }

    /// How far from the surface along the axis, mm, the ray is where it may first meet it, at its own point or at the height
    /// of the surface's lowest one where that comes later; infinite inside the rim, where it is before the surface then.
    pub fn start(&self, before: &ExactRay) -> f64 {
        let [p, d]: [[f64; 3]; 2] = [before.point, before.direction].map(|v| v.map(Real::to_f64));
        let [low, high] = self.figure.bounds.sagitta;
        let lowest = if self.sign > 0.0 { -high } else { -low };
        let t = ((lowest - p[2]) / d[2]).max(0.0);
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| p[i] + t * d[i]);
        let r = x.hypot(y);
        if r < 0.999 * self.figure.rim { f64::INFINITY } else { (z + self.figure.sagitta(r)).abs() }
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

    /// Looked for where the ray is inside three times the rim.
    fn nearest(&self, before: &ExactRay) -> f64 {
        let [p, d]: [Vector; 2] = [before.point, before.direction];
        let (p, d) = (p.map(Real::to_f64), d.map(Real::to_f64));
        let reach = 4.0 * self.figure.rim + norm(before.point);
        (0..=PLACES)
            .map(|place| {
                let t = reach * (2.0 * f64::from(place) / f64::from(PLACES) - 0.5);
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
