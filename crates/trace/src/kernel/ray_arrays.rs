//! Rays in arrays before and behind a lens.
//!
//! The module defines the caller's structures of arrays ([`PlaneRays`], [`LensRays`]), arrays that own their storage
//! ([`RayBuffer`]), and a single ray ([`Traced`]). [`Arrays`] traces rays in arrays through optics; a camera, which
//! makes its rays from samples, has its own loop.

use std::ops::Range;

use super::{
    group::Group,
    instances::{InVectors, Optics},
    ray_lanes::{End, Start},
};
use realistic_base::numeric::Real;
use realistic_optics::lens::Ray;
use realistic_simd::{Cpu, Lanes, Scalar};

/// Rays that start on a plane perpendicular to the axis, such as the film, as a structure of arrays of equal length.
#[derive(Clone, Copy, Debug)]
pub struct PlaneRays<'a, S> {
    /// z of the plane in lens space, mm.
    pub plane: f64,
    /// x of each ray on the plane, mm.
    pub x: &'a [S],
    /// y of each ray on the plane, mm.
    pub y: &'a [S],
    /// dx/dz of each ray.
    pub slope_x: &'a [S],
    /// dy/dz of each ray.
    pub slope_y: &'a [S],
}

/// Rays in lens space, as a structure of arrays of equal length.
#[derive(Debug)]
pub struct LensRays<'a, S> {
    /// A point on each ray: x, y and z, mm.
    pub origin: [&'a mut [S]; 3],
    /// Direction of each ray: x, y and z.
    pub direction: [&'a mut [S]; 3],
    /// Output only: cos⁴ of the angle between the axis and the ray before the lens, at least the smallest normal
    /// number, for a ray that gets through; 0 for a blocked ray.
    pub weight: &'a mut [S],
}

impl<S> PlaneRays<'_, S> {
    /// Returns the number of rays.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub(crate) fn checked_len(&self) -> usize {
        let n = self.x.len();
        let same = [self.y, self.slope_x, self.slope_y].iter().all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }
}

impl<S> LensRays<'_, S> {
    /// Returns the number of rays.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub(crate) fn checked_len(&self) -> usize {
        let n = self.weight.len();
        let same = self.origin.iter().chain(&self.direction).all(|array| array.len() == n);
        assert!(same, "the arrays of a batch must have one length");
        n
    }
}

/// A ray that got through a lens, in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced<S> {
    /// The point on the last surface, mm.
    pub origin: [S; 3],
    /// The direction behind that surface, a unit vector.
    pub direction: [S; 3],
    /// cos⁴ of the angle between the axis and the ray before the lens; positive.
    pub weight: S,
}

impl<S: Real> Traced<S> {
    /// Builds a ray from the values of origin, direction and weight; `None` if the weight is 0, as for a blocked ray.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn of([x, y, z, dx, dy, dz, weight]: [S; 7]) -> Option<Self> {
        (weight > S::ZERO).then_some(Self { origin: [x, y, z], direction: [dx, dy, dz], weight })
    }

    /// Returns the ray in double precision.
    pub fn ray(&self) -> Ray {
        Ray { origin: self.origin.map(S::to_f64), direction: self.direction.map(S::to_f64) }
    }
}

/// Storage for rays as a structure of arrays: x, y, z of origin and direction, and the weight.
#[derive(Clone, Debug)]
pub struct RayBuffer<S>([Vec<S>; 7]);

impl<S: Real> RayBuffer<S> {
    /// Creates storage for `count` rays, with all numbers 0.
    pub fn new(count: usize) -> Self {
        Self(std::array::from_fn(|_| vec![S::ZERO; count]))
    }

    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.0[0].len()
    }

    /// Whether the buffer has no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sets a ray for [`Kernel::trace_in_place`](super::Kernel::trace_in_place).
    pub fn put(&mut self, i: usize, origin: [f64; 3], direction: [f64; 3]) {
        for (column, number) in self.0.iter_mut().zip(origin.into_iter().chain(direction)) {
            column[i] = S::from_f64(number);
        }
    }

    /// Appends the rays of another buffer.
    pub fn append(&mut self, other: Self) {
        for (column, others) in self.0.iter_mut().zip(other.0) {
            if column.is_empty() {
                *column = others;
            } else {
                column.extend(others);
            }
        }
    }

    /// Returns all rays.
    pub fn rays(&mut self) -> LensRays<'_, S> {
        self.part(0..self.len())
    }

    /// Returns the rays in a range of indices.
    pub fn part(&mut self, part: Range<usize>) -> LensRays<'_, S> {
        let [x, y, z, dx, dy, dz, weight] = self.0.each_mut().map(|column| &mut column[part.clone()]);
        LensRays { origin: [x, y, z], direction: [dx, dy, dz], weight }
    }

    /// Returns the arrays of origins, directions and weights, with their current contents.
    pub fn columns(&self) -> [&[S]; 7] {
        self.0.each_ref().map(Vec::as_slice)
    }

    /// Returns the ray at an index; `None` if it was blocked.
    pub fn get(&self, i: usize) -> Option<Traced<S>> {
        Traced::of(self.0.each_ref().map(|column| column[i]))
    }
}

