//! Exact refraction or reflection at a single interface. Computes the ray behind it and its derivatives, the ray's margin
//! to missing the interface, and the effect of the rounding of the surface itself. It uses the surface's formula, a scan
//! for the first crossing and Snell's law in vector form, and shares nothing with the walk.

use realistic_optics::{
    lens::Surface,
    prescription::Unsymmetric,
    trace::{Blocked, Real},
};

use super::{
    exact::dot,
    form::terms,
    scan::{Near, Scan},
};

/// A single interface.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    scan: Scan,
    /// 1 for light that arrives toward +z, -1 for light that arrives toward -z.
    sign: f64,
    /// Refractive indices before and after the interface.
    n: [f64; 2],
    is_mirror: bool,
    /// Whether this is a plane in one medium.
    only_limits: bool,
    /// The terms of the figure: their powers of the distance from the axis, and their coefficients.
    terms: Vec<(i32, f64)>,
    /// Clear semi-diameter, mm.
    rim: f64,
    /// Distance from the axis up to which rays may meet the surface, mm.
    reach: f64,
    /// z of the surface's lowest point inside the clear aperture, z along the light.
    lowest: f64,
    /// The length, mm, to which the rounding error of the height of the surface's lowest point is relative.
    pub size: f64,
}

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

impl Sheet {
    /// Builds the interface of a surface, which light meets toward +z if `sign` is 1 and toward -z if it is -1, between
    /// media of the indices `n`.
    pub fn new(surface: &Surface, sign: f64, n: [f64; 2]) -> Self {
        // Sagittae of a surface are positive toward +z.
        let [low, high] = surface.sagitta_range();
        let rim = surface.semi_diameter;
        let (terms, reach) = match (&surface.figure, &surface.unsymmetric) {
            (Some(figure), _) => (terms(&figure.asphere).collect(), 3.0 * rim),
            (None, Some(figure)) => {
                let terms = match &figure.surface {
                    Unsymmetric::Toroid(toroid) => (1..).map(|i| 2 * i).zip(toroid.terms).collect(),
                    Unsymmetric::Biconic(_) => Vec::new(),
                };
                (terms, figure.reach)
            }
            (None, None) => (Vec::new(), 3.0 * rim),
        };
        let terms_size = surface.figure.map_or(0.0, |figure| figure.bounds.terms_size);
        Self {
            scan: Scan::new(surface, -sign),
            sign,
            n,
            is_mirror: surface.is_mirror,
            only_limits: surface.only_limits(),
            terms,
            rim,
            reach,
            lowest: if sign > 0.0 { low } else { -high },
            size: terms_size + rim + high - low,
        }
    }

    /// Finds the first crossing of a ray, in the frame of the vertex, with the interface: the distance along the ray, mm.
    pub fn crossing<R: Real>(&self, point: [R; 3], direction: [R; 3]) -> Result<R, Blocked> {
        self.scan.first_crossing(self.turned(point), self.turned(direction), self.only_limits)
    }

    /// Returns, in any number type, the ray after the interface, which the ray crosses at `t`. One step of Newton's
    /// method, which does not move the point, supplies the derivatives of dual numbers.
    pub fn through<R: Real>(&self, point: [R; 3], direction: [R; 3], t: R) -> Result<[[R; 3]; 2], Blocked> {
        let length = dot(direction, direction).sqrt();
        let [start, d] = [self.turned(point), self.turned(direction).map(|d| d / length)];
        let at = |t: R| -> [R; 3] { std::array::from_fn(|i| start[i] + t * d[i]) };
        let Near { residual, normal } = self.scan.near(at(t));
        let point = at(t + residual / dot(normal, d));
        let Near { normal, .. } = self.scan.near(point);
        let size = dot(normal, normal).sqrt();
        let normal = normal.map(|component| component / size);
        if self.is_mirror {
            let twice = R::from_f64(2.0) * dot(normal, d);
            let after = std::array::from_fn(|i| d[i] - twice * normal[i]);
            return Ok([self.turned(point), self.turned(after)]);
        }
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

    /// Converts a vector's z to the direction of travel, or back.
    fn turned<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        [x, y, if self.sign > 0.0 { z } else { -z }]
    }

