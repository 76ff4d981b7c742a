//! Rays in lanes inside a lens ([`RayLanes`]), and the operation of each type of step on them.
//!
//! The origin of the frame is the vertex of a surface; the z axis points along the direction of travel. V = n D, c =
//! 1/R (positive when the centre lies ahead), N = (-c x, -c y, 1 - c z) and K = n'² - n². Every index is relative to
//! that of the medium before the first surface, so that V is a unit vector there whatever the medium:
//!
//! - f = (c/2)(x² + y² + z²) - z, g = N·V at the ray's point, e = √(g² - 2 c n² f) = n cos I and
//!   e' = √(e² + K) = n' cos I' at the hit, t V away, t = (g - e)/(c n²) = 2 f/(g + e);
//! - V' = V + (e' - e) N.
//!
//! Both roots are computed at once, in parallel, and a strongly curved surface requires no division. A blocked ray
//! continues with arbitrary values; the mask records that it is blocked.

use super::{
    apertures::{Apertures, Blocking},
    dispersion::Media,
    outline,
    surface::Transfer,
    table::{ClearTest, Link, Mirror, Plane, ShapedAperture, Sphere, Step, Stop, Table},
};
use realistic_base::numeric::Real;
use realistic_optics::trace::OutlineTest;
use realistic_simd::{Cpu, Lanes, Scalar};

/// Rays ready for the first surface, in the frame of its vertex.
#[derive(Clone, Copy)]
pub enum Start<L> {
    /// Rays on the vertex plane.
    Flat {
        /// x, mm.
        x: L,
        /// y, mm.
        y: L,
        /// s = (Vx, Vy)/Vz.
        slopes: [L; 2],
        /// 1 + s².
        stretch: L,
        /// Vz² = 1/(1 + s²).
        cos2: L,
        /// Distance along the axis by which the ray was moved from its origin.
        moved: L,
    },
    /// Rays from any point before the first surface.
    Anywhere {
        /// x, mm.
        x: L,
        /// y, mm.
        y: L,
        /// -z, mm.
        minus_z: L,
        /// V, a unit vector.
        v: [L; 3],
        /// Distance by which the ray was moved from its origin, in units of V.
        lead: L,
    },
}

impl<L: Lanes> Start<L> {
    /// Returns the distance by which the rays were moved from their origins, in units of V.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lead(&self) -> L {
        match *self {
            Self::Flat { cos2, moved, .. } => moved / cos2.sqrt(),
            Self::Anywhere { lead, .. } => lead,
        }
    }
}

/// The refraction of rays at a surface, in the frame of its vertex; blocked lanes hold arbitrary values.
#[derive(Clone, Copy)]
pub struct Crossing<L> {
    /// The normal N where the rays meet the surface, pointing along the direction of travel.
    pub normal: [L; 3],
    /// N·N if N is not a unit vector.
    pub square: Option<L>,
    /// N·V before and behind the surface: for a unit N, n cos I and n' cos I'.
    pub facing: [L; 2],
    /// V behind the surface.
    pub v: [L; 3],
    /// Distance along the rays, in units of V, from the previous surface, or from the start before the first surface.
    pub distance: L,
}

impl<L: Lanes> Crossing<L> {
    /// Returns the crossing in single precision, with a unit normal.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn single(&self, cpu: Cpu<L>) -> Crossing<L::Single> {
        let Self { normal: [x, y, z], square, facing: [before, behind], v: [vx, vy, vz], distance } = *self;
        let (mut normal, mut facing) =
            ([x.single(), y.single(), z.single()], [before.single(), behind.single()]);
        if let Some(square) = square {
            let scale = L::Single::splat(L::single_cpu(cpu), 1.0) / square.single().sqrt();
            normal = [normal[0] * scale, normal[1] * scale, normal[2] * scale];
            facing = [facing[0] * scale, facing[1] * scale];
        }
        Crossing {
            normal,
            square: None,
            facing,
            v: [vx.single(), vy.single(), vz.single()],
            distance: distance.single(),
        }
    }
}