/// The plane from which rays start, and their direction of travel.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// z of the plane, lens space, mm.
    pub entry: f64,
    /// 1 for travel toward +z, -1 for travel toward -z.
    pub travel_sign: f64,
}

/// Writes rays behind a lens into arrays, starting at index `at`.
#[cfg_attr(not(debug_assertions), inline(always))]
fn store<S: Scalar, L: Lanes<Scalar = S>>(rays: &mut LensRays<'_, S>, cpu: Cpu<L>, at: usize, end: End<L>) {
    for axis in 0..3 {
        end.origin[axis].or_zero(end.passed).store(&mut rays.origin[axis][at..]);
        end.direction[axis].or_zero(end.passed).store(&mut rays.direction[axis][at..]);
    }
    let weight = (end.weight_root * end.weight_root) * end.left;
    weight.larger(L::splat(cpu, L::Scalar::LEAST)).or_zero(end.passed).store(&mut rays.weight[at..]);
}

/// Builds rays from `[x, y]` on the plane z = `plane` (lens space) with the slopes `[sx, sy]`.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn from_plane<L: Lanes>(
    cpu: Cpu<L>,
    Approach { entry, travel_sign }: Approach,
    plane: f64,
    [x, y]: [L; 2],
    [sx, sy]: [L; 2],
) -> Start<L> {
    let one = L::splat(cpu, L::Scalar::ONE);
    let moved = L::splat(cpu, L::Scalar::from_f64(entry - plane));
    let travel_sign = L::splat(cpu, L::Scalar::from_f64(travel_sign));
    let stretch = sy.mul_add(sy, sx.mul_add(sx, one));
    // The reciprocal is computed first, because the first surface needs it before the cosine.
    let cos2 = one / stretch;
    let (x, y) = (moved.mul_add(sx, x), moved.mul_add(sy, y));
    let slopes = [sx * travel_sign, sy * travel_sign];
    Start::Flat { x, y, slopes, stretch, cos2, moved: moved * travel_sign }
}

/// Rays in arrays, as work that traces them through optics.
pub struct Arrays<'a, 'b, 'c, S, O> {
    /// The optics that the rays go through.
    pub optics: &'a O,
    /// Rays before the optics. If `None`, `to` contains the rays, each of which starts anywhere before the first
    /// surface.
    pub from: Option<&'a PlaneRays<'b, S>>,
    /// Rays behind the optics.
    pub to: &'a mut LensRays<'c, S>,
    /// The optical path of every ray, mm, if the rays carry it; 0 for a blocked ray.
    pub optical_path: Option<&'a mut [S]>,
}

impl<S: Scalar, O: Optics<S>> Arrays<'_, '_, '_, S, O> {
    /// Takes the vector of rays that starts at index `at` to the point where other vectors may join it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, at: usize) -> (O::OnWay<L>, O::State<L>) {
        let approach = self.optics.approach();
        let start = match self.from {
            Some(PlaneRays { plane, x, y, slope_x, slope_y }) => {
                let point = [L::load(cpu, &x[at..]), L::load(cpu, &y[at..])];
                let slopes = [L::load(cpu, &slope_x[at..]), L::load(cpu, &slope_y[at..])];
                from_plane(cpu, approach, *plane, point, slopes)
            }
            None => {
                let LensRays { origin: [x, y, z], direction: [dx, dy, dz], .. } = &*self.to;
                let point = [L::load(cpu, &x[at..]), L::load(cpu, &y[at..]), L::load(cpu, &z[at..])];
                let direction = [L::load(cpu, &dx[at..]), L::load(cpu, &dy[at..]), L::load(cpu, &dz[at..])];
                anywhere(cpu, approach, point, direction)
            }
        };
        self.optics.enter(cpu, L::splat(cpu, S::ZERO), start)
    }

    /// Writes the result of a vector of rays.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn leave<L: Lanes<Scalar = S>>(
        &mut self,
        cpu: Cpu<L>,
        at: usize,
        rays: O::OnWay<L>,
        state: &O::State<L>,
    ) {
        let end = self.optics.leave(cpu, rays, state);
        let path = self.optics.optical_path(cpu, state);
        if let (Some(path), Some(to)) = (path, &mut self.optical_path) {
            path.or_zero(end.passed).store(&mut to[at..]);
        }
        store(self.to, cpu, at, end);
    }
}

