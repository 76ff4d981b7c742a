//! The algorithm: rays in lanes, taken through a table step by step.
//!
//! In the frame of a surface's vertex, axis along the travel, V = n D, c = 1/R (positive when the
//! centre lies ahead), N = (-c x, -c y, 1 - c z) and K = n'² - n²:
//!
//! - f = (c/2)(x² + y² + z²) - z, g = N·V at the ray's point, e = √(g² - 2 c n² f) = n cos I and
//!   e' = √(e² + K) = n' cos I' at the hit, t V away, t = (g - e)/(c n²) = 2 f/(g + e);
//! - V' = V + (e' - e) N.
//!
//! Both roots are taken at once, in parallel, and nothing is divided on a strongly curved surface.
//! A ray that a surface blocks goes on with whatever numbers it has; the mask knows.

use super::{
    lanes::{Cpu, Lanes, Scalar},
    table::{Handover, Link, Plane, Rim, Step, Stop, Table},
};
use crate::trace::Real;

/// Rays ready for the first surface, in its vertex's frame.
#[derive(Clone, Copy)]
pub enum Start<L> {
    /// On the vertex plane, n = 1.
    Flat {
        x: L,
        y: L,
        /// s = (Vx, Vy)/Vz.
        slopes: [L; 2],
        /// 1 + s².
        stretch: L,
        /// Vz² = 1/(1 + s²).
        cos2: L,
        /// How far along the axis the ray was moved on from where it began.
        way: L,
    },
    /// Anywhere.
    Anywhere {
        x: L,
        y: L,
        minus_z: L,
        v: [L; 3],
        /// How far the ray was moved on from where it began, in units of V.
        lead: L,
    },
}

/// Rays behind the last surface, in lens space; anything in blocked lanes.
#[derive(Clone, Copy)]
pub struct End<L: Lanes> {
    pub origin: [L; 3],
    /// Unit vectors.
    pub direction: [L; 3],
    pub passed: L::Mask,
}

/// Rays on their way.
#[derive(Clone, Copy)]
pub struct Ray<L: Lanes> {
    pub(super) x: L,
    pub(super) y: L,
    pub(super) vx: L,
    pub(super) vy: L,
    pub(super) vz: L,
    /// z above the last vertex, or N_z there, as the table has it.
    pub(super) height: L,
    /// e' behind the last surface.
    pub(super) root: L,
    passed: L::Mask,
    /// The squared cosine to the axis with which they set out.
    pub cos2: L,
}

/// Takes vectors of rays through all surfaces but the first, each surface for all of them.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn march<L: Lanes, const U: usize>(cpu: Cpu<L>, table: &Table<L::Scalar>, rays: &mut [Ray<L>; U]) {
    // Loops and not closures, here and below: a closure that is not inlined would be compiled for
    // another processor than the function it stands in.
    for step in &table.steps[1..] {
        match step {
            Step::Link(link) => {
                if link.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                let none = L::Scalar::ZERO;
                match (link.rim, link.rarer) {
                    (Rim::Slope(least), false) => cross::<L, U, SLOPE, false>(cpu, link, least, rays),
                    (Rim::Slope(least), true) => cross::<L, U, SLOPE, true>(cpu, link, least, rays),
                    (Rim::Height(most), false) => cross::<L, U, HEIGHT, false>(cpu, link, most, rays),
                    (Rim::Height(most), true) => cross::<L, U, HEIGHT, true>(cpu, link, most, rays),
                    (Rim::Untested, false) => cross::<L, U, UNTESTED, false>(cpu, link, none, rays),
                    (Rim::Untested, true) => cross::<L, U, UNTESTED, true>(cpu, link, none, rays),
                }
            }
            Step::Stop(stop) => {
                for ray in &mut *rays {
                    ray.stop(cpu, stop);
                }
            }
            Step::Sphere(sphere) => {
                if sphere.tests.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                if sphere.plain {
                    for ray in &mut *rays {
                        let minus_z = ray.minus_z(cpu, &sphere.handover);
                        ray.sphere::<true>(cpu, sphere, minus_z, None);
                    }
                } else {
                    for ray in &mut *rays {
                        let minus_z = ray.minus_z(cpu, &sphere.handover);
                        ray.sphere::<false>(cpu, sphere, minus_z, None);
                    }
                }
            }
            Step::Renewal(length) => {
                for ray in &mut *rays {
                    ray.scale_to(cpu, *length);
                }
            }
            Step::Plane(plane) => {
                for ray in &mut *rays {
                    let minus_z = ray.minus_z(cpu, &plane.handover);
                    ray.plane::<false>(cpu, plane, minus_z, None);
                }
            }
        }
    }
}