/// Rays behind the last surface, in lens space; blocked lanes hold arbitrary values.
#[derive(Clone, Copy)]
pub struct End<L: Lanes> {
    /// Points on the last surface, mm.
    pub origin: [L; 3],
    /// Unit vectors.
    pub direction: [L; 3],
    /// Lanes whose rays pass the optics.
    pub passed: L::Mask,
    /// Root of the rays' weight without `left`: the squared cosine of the angle to the axis for rays from a plane, 1 for
    /// rays from anywhere, times the root of the transmission of a picture.
    pub weight_root: L,
    /// Remaining share of the light if rays carry light, else 1.
    pub left: L,
}

/// Rays inside the lens.
#[derive(Clone, Copy)]
pub struct RayLanes<L: Lanes, A = Blocking> {
    pub x: L,
    pub y: L,
    pub vx: L,
    pub vy: L,
    pub vz: L,
    /// z above the last vertex, or N_z at the last surface, as the table specifies.
    pub height: L,
    /// e' behind the last surface; behind a leading plane, the distance that the ray has come, in units of V.
    pub root: L,
    pub passed: L::Mask,
    /// Root of the rays' weight so far: the squared cosine of the angle to the axis for rays from a plane, 1 for rays
    /// from anywhere, times the root of the transmission of a picture.
    pub weight_root: L,
    /// Treatment of the rays at apertures.
    pub apertures: A,
}

/// Largest relative deviation of the length of V from n at the end. The step of Newton's iteration then leaves an error
/// of 1.5 times the square of this deviation, 3e-7.
const MOST_ROUNDING: f64 = 4.5e-4;