impl<S: Scalar, O: Optics<S>> InVectors<S> for Arrays<'_, '_, '_, S, O> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.to.weight.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        // A single vector stays in registers.
        if U == 1 || count == 1 || !O::SIDE_BY_SIDE {
            for u in 0..count {
                let at = first + u * L::WIDTH;
                let (entered, state) = self.enter(cpu, at);
                let (mut rays, mut states) = ([entered], [state]);
                self.optics.through(cpu, &mut rays, &mut states, 1);
                self.leave(cpu, at, rays[0], &states[0]);
            }
            return;
        }
        let (mut rays, mut states) = (Group::<_, U>::default(), Group::<_, U>::default());
        for u in 0..count {
            let (entered, state) = self.enter(cpu, first + u * L::WIDTH);
            rays.push(entered);
            states.push(state);
        }
        let (rays, states) = (rays.filled(), states.filled());
        self.optics.through(cpu, rays, states, count);
        for (u, (rays, state)) in rays.iter().zip(states).enumerate().take(count) {
            self.leave(cpu, first + u * L::WIDTH, *rays, state);
        }
    }
}

/// Traces `N` rays from a plane, one to four, with low latency; `trace` is the function of a kernel or of polynomials
/// that traces arrays.
#[inline(always)]
pub fn trace_array<S: Scalar, const N: usize>(
    plane: f64,
    points: [[S; 2]; N],
    slopes: [[S; 2]; N],
    trace: impl FnOnce(&PlaneRays<'_, S>, &mut LensRays<'_, S>),
) -> [Option<Traced<S>>; N] {
    let transposed = |pairs: [[S; 2]; N]| [pairs.map(|[x, _]| x), pairs.map(|[_, y]| y)];
    let ([x, y], [slope_x, slope_y]) = (transposed(points), transposed(slopes));
    let mut out = [[S::ZERO; N]; 7];
    let [ox, oy, oz, dx, dy, dz, weight] = &mut out;
    let from = PlaneRays { plane, x: &x, y: &y, slope_x: &slope_x, slope_y: &slope_y };
    trace(&from, &mut LensRays { origin: [ox, oy, oz], direction: [dx, dy, dz], weight });
    std::array::from_fn(|i| Traced::of(out.map(|column| column[i])))
}

/// Builds rays that start anywhere in lens space, with directions of any length but 0, and moves them to the vertex
/// plane if that plane lies ahead.
///
/// The points are computed by differences of products, not as P + t D. For a distant object, P + t D has a rounding
/// error relative to the distance; the error of a difference of products is relative to the size of the lens. Each
/// difference is within 1.5 ulp by Kahan's algorithm (C.-P. Jeannerod, N. Louvet and J.-M. Muller, "Further analysis of
/// Kahan's algorithm for the accurate computation of 2 x 2 determinants", 2013).
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn anywhere<L: Lanes>(
    cpu: Cpu<L>,
    Approach { entry, travel_sign }: Approach,
    [x, y, z]: [L; 3],
    [dx, dy, dz]: [L; 3],
) -> Start<L> {
    let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
    let travel_sign = L::splat(cpu, L::Scalar::from_f64(travel_sign));
    let minus_z = (L::splat(cpu, L::Scalar::from_f64(entry)) - z) * travel_sign;
    let dz = dz * travel_sign;
    // The direction is scaled first, so that the squares of very small or very large components stay in range.
    let [ax, ay, az] = [dx.larger(zero - dx), dy.larger(zero - dy), dz.larger(zero - dz)];
    let largest = ax.larger(ay).larger(az);
    let [sx, sy, sz] = [dx / largest, dy / largest, dz / largest];
    let inverse = one / sz.mul_add(sz, sy.mul_add(sy, sx * sx)).sqrt();
    let v = [sx * inverse, sy * inverse, sz * inverse];
    let ahead = L::both(zero.less(minus_z), zero.less(dz));
    Start::Anywhere {
        x: L::select(ahead, at_vertex_plane(x, dx, minus_z, dz), x),
        y: L::select(ahead, at_vertex_plane(y, dy, minus_z, dz), y),
        minus_z: L::select(ahead, zero, minus_z),
        v,
        lead: L::select(ahead, minus_z / v[2], zero),
    }
}

/// Returns a coordinate of the point where z is 0: p + `minus_z` d/dz.
#[cfg_attr(not(debug_assertions), inline(always))]
fn at_vertex_plane<L: Lanes>(p: L, d: L, minus_z: L, dz: L) -> L {
    let product = minus_z * d;
    let error = minus_z.mul_sub(d, product);
    (p.mul_add(dz, product) + error) / dz
}
