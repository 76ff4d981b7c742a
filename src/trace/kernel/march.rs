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
    table::{Handover, Link, Plane, Rim, Sphere, Step, Stop, Table},
};
use crate::trace::Real;

/// Rays ready for the first surface, in its vertex's frame.
#[derive(Clone, Copy)]
pub struct Start<L> {
    pub x: L,
    pub y: L,
    /// Minus z; not looked at where the batch says that its rays start on the vertex plane.
    pub minus_z: L,
    pub v: [L; 3],
    /// How far the ray was moved on from where it began, in units of V.
    pub lead: L,
}

/// Rays behind the last surface, in lens space; all +0 in blocked lanes.
#[derive(Clone, Copy)]
pub struct End<L: Lanes> {
    pub origin: [L; 3],
    /// Unit vectors.
    pub direction: [L; 3],
    pub passed: L::Mask,
}

#[derive(Clone, Copy)]
struct Ray<L: Lanes> {
    x: L,
    y: L,
    vx: L,
    vy: L,
    vz: L,
    /// z above the last vertex, or N_z there, as the table has it.
    height: L,
    /// e' behind the last surface.
    root: L,
    passed: L::Mask,
}

/// Takes `U` vectors of rays through the lens, interleaved. `FLAT`: they start on the first vertex plane.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn march<L: Lanes, const U: usize, const FLAT: bool>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    starts: [Start<L>; U],
) -> [End<L>; U] {
    let Some((first, rest)) = table.steps.split_first() else {
        unreachable!("a lens has at least one surface");
    };
    // Loops and not closures, here and below: a closure that is not inlined would be compiled for
    // another processor than the function it stands in.
    let mut rays = [enter::<L, FLAT>(cpu, first, starts[0]); U];
    for u in 1..U {
        rays[u] = enter::<L, FLAT>(cpu, first, starts[u]);
    }
    for step in rest {
        match step {
            Step::Link(link) => {
                if link.forward {
                    for ray in &mut rays {
                        ray.go_forward(cpu);
                    }
                }
                match (link.rim, link.rarer) {
                    (Rim::Slope(least), false) => cross::<L, U, true, false>(cpu, link, least, &mut rays),
                    (Rim::Slope(least), true) => cross::<L, U, true, true>(cpu, link, least, &mut rays),
                    (Rim::Height(most), false) => cross::<L, U, false, false>(cpu, link, most, &mut rays),
                    (Rim::Height(most), true) => cross::<L, U, false, true>(cpu, link, most, &mut rays),
                }
            }
            Step::Stop(stop) => {
                for ray in &mut rays {
                    ray.stop(cpu, stop);
                }
            }
            Step::Sphere(sphere) => {
                for ray in &mut rays {
                    let minus_z = ray.minus_z(cpu, &sphere.handover);
                    ray.sphere::<false>(cpu, sphere, minus_z, None);
                }
            }
            Step::Plane(plane) => {
                for ray in &mut rays {
                    let minus_z = ray.minus_z(cpu, &plane.handover);
                    ray.plane::<false>(cpu, plane, minus_z, None);
                }
            }
        }
    }
    let mut ends = [rays[0].leave(cpu, table); U];
    for u in 1..U {
        ends[u] = rays[u].leave(cpu, table);
    }
    ends
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn enter<L: Lanes, const FLAT: bool>(cpu: Cpu<L>, first: &Step<L::Scalar>, start: Start<L>) -> Ray<L> {
    let Start { x, y, minus_z, v: [vx, vy, vz], lead } = start;
    let zero = L::splat(cpu, L::Scalar::ZERO);
    let passed = zero.less_equal(zero);
    let mut ray = Ray { x, y, vx, vy, vz, height: zero, root: zero, passed };
    match first {
        Step::Sphere(sphere) => ray.sphere::<FLAT>(cpu, sphere, minus_z, Some(lead)),
        Step::Plane(plane) => ray.plane::<FLAT>(cpu, plane, minus_z, Some(lead)),
        Step::Link(_) | Step::Stop(_) => unreachable!("the first step meets the ray anywhere"),
    }
    ray
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn cross<L: Lanes, const U: usize, const SLOPE: bool, const RARER: bool>(
    cpu: Cpu<L>,
    link: &Link<L::Scalar>,
    rim: L::Scalar,
    rays: &mut [Ray<L>; U],
) {
    for ray in rays {
        ray.link::<SLOPE, RARER>(cpu, link, rim);
    }
}

impl<L: Lanes> Ray<L> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn keep(&mut self, mask: L::Mask) {
        self.passed = L::both(self.passed, mask);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn go_forward(&mut self, cpu: Cpu<L>) {
        self.keep(L::splat(cpu, L::Scalar::ZERO).less(self.vz));
    }

    /// The root's argument must be a number well above 0: neither missed nor totally reflected.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn keep_root(&mut self, cpu: Cpu<L>, square: L) {
        self.keep(L::splat(cpu, L::Scalar::NO_SQUARE).less(square));
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn minus_z(&self, cpu: Cpu<L>, handover: &Handover<L::Scalar>) -> L {
        self.height.mul_add(L::splat(cpu, handover.factor), L::splat(cpu, handover.offset))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn height_squared(&self) -> L {
        self.y.mul_add(self.y, self.x * self.x)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn advance(&mut self, t: L) {
        self.x = t.mul_add(self.vx, self.x);
        self.y = t.mul_add(self.vy, self.y);
    }

    /// V + G N.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bend(&mut self, c: L, gain: L, slope: L) {
        let k = c * gain;
        self.vx = k.neg_mul_add(self.x, self.vx);
        self.vy = k.neg_mul_add(self.y, self.vy);
        self.vz = gain.mul_add(slope, self.vz);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn link<const SLOPE: bool, const RARER: bool>(
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
        self.bend(L::splat(cpu, link.c), after - before, slope);
        (self.height, self.root) = (slope, after);
        self.keep_root(cpu, if RARER { square_after } else { square });
        self.keep(if SLOPE {
            L::splat(cpu, rim).less_equal(slope)
        } else {
            self.height_squared().less_equal(L::splat(cpu, rim))
        });
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sphere<const FLAT: bool>(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        mut minus_z: L,
        lead: Option<L>,
    ) {
        let c = L::splat(cpu, sphere.c);
        let mut lead = lead.unwrap_or(L::splat(cpu, L::Scalar::ZERO));
        if sphere.tests.forward {
            self.go_forward(cpu);
        }
        if sphere.far {
            let t = minus_z / self.vz;
            self.advance(t);
            (minus_z, lead) = (L::splat(cpu, L::Scalar::ZERO), t);
        }
        let across = self.y.mul_add(self.vy, self.x * self.vx);
        let height_squared = self.height_squared();
        let half_c = L::splat(cpu, sphere.half_c);
        let (f, g) = if FLAT {
            (half_c * height_squared, c.neg_mul_add(across, self.vz))
        } else {
            let along = minus_z.neg_mul_add(self.vz, across);
            (half_c.mul_add(minus_z.mul_add(minus_z, height_squared), minus_z), c.neg_mul_add(along, self.vz))
        };
        let minus_2phi = f * L::splat(cpu, sphere.minus_2cn2);
        let square = g.mul_add(g, minus_2phi);
        let square_after = g.mul_add(g, minus_2phi + L::splat(cpu, sphere.index_step));
        let [before, after] = L::sqrt_pair(square, square_after);
        let strong = (g - before) * L::splat(cpu, sphere.per_cn2);
        let t = if sphere.strong {
            strong
        } else {
            L::select(L::splat(cpu, L::Scalar::ZERO).less(g), (f + f) / (g + before), strong)
        };
        self.advance(t);
        let z = if FLAT { t * self.vz } else { t.mul_sub(self.vz, minus_z) };
        let slope = c.neg_mul_add(z, L::splat(cpu, L::Scalar::ONE));
        self.bend(c, after - before, slope);
        (self.height, self.root) = (if sphere.hands_slope { slope } else { z }, after);
        self.keep_root(cpu, if sphere.index_step < L::Scalar::ZERO { square_after } else { square });
        match sphere.rim {
            Rim::Slope(least) => self.keep(L::splat(cpu, least).less_equal(slope)),
            Rim::Height(most) => {
                self.keep(self.height_squared().less_equal(L::splat(cpu, most)));
                self.keep(L::splat(cpu, L::Scalar::ZERO).less_equal(slope));
            }
        }
        if sphere.tests.onward {
            self.keep(L::splat(cpu, -sphere.slack).less_equal(lead + t));
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
        self.keep(self.height_squared().less_equal(L::splat(cpu, plane.aperture)));
        let square = self.vz * self.vz;
        let square_after = self.vz.mul_add(self.vz, L::splat(cpu, plane.index_step));
        self.keep_root(cpu, if plane.index_step < L::Scalar::ZERO { square_after } else { square });
        if plane.tests.forward {
            self.go_forward(cpu);
        }
        if plane.tests.onward {
            self.keep(L::splat(cpu, -plane.slack).less_equal(lead.unwrap_or(zero) + t));
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

    /// To lens space, the direction made a unit vector by one step of Newton's iteration: V is one but for rounding.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn leave(self, cpu: Cpu<L>, table: &Table<L::Scalar>) -> End<L> {
        let z = self.height.mul_add(L::splat(cpu, table.exit.factor), L::splat(cpu, table.exit.offset));
        let square = self.vz.mul_add(self.vz, self.vy.mul_add(self.vy, self.vx * self.vx));
        let factor = square.mul_add(L::splat(cpu, table.unit[1]), L::splat(cpu, table.unit[0]));
        let along = factor * L::splat(cpu, L::Scalar::from_f64(table.sense));
        let passed = self.passed;
        End {
            origin: [self.x.or_zero(passed), self.y.or_zero(passed), z.or_zero(passed)],
            direction: [
                (self.vx * factor).or_zero(passed),
                (self.vy * factor).or_zero(passed),
                (self.vz * along).or_zero(passed),
            ],
            passed,
        }
    }
}