/// How a link's rim is told: [`Rim`] as a constant.
const UNTESTED: u8 = 0;
const HEIGHT: u8 = 1;
const SLOPE: u8 = 2;

#[cfg_attr(not(debug_assertions), inline(always))]
fn cross<L: Lanes, const U: usize, const RIM: u8, const RARER: bool>(
    cpu: Cpu<L>,
    link: &Link<L::Scalar>,
    rim: L::Scalar,
    rays: &mut [Ray<L>; U],
) {
    for ray in rays {
        ray.link::<RIM, RARER>(cpu, link, rim);
    }
}

impl<L: Lanes> Ray<L> {
    /// Through the first surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn enter(cpu: Cpu<L>, table: &Table<L::Scalar>, start: Start<L>) -> Self {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        match (&table.steps[0], start) {
            (Step::Sphere(sphere), Start::Flat { x, y, slopes, stretch, cos2, way }) => {
                let vz = cos2.sqrt();
                let mut ray = Self::at(cpu, [x, y], [slopes[0] * vz, slopes[1] * vz, vz], cos2);
                ray.first_sphere(cpu, sphere, slopes, stretch, way);
                ray
            }
            (Step::Plane(plane), Start::Flat { x, y, slopes, cos2, way, .. }) => {
                let vz = cos2.sqrt();
                let mut ray = Self::at(cpu, [x, y], [slopes[0] * vz, slopes[1] * vz, vz], cos2);
                ray.plane::<true>(cpu, plane, zero, Some(way));
                ray
            }
            (Step::Sphere(sphere), Start::Anywhere { x, y, minus_z, v, lead }) => {
                let mut ray = Self::at(cpu, [x, y], v, v[2] * v[2]);
                if sphere.tests.forward {
                    ray.go_forward(cpu);
                }
                ray.sphere::<false>(cpu, sphere, minus_z, Some(lead));
                ray
            }
            (Step::Plane(plane), Start::Anywhere { x, y, minus_z, v, lead }) => {
                let mut ray = Self::at(cpu, [x, y], v, v[2] * v[2]);
                ray.plane::<false>(cpu, plane, minus_z, Some(lead));
                ray
            }
            (Step::Link(_) | Step::Stop(_) | Step::Renewal(_), _) => {
                unreachable!("the first step meets the ray anywhere")
            }
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn at(cpu: Cpu<L>, [x, y]: [L; 2], [vx, vy, vz]: [L; 3], cos2: L) -> Self {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        Self { x, y, vx, vy, vz, height: zero, root: zero, passed: zero.less_equal(zero), cos2 }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn keep(&mut self, mask: L::Mask) {
        self.passed = L::both(self.passed, mask);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn go_forward(&mut self, cpu: Cpu<L>) {
        self.keep(L::splat(cpu, L::Scalar::ZERO).less(self.vz));
    }

    /// The root's argument must be a number well above 0: neither missed nor totally reflected.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn keep_root(&mut self, cpu: Cpu<L>, square: L) {
        self.keep(L::splat(cpu, L::Scalar::NO_SQUARE).less(square));
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn minus_z(&self, cpu: Cpu<L>, handover: &Handover<L::Scalar>) -> L {
        self.height.mul_add(L::splat(cpu, handover.factor), L::splat(cpu, handover.offset))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn height_squared(&self) -> L {
        self.y.mul_add(self.y, self.x * self.x)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn advance(&mut self, t: L) {
        self.x = t.mul_add(self.vx, self.x);
        self.y = t.mul_add(self.vy, self.y);
    }

    /// V + G N.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn bend(&mut self, minus_c: L, gain: L, slope: L) {
        let k = minus_c * gain;
        self.vx = k.mul_add(self.x, self.vx);
        self.vy = k.mul_add(self.y, self.vy);
        self.vz = gain.mul_add(slope, self.vz);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn link<const RIM: u8, const RARER: bool>(
        &mut self,
        cpu: Cpu<L>,
        link: &Link<L::Scalar>,
        rim: L::Scalar,
    ) {
        let (alpha, rho) = (L::splat(cpu, link.alpha), L::splat(cpu, link.rho));
        let minus_2phi =
            self.height.mul_add(L::splat(cpu, link.minus_2phi1), L::splat(cpu, link.minus_2phi0));
        let g = alpha.mul_add(self.vz, rho * self.root);
        let square = g.mul_add(g, minus_2phi);
        // Not square + K: the two roots then need not wait for each other.
        let square_after = g.mul_add(g, minus_2phi + L::splat(cpu, link.index_step));
        let [before, after] = L::sqrt_pair(square, square_after);
        let delta = g - before;
        let slope = delta.neg_mul_add(self.vz * L::splat(cpu, link.per_n2), rho.mul_add(self.height, alpha));
        self.advance(delta * L::splat(cpu, link.per_cn2));
        self.bend(L::splat(cpu, link.minus_c), after - before, slope);
        (self.height, self.root) = (slope, after);
        self.keep_root(cpu, if RARER { square_after } else { square });
        match RIM {
            SLOPE => self.keep(L::splat(cpu, rim).less_equal(slope)),
            HEIGHT => self.keep(self.height_squared().less_equal(L::splat(cpu, rim))),
            _ => {}
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn plane<const FLAT: bool>(
        &mut self,
        cpu: Cpu<L>,
        plane: &Plane<L::Scalar>,
        minus_z: L,
        lead: Option<L>,
    ) {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let mut t = zero;
        if !FLAT {
            t = minus_z / self.vz;
            self.advance(t);
        }
        if plane.tested {
            self.keep(self.height_squared().less_equal(L::splat(cpu, plane.aperture)));
        }
        let square = self.vz * self.vz;
        let square_after = self.vz.mul_add(self.vz, L::splat(cpu, plane.index_step));
        self.keep_root(cpu, if plane.index_step < L::Scalar::ZERO { square_after } else { square });
        if plane.tests.forward {
            self.go_forward(cpu);
        }
        if plane.tests.onward {
            let slack = L::splat(cpu, -plane.slack);
            let slack = if FLAT { self.vz * slack } else { slack };
            self.keep(slack.less_equal(lead.unwrap_or(zero) + t));
        }
        self.root = square_after.sqrt();
        self.vz = self.root;
        self.height = zero;
    }

    /// |z (Vx, Vy) + Vz (x, y)| <= a Vz, z the way to the stop: no move and no division.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn stop(&mut self, cpu: Cpu<L>, stop: &Stop<L::Scalar>) {
        let ahead = self.minus_z(cpu, &stop.handover);
        let x = ahead.mul_add(self.vx, self.x * self.vz);
        let y = ahead.mul_add(self.vy, self.y * self.vz);
        let limit = (self.vz * self.vz) * L::splat(cpu, stop.aperture);
        self.keep(y.mul_add(y, x * x).less_equal(limit));
    }

    /// One step of Newton's iteration for what V is to be multiplied with; V has the length n but for rounding.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn factor(&self, cpu: Cpu<L>, length: [L::Scalar; 2]) -> L {
        let square = self.vz.mul_add(self.vz, self.vy.mul_add(self.vy, self.vx * self.vx));
        square.mul_add(L::splat(cpu, length[1]), L::splat(cpu, length[0]))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scale_to(&mut self, cpu: Cpu<L>, length: [L::Scalar; 2]) {
        let factor = self.factor(cpu, length);
        (self.vx, self.vy, self.vz) = (self.vx * factor, self.vy * factor, self.vz * factor);
    }

    /// To lens space, the direction made a unit vector by one step of Newton's iteration: V is one but for rounding.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn leave(self, cpu: Cpu<L>, table: &Table<L::Scalar>) -> End<L> {
        let z = self.height.mul_add(L::splat(cpu, table.exit.factor), L::splat(cpu, table.exit.offset));
        let factor = self.factor(cpu, table.unit);
        let along = factor * L::splat(cpu, L::Scalar::from_f64(table.sense));
        End {
            origin: [self.x, self.y, z],
            direction: [self.vx * factor, self.vy * factor, self.vz * along],
            passed: self.passed,
        }
    }
}