    /// Returns Σ |`A_i`| r^i and Σ i |`A_i`| r^(i - 1), which are the shift and the tilt of the surface per relative
    /// rounding error of its terms.
    pub fn rounding(&self, r: f64) -> [f64; 2] {
        self.terms.iter().fold([0.0; 2], |[moved, tilted], &(power, term)| {
            [moved + term.abs() * r.powi(power), tilted + f64::from(power) * term.abs() * r.powi(power - 1)]
        })
    }

    /// Finds the intersection of a ray, in the frame of the vertex, with the interface; `crossing` is the distance to it.
    pub fn met<R: Real>(&self, point: [R; 3], direction: [R; 3], crossing: Result<R, Blocked>) -> Met {
        let [p, d] = [point, direction].map(|v| self.turned(v.map(R::to_f64)));
        let Ok(t) = crossing.map(R::to_f64) else { return Met::Nowhere { nearest: self.nearest(p, d) } };
        let [x, y, _] = std::array::from_fn(|i| p[i] + t * d[i]);
        let [slope_x, slope_y] = self.slopes([x, y]);
        let step = 1e-4 * self.rim;
        let turn = |[dx, dy]: [f64; 2]| {
            let [ahead_x, ahead_y] = self.slopes([x + step * dx, y + step * dy]);
            (ahead_x - slope_x).hypot(ahead_y - slope_y) / step
        };
        // Along and across the line from the axis, toward which every figure exists.
        let r = x.hypot(y);
        let inward = if r > 0.0 { [-x / r, -y / r] } else { [1.0, 0.0] };
        let steepness = turn(inward).max(turn([inward[1], -inward[0]]));
        Met::At {
            cosine: (d[2] - slope_x * d[0] - slope_y * d[1]).abs() / slope_x.hypot(slope_y).hypot(1.0),
            steepness: steepness.min(1e3 / self.rim),
            distance: t.abs(),
        }
    }

    /// Returns the derivatives of the height, z along the light. Beyond an equator they are very large.
    fn slopes(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Near { normal: [nx, ny, nz], .. } = self.scan.near([x, y, self.scan.height([x, y])]);
        [nx, ny].map(|part| -part / nz.max(1e-6))
    }

    /// Returns the margin of the start of the search, which is the ray's own point or the height of the surface's
    /// lowest point, whichever comes later. The margin is the distance along the axis, mm, between the surface and the
    /// ray at that start, divided by the amplification of an error in the height of the lowest point. It is infinite
    /// inside the clear aperture, where the start lies before the surface.
    pub fn start<R: Real>(&self, point: [R; 3], direction: [R; 3]) -> f64 {
        let [p, d] = [point, direction].map(|v| self.turned(v.map(R::to_f64)));
        let t = ((self.lowest - p[2]) / d[2]).max(0.0);
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| p[i] + t * d[i]);
        if x.hypot(y) < 0.999 * self.rim {
            return f64::INFINITY;
        }
        // At the equator the slope is infinite, so it is evaluated a little inside the equator.
        let inside = (0.999 * self.rim / x.hypot(y)).min(1.0);
        let [slope_x, slope_y] = self.slopes([inside * x, inside * y]);
        let steepness = slope_x.hypot(slope_y) * d[0].hypot(d[1]) / d[2].abs();
        (z - self.scan.height([x, y])).abs() / (1.0 + steepness)
    }

    /// Returns the least distance along the axis, mm, between the surface and the part of the ray that lies within
    /// the reach.
    fn nearest(&self, p: [f64; 3], d: [f64; 3]) -> f64 {
        let reach = 4.0 * self.rim + p[0].hypot(p[1]).hypot(p[2]);
        (0..=STEPS)
            .map(|step| {
                let t = reach * (2.0 * f64::from(step) / f64::from(STEPS) - 0.5);
                let [x, y, z]: [f64; 3] = std::array::from_fn(|i| p[i] + t * d[i]);
                if x.hypot(y) > self.reach { f64::INFINITY } else { (z - self.scan.height([x, y])).abs() }
            })
            .fold(f64::INFINITY, f64::min)
    }
}