impl<L: Lanes, A: Apertures<L>> RayLanes<L, A> {
    /// Takes rays through the first surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn enter(
        cpu: Cpu<L>,
        step: &Step<L::Scalar>,
        media: impl Media<L>,
        start: Start<L>,
    ) -> (Self, Crossing<L>) {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        match (step, start) {
            (Step::Sphere(sphere), Start::Flat { x, y, slopes, stretch, cos2, moved }) => {
                let vz = cos2.sqrt();
                let mut ray = Self::at(cpu, [x, y], [slopes[0] * vz, slopes[1] * vz, vz], cos2);
                let crossing = ray.first_sphere(cpu, sphere, media, slopes, stretch, moved);
                (ray, crossing)
            }
            (Step::Plane(plane), Start::Flat { x, y, slopes, cos2, moved, .. }) => {
                let vz = cos2.sqrt();
                let mut ray = Self::at(cpu, [x, y], [slopes[0] * vz, slopes[1] * vz, vz], cos2);
                let lead = if plane.leads { moved / vz } else { moved };
                let crossing = ray.plane::<true>(cpu, plane, media, zero, Some(lead));
                (ray, crossing)
            }
            (Step::Sphere(sphere), Start::Anywhere { x, y, minus_z, v, lead }) => {
                let mut ray = Self::at(cpu, [x, y], v, one);
                if sphere.tests.forward {
                    ray.go_forward(cpu);
                }
                let crossing = ray.sphere::<false>(cpu, sphere, media, minus_z, Some(lead));
                (ray, crossing)
            }
            (Step::Plane(plane), Start::Anywhere { x, y, minus_z, v, lead }) => {
                let mut ray = Self::at(cpu, [x, y], v, one);
                let crossing = ray.plane::<false>(cpu, plane, media, minus_z, Some(lead));
                (ray, crossing)
            }
            (Step::Conic(conic), start) => {
                let (mut ray, minus_z, lead) = Self::before_surface(cpu, start);
                let crossing = ray.conic(cpu, conic, media, minus_z, lead);
                (ray, crossing)
            }
            (Step::Asphere(asphere), start) => {
                let (ray, minus_z, lead) = Self::before_surface(cpu, start);
                let mut rays = [ray];
                let [crossing] = asphere.trace(cpu, &mut rays, [media], [minus_z], [lead]);
                (rays[0], crossing)
            }
            (
                Step::Link(_)
                | Step::Stop(_)
                | Step::Aperture(_)
                | Step::Mirror(_)
                | Step::Renormalise(_)
                | Step::General(_),
                _,
            ) => {
                unreachable!("the first step meets the ray anywhere, or rays have not entered at it")
            }
        }
    }

    /// Returns rays before the first step, whose transfer is that from z, with the distance by which they were moved.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn before(cpu: Cpu<L>, start: Start<L>) -> Self {
        let (ray, minus_z, lead) = Self::before_surface(cpu, start);
        Self { height: L::splat(cpu, L::Scalar::ZERO) - minus_z, root: lead, ..ray }
    }

    /// Returns the rays before the first surface, -z of their points, and the distance by which they were moved, in
    /// units of V.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn before_surface(cpu: Cpu<L>, start: Start<L>) -> (Self, L, L) {
        let lead = start.lead();
        match start {
            Start::Flat { x, y, slopes, cos2, .. } => {
                let vz = cos2.sqrt();
                let ray = Self::at(cpu, [x, y], [slopes[0] * vz, slopes[1] * vz, vz], cos2);
                (ray, L::splat(cpu, L::Scalar::ZERO), lead)
            }
            Start::Anywhere { x, y, minus_z, v, .. } => {
                (Self::at(cpu, [x, y], v, L::splat(cpu, L::Scalar::ONE)), minus_z, lead)
            }
        }
    }

    /// Builds rays at a point, none of which is blocked.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn at(cpu: Cpu<L>, [x, y]: [L; 2], [vx, vy, vz]: [L; 3], weight_root: L) -> Self {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let (passed, apertures) = (zero.less_equal(zero), A::new(cpu));
        Self { x, y, vx, vy, vz, height: zero, root: zero, passed, weight_root, apertures }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn keep(&mut self, mask: L::Mask) {
        self.passed = L::both(self.passed, mask);
    }

    /// Returns the rays that are not blocked, one bit each.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn passed_bits(&self) -> u32 {
        L::bits(self.passed)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn go_forward(&mut self, cpu: Cpu<L>) {
        self.keep(L::splat(cpu, L::Scalar::ZERO).less(self.vz));
    }

    /// Blocks rays unless the argument of the root is well above 0. The blocked rays miss the surface, are totally
    /// reflected, or are NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn keep_root(&mut self, cpu: Cpu<L>, square: L) {
        self.keep(L::splat(cpu, L::Scalar::NO_SQUARE).less(square));
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn minus_z(&self, cpu: Cpu<L>, transfer: &Transfer<L::Scalar>) -> L {
        self.height.mul_add(L::splat(cpu, transfer.factor), L::splat(cpu, transfer.offset))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn height_squared(&self) -> L {
        self.y.mul_add(self.y, self.x * self.x)
    }

    /// Treats rays at an aperture: `height_squared` is the squared distance of the rays from the axis, `aperture` that
    /// of the aperture's edge.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn meet_aperture(&mut self, cpu: Cpu<L>, height_squared: L, aperture: L) {
        self.passed = self.apertures.meet(cpu, self.passed, height_squared, aperture);
    }

    /// Tests the aperture of a steep sphere by the normal, which determines the height and separates the near
    /// hemisphere from the far one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn steep(&mut self, cpu: Cpu<L>, normal_z: L, least: L::Scalar, minus_c: L::Scalar) {
        if A::BLOCK {
            self.keep(L::splat(cpu, least).less_equal(normal_z));
        } else {
            self.keep(L::splat(cpu, L::Scalar::ZERO).less_equal(normal_z));
            let one = L::Scalar::ONE;
            // Both arguments of the test are scaled by c².
            let height_squared = self.height_squared() * L::splat(cpu, minus_c * minus_c);
            self.meet_aperture(cpu, height_squared, L::splat(cpu, one - least * least));
        }
    }

    /// Returns the distance that the rays have travelled, for a surface behind a leading plane. Returns `None` for
    /// other surfaces, which measure from the current point of the rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lead(&self, is_led: bool) -> Option<L> {
        is_led.then_some(self.root)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn advance(&mut self, t: L) {
        self.x = t.mul_add(self.vx, self.x);
        self.y = t.mul_add(self.vy, self.y);
    }

    /// Refracts by Snell's law in optical direction cosines: V' = V + G N, with G = n' cos I' - n cos I.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn bend(&mut self, minus_c: L, gain: L, normal_z: L) {
        let k = minus_c * gain;
        self.vx = k.mul_add(self.x, self.vx);
        self.vy = k.mul_add(self.y, self.vy);
        self.vz = gain.mul_add(normal_z, self.vz);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn link<const STEEP: bool, const RARER: bool>(
        &mut self,
        cpu: Cpu<L>,
        link: &Link<L::Scalar>,
        media: impl Media<L>,
        limit: L::Scalar,
    ) -> Crossing<L> {
        let (alpha, rho) = (L::splat(cpu, link.alpha), L::splat(cpu, link.rho));
        let minus_2phi = media.times_square(
            self.height.mul_add(L::splat(cpu, link.minus_2phi1), L::splat(cpu, link.minus_2phi0)),
        );
        let g = alpha.mul_add(self.vz, rho * self.root);
        let square = g.mul_add(g, minus_2phi);
        // This is not computed as square + K, so that neither root waits for the other.
        let square_after = g.mul_add(g, minus_2phi + media.index_step(cpu, link.index_step));
        let [before, after] = L::sqrt_pair(square, square_after);
        let delta = g - before;
        let normal_z =
            delta.neg_mul_add(self.vz * media.per_square(cpu, link.per_n2), rho.mul_add(self.height, alpha));
        let t = delta * media.per_square(cpu, link.per_cn2);
        self.advance(t);
        let minus_c = L::splat(cpu, link.minus_c);
        self.bend(minus_c, after - before, normal_z);
        (self.height, self.root) = (normal_z, after);
        self.keep_root(cpu, media.lesser(RARER, square, square_after));
        if STEEP {
            self.steep(cpu, normal_z, limit, link.minus_c);
        } else {
            self.meet_aperture(cpu, self.height_squared(), L::splat(cpu, limit));
        }
        self.crossing([minus_c * self.x, minus_c * self.y, normal_z], None, [before, after], t)
    }

    /// Describes the refraction at the rays' current point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn crossing(&self, normal: [L; 3], square: Option<L>, facing: [L; 2], distance: L) -> Crossing<L> {
        Crossing { normal, square, facing, v: [self.vx, self.vy, self.vz], distance }
    }

    /// Intersects and refracts at a sphere; `PLAIN` is [`Sphere::plain`].
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sphere<const PLAIN: bool>(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        media: impl Media<L>,
        mut minus_z: L,
        lead: Option<L>,
    ) -> Crossing<L> {
        let (minus_c, zero) = (L::splat(cpu, sphere.minus_c), L::splat(cpu, L::Scalar::ZERO));
        let (mut lead, mut distance) = (lead.unwrap_or(zero), zero);
        if !PLAIN && sphere.far {
            let t = minus_z / self.vz;
            self.advance(t);
            (minus_z, lead, distance) = (zero, lead + t, t);
        }
        let across = self.y.mul_add(self.vy, self.x * self.vx);
        let along = minus_z.neg_mul_add(self.vz, across);
        let half_c = L::splat(cpu, sphere.half_c);
        let f = half_c.mul_add(minus_z.mul_add(minus_z, self.height_squared()), minus_z);
        let g = minus_c.mul_add(along, self.vz);
        let minus_2phi = media.times_square(f * L::splat(cpu, sphere.minus_2cn2));
        let square = g.mul_add(g, minus_2phi);
        let square_after = g.mul_add(g, minus_2phi + media.index_step(cpu, sphere.index_step));
        let [before, after] = L::sqrt_pair(square, square_after);
        let strong = (g - before) * media.per_square(cpu, sphere.per_cn2);
        let t = if PLAIN || sphere.strong {
            strong
        } else {
            L::select(zero.less(g), (f + f) / (g + before), strong)
        };
        self.advance(t);
        let z = t.mul_sub(self.vz, minus_z);
        let distance = if !PLAIN && sphere.far { distance + t } else { t };
        let crossing =
            self.pass::<PLAIN>(cpu, sphere, media, z, [[square, square_after], [before, after]], distance);
        if !PLAIN && sphere.tests.onward {
            self.keep(L::splat(cpu, -sphere.slack).less_equal(lead + t));
        }
        crossing
    }

    /// Intersects and refracts rays at a sphere. They start from its vertex plane, with slopes s. With G = g/Vz = 1 - c
    /// (x, y)·s and E² = (e/Vz)² = G² - 2 c n² f (1 + s²), z = t Vz = (G - E) Vz²/(c n²). No operation thus waits for
    /// Vz, which is itself a root.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn first_sphere(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        media: impl Media<L>,
        [sx, sy]: [L; 2],
        stretch: L,
        moved: L,
    ) -> Crossing<L> {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        if sphere.tests.forward {
            self.go_forward(cpu);
        }
        let across = self.y.mul_add(sy, self.x * sx);
        let g = L::splat(cpu, sphere.minus_c).mul_add(across, L::splat(cpu, L::Scalar::ONE));
        let f = L::splat(cpu, sphere.half_c) * self.height_squared();
        let stretched = stretch.mul_add(f * L::splat(cpu, sphere.minus_2cn2), g * g);
        // Nothing has dimmed the rays before the first surface.
        let cos2 = self.weight_root;
        let square = stretched * cos2;
        let square_after = stretched.mul_add(cos2, media.index_step(cpu, sphere.index_step));
        let [e, after] = L::sqrt_pair(stretched, square_after);
        let strong = (g - e) * (cos2 * L::splat(cpu, sphere.per_cn2));
        let z = if sphere.strong { strong } else { L::select(zero.less(g), (f + f) / (g + e), strong) };
        self.x = z.mul_add(sx, self.x);
        self.y = z.mul_add(sy, self.y);
        // Vz is about to change, and the slack of the test is in units of the current V.
        let slack = self.vz * L::splat(cpu, -sphere.slack);
        let (facing, distance) = ([e * self.vz, after], z / self.vz);
        let crossing = self.pass::<false>(cpu, sphere, media, z, [[square, square_after], facing], distance);
        if sphere.tests.onward {
            self.keep(slack.less_equal(moved + z));
        }
        crossing
    }

    /// Refracts rays at their current point on a sphere, and tests the aperture. The point is at the height `z`, at
    /// `distance` from the previous surface. The first pair of vectors is the squares of n cos I before and behind the
    /// sphere, the second pair their roots.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn pass<const PLAIN: bool>(
        &mut self,
        cpu: Cpu<L>,
        sphere: &Sphere<L::Scalar>,
        media: impl Media<L>,
        z: L,
        [[square, square_after], [before, after]]: [[L; 2]; 2],
        distance: L,
    ) -> Crossing<L> {
        let minus_c = L::splat(cpu, sphere.minus_c);
        let normal_z = minus_c.mul_add(z, L::splat(cpu, L::Scalar::ONE));
        self.bend(minus_c, after - before, normal_z);
        (self.height, self.root) = (if PLAIN || sphere.carries_normal { normal_z } else { z }, after);
        self.keep_root(cpu, media.lesser(sphere.index_step < L::Scalar::ZERO, square, square_after));
        let (zero, test) = (L::Scalar::ZERO, sphere.aperture_test);
        if let ClearTest::NormalZ(least) = test {
            self.steep(cpu, normal_z, least, sphere.minus_c);
        } else {
            self.keep(L::splat(cpu, zero).less_equal(normal_z));
        }
        if !PLAIN && let ClearTest::Height(most) = test {
            self.meet_aperture(cpu, self.height_squared(), L::splat(cpu, most));
        }
        self.crossing([minus_c * self.x, minus_c * self.y, normal_z], None, [before, after], distance)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn plane<const FLAT: bool>(
        &mut self,
        cpu: Cpu<L>,
        plane: &Plane<L::Scalar>,
        media: impl Media<L>,
        minus_z: L,
        lead: Option<L>,
    ) -> Crossing<L> {
        let zero = L::splat(cpu, L::Scalar::ZERO);
        let mut t = zero;
        if !FLAT {
            t = minus_z / self.vz;
            self.advance(t);
        }
        self.meet_aperture(cpu, self.height_squared(), L::splat(cpu, plane.aperture));
        let square = self.vz * self.vz;
        let square_after = self.vz.mul_add(self.vz, media.index_step(cpu, plane.index_step));
        self.keep_root(cpu, media.lesser(plane.index_step < L::Scalar::ZERO, square, square_after));
        if plane.tests.forward {
            self.go_forward(cpu);
        }
        let lead = lead.unwrap_or(zero) + t;
        if plane.tests.onward {
            let slack = L::splat(cpu, -plane.slack);
            let slack = if FLAT { self.vz * slack } else { slack };
            self.keep(slack.less_equal(lead));
        }
        let (before, root) = (self.vz, square_after.sqrt());
        (self.vz, self.root) = (root, if plane.leads { lead } else { root });
        self.height = zero;
        self.crossing([zero, zero, L::splat(cpu, L::Scalar::ONE)], None, [before, root], t)
    }

    /// Reflects rays at their current point: V' = V - 2 e N. Behind the mirror z is reversed: Vz' = 2 e N_z - Vz. N_z
    /// and e are unchanged; a height z becomes -z, which the next step's transfer takes into account.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mirror(&mut self, cpu: Cpu<L>, mirror: &Mirror<L::Scalar>) {
        let normal_z = self.minus_z(cpu, &mirror.normal);
        let twice = self.root + self.root;
        let k = twice * L::splat(cpu, mirror.minus_c);
        self.vx = k.neg_mul_add(self.x, self.vx);
        self.vy = k.neg_mul_add(self.y, self.vy);
        self.vz = twice.mul_sub(normal_z, self.vz);
    }

    /// Tests the stop's aperture: |z (Vx, Vy) + Vz (x, y)| <= a Vz, with z the distance along the axis to the stop. The
    /// test neither moves the rays nor divides.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn stop(&mut self, cpu: Cpu<L>, stop: &Stop<L::Scalar>) {
        let ahead = self.minus_z(cpu, &stop.transfer);
        let x = ahead.mul_add(self.vx, self.x * self.vz);
        let y = ahead.mul_add(self.vy, self.y * self.vz);
        self.meet_aperture(cpu, y.mul_add(y, x * x), (self.vz * self.vz) * L::splat(cpu, stop.aperture));
    }

    /// Returns the factor that normalises V, whose length is n up to rounding, by one step of Newton's iteration.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn factor(&self, [most, per_square]: [L; 2]) -> L {
        let square = self.vz.mul_add(self.vz, self.vy.mul_add(self.vy, self.vx * self.vx));
        square.mul_add(per_square, most)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn scale_to(&mut self, cpu: Cpu<L>, length: [L::Scalar; 2], media: impl Media<L>) {
        let factor = self.factor([L::splat(cpu, length[0]), media.per_square(cpu, length[1])]);
        (self.vx, self.vy, self.vz) = (self.vx * factor, self.vy * factor, self.vz * factor);
    }

    /// Multiplies V.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn scaled(self, factor: L) -> Self {
        Self { vx: self.vx * factor, vy: self.vy * factor, vz: self.vz * factor, ..self }
    }

    /// Transforms rays to lens space, with the direction made a unit vector by one step of Newton's iteration. If the
    /// length of V is not n up to rounding, the ray comes from outside the image and is blocked here, as is a ray with
    /// a NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn leave(self, cpu: Cpu<L>, table: &Table<L::Scalar>, left: L) -> End<L> {
        let z = self.height.mul_add(L::splat(cpu, table.exit.factor), L::splat(cpu, table.exit.offset));
        let factor = self.factor([L::splat(cpu, table.unit[0]), L::splat(cpu, table.unit[1])]);
        let off = factor.mul_sub(L::splat(cpu, table.last_index), L::splat(cpu, L::Scalar::ONE));
        let is_unit = off.abs().less_equal(L::splat(cpu, L::Scalar::from_f64(MOST_ROUNDING)));
        let along = factor * L::splat(cpu, L::Scalar::from_f64(table.travel_sign));
        End {
            origin: [self.x, self.y, z],
            direction: [self.vx * factor, self.vy * factor, self.vz * along],
            passed: L::both(self.passed, is_unit),
            weight_root: self.weight_root,
            left,
        }
    }
}

impl<L: Lanes, A: Apertures<L>> RayLanes<L, A> {
    /// Tests a shaped aperture at P = z (Vx, Vy)/Vz + (x, y), multiplied by Vz, with z the distance along the axis to
    /// the plane of the test. The test does not move the rays. A picture dims them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn aperture(&mut self, cpu: Cpu<L>, aperture: &ShapedAperture<L::Scalar>) {
        let ahead = self.minus_z(cpu, &aperture.transfer);
        let x = ahead.mul_add(self.vx, self.x * self.vz);
        let y = ahead.mul_add(self.vy, self.y * self.vz);
        let (power, limit) = outline::sides(cpu, &aperture.test, [x, y], self.vz);
        self.meet_aperture(cpu, power, limit);
        if let OutlineTest::Picture(_) = aperture.test.outline {
            self.weight_root = self.weight_root * limit.sqrt();
        }
    }
}
