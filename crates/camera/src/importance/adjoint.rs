//! The adjoint camera, which computes the importance of rays in world space and samples directions toward the
//! lens from world points.

use super::{
    Aimed, Importance, ScenePoint,
    block::{ArrivingRays, BLOCK, BlockStep, PointColumns, load, store},
    lens::AdjointLens,
    linear::Linear,
    pose::{Pose, Poses, TurnedDirections},
};
use crate::{
    placement::{Placement, motion::CameraMotion, shutter::Shutter},
    rays::WorldRay,
};
use realistic_base::numeric;
use realistic_optics::lens::Ray;
use realistic_simd::{Available, Cpu, Lanes};
use realistic_trace::kernel::LensRays;

/// The optics that trace rays from the front of the lens to the film, in camera space.
#[derive(Clone, Debug)]
enum AdjointOptics {
    Lens(Box<AdjointLens>),
    Linear(Box<Linear>),
}

/// An adjoint camera. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct AdjointCamera {
    optics: AdjointOptics,
    placement: Placement,
    /// The camera's pose, if the camera does not move; `None` for a moving camera.
    still_pose: Option<Pose>,
    /// World units per unit of the optics.
    units: f64,
    /// Area of the front of the lens, over which densities per area are defined, in square units of the
    /// optics.
    front_area: f64,
    /// Smallest and largest distance from the lens at which the camera sees a point, world units.
    distances: [f64; 2],
    shutter: Shutter,
    rows: f32,
    simd: Available,
}

/// Rounding error by which a time may lie outside the shutter's interval, as a fraction of the interval.
const ROUNDING: f32 = 1e-5;
/// Largest number that rounds to 0 in single precision: 2^-150.
const LEAST: f64 = f32::MIN_POSITIVE as f64 / (1_u64 << 24) as f64;

impl AdjointCamera {
    /// Returns the adjoint of a lens with its film; `units_per_mm` is the number of world units per
    /// millimetre.
    pub fn of_lens(lens: AdjointLens, placement: &Placement, units_per_mm: f64) -> Self {
        let front_area = lens.front_area();
        let clip = placement.clip.map(f64::from);
        Self::new(AdjointOptics::Lens(Box::new(lens)), placement, units_per_mm, front_area, clip)
    }

    /// Returns the adjoint of a camera with linear rays. `units` is the number of world units per unit of the
    /// camera, `front_area` is the area of the camera's lens, and `distances` is the range of distances from
    /// the lens at which the camera sees points.
    pub(crate) fn of_linear(
        linear: &Linear,
        placement: &Placement,
        units: f64,
        front_area: f64,
        distances: [f64; 2],
    ) -> Self {
        Self::new(AdjointOptics::Linear(Box::new(linear.clone())), placement, units, front_area, distances)
    }

    fn new(
        optics: AdjointOptics,
        placement: &Placement,
        units: f64,
        front_area: f64,
        distances: [f64; 2],
    ) -> Self {
        let still_pose = match &placement.to_world {
            CameraMotion::Still(placed) => Some(Pose::new(placed, units)),
            CameraMotion::Moving(_) => None,
        };
        let (placement, shutter, simd) = (placement.clone(), Shutter::Global, Available::best());
        Self { optics, placement, still_pose, units, front_area, distances, shutter, rows: 1.0, simd }
    }

    /// Returns this camera behind a shutter, for a picture with `rows` rows of pixels.
    #[must_use]
    pub(crate) fn with_shutter(self, shutter: Shutter, rows: f32) -> Self {
        Self { shutter, rows, ..self }
    }

    /// Returns the middle of the shutter's interval.
    pub fn middle_time(&self) -> f32 {
        self.placement.time(0.5)
    }

    /// Whether all data that is built on demand has been built.
    pub fn is_complete(&self) -> bool {
        match &self.optics {
            AdjointOptics::Lens(lens) => lens.is_tabulated(),
            AdjointOptics::Linear(_) => true,
        }
    }

    /// Returns the camera's poses at `times`.
    fn poses(&self, times: impl Iterator<Item = f32>) -> Poses {
        let pose = |time| Pose::new(&self.placement.to_world.at(time), self.units);
        match self.still_pose {
            Some(pose) => Poses::still(pose),
            None => Poses::moving(times.map(pose).collect()),
        }
    }

    /// Returns a time as a fraction of the shutter's interval, or `None` if the time lies outside the
    /// interval. If the shutter opens and closes at the same time, the fraction is 0.5.
    fn time_number(&self, time: f32) -> Option<f32> {
        let [open, close] = self.placement.shutter;
        if open == close {
            return (time == open).then_some(0.5);
        }
        let number = (time - open) / (close - open);
        (-ROUNDING..=1.0 + ROUNDING).contains(&number).then(|| number.clamp(0.0, 1.0))
    }

    /// Computes the importance of rays that enter the lens, one result per ray. The rays are in world space.
    /// Their directions point toward the camera and may have any length but 0. They begin in front of the
    /// lens, or where the camera's own rays begin. `mint` and `maxt` are ignored. The importance is 0 for
    /// NaN, for rays from behind the lens, for rays that do not reach the film through the lens, and at times
    /// at which the shutter is closed.
    ///
    /// # Panics
    /// The slices differ in length.
    pub fn arrive(&self, rays: &[WorldRay], found: &mut [Importance]) {
        assert_eq!(rays.len(), found.len(), "a batch needs as much room as it has rays");
        for (rays, found) in rays.chunks(BLOCK).zip(found.chunks_mut(BLOCK)) {
            let block = self.arrive_block(rays);
            for (i, found) in found.iter_mut().enumerate() {
                *found = block.importance(i);
            }
        }
    }

    /// Computes [`arrive`](Self::arrive) for one block of rays.
    pub fn arrive_block(&self, rays: &[WorldRay]) -> ArrivingRays {
        let poses = self.poses(rays.iter().map(|ray| ray.time));
        let inside = |(i, ray): (usize, &WorldRay)| {
            let (pose, origin) = (poses.of(i), ray.origin.map(f64::from));
            let direction = pose.direction(ray.direction.map(f64::from));
            (Ray { origin: pose.point(origin), direction }, pose.rounding(origin))
        };
        let moved: Vec<(Ray, f64)> = rays.iter().enumerate().map(inside).collect();
        let mut block = ArrivingRays::new(rays.len());
        match &self.optics {
            AdjointOptics::Lens(lens) => lens.arrive(&moved, &mut block.traced),
            AdjointOptics::Linear(linear) => {
                for (i, (Ray { origin, direction }, rounding)) in moved.iter().enumerate() {
                    let direction = numeric::unit(*direction);
                    let origin = [0, 1, 2].map(|axis| origin[axis] - rounding * direction[axis]);
                    block.put_we(i, linear.arrive(&Ray { origin, direction }));
                }
            }
        }
        for (i, (ray, _)) in moved.iter().enumerate() {
            let [dx, dy, dz] = numeric::unit(ray.direction);
            block.toward_lens.put(i, [0.0, 0.0, 0.0, dx, dy, dz, 0.0]);
        }
        self.to_world(&poses, None, rays.iter().map(|ray| ray.time), &mut block);
        block
    }

    /// Transforms directions and importance from camera space to the world. Sets the whole result to 0 if the
    /// distance to its point in `points` lies outside the range that the camera sees.
    fn to_world(
        &self,
        poses: &Poses,
        points: Option<[&[f64]; 3]>,
        times: impl Iterator<Item = f32>,
        rays: &mut ArrivingRays,
    ) {
        let LensRays { origin: [_, raster_y, _], weight: share, .. } = rays.traced.rays();
        for (i, time) in times.enumerate() {
            let share_at = |number| self.shutter.transmission(raster_y[i] as f32 / self.rows, number);
            share[i] = self.time_number(time).map_or(0.0, share_at).into();
        }
        let mut turned = AdjointToWorld {
            camera: self,
            poses,
            points,
            traced: rays.traced.rays(),
            toward_lens: rays.toward_lens.each_mut(),
        };
        turned.take(self.simd);
    }

    /// Samples directions toward the lens from points of the scene, one per point. The whole result is 0 for
    /// NaN and for points that the camera does not see; only the importance is 0 for a direction that does
    /// not reach the film.
    ///
    /// # Panics
    /// The slices differ in length.
    pub fn aim(&self, points: &[ScenePoint], found: &mut [Aimed]) {
        assert_eq!(points.len(), found.len(), "a batch needs as much room as it has points");
        for (points, found) in points.chunks(BLOCK).zip(found.chunks_mut(BLOCK)) {
            let mut block = PointColumns::new(points.len());
            for (i, ScenePoint { point: [x, y, z], sample: [u, v], .. }) in points.iter().enumerate() {
                block.put(i, [x, y, z, u, v].map(|number| f64::from(*number)));
            }
            let rays = self.aim_block(&block, points.iter().map(|point| point.time));
            let [x, y, z, dx, dy, dz, density] = rays.toward_lens.each();
            for (i, found) in found.iter_mut().enumerate() {
                *found = Aimed {
                    origin: [x[i], y[i], z[i]],
                    direction: [dx[i], dy[i], dz[i]],
                    density: density[i],
                    importance: rays.importance(i),
                };
            }
        }
    }

    /// Computes [`aim`](Self::aim) for one block of points; the columns are three world coordinates and the
    /// pupil sample (u, v).
    pub fn aim_block(
        &self,
        points: &PointColumns<5>,
        times: impl Iterator<Item = f32> + Clone,
    ) -> ArrivingRays {
        let poses = self.poses(times.clone());
        let points = points.each();
        let [x, y, z, ..] = points;
        let mut inside = PointColumns::<5>::new(x.len());
        ToCamera { poses: &poses, points, inside: inside.each_mut() }.take(self.simd);
        let mut rays = ArrivingRays::new(x.len());
        match &self.optics {
            AdjointOptics::Lens(lens) => lens.aim(inside.each_mut(), &mut rays),
            AdjointOptics::Linear(linear) => {
                let [x, y, z, u, v] = inside.each();
                for i in (0..x.len()).filter(|&i| !x[i].is_nan()) {
                    if let Some((ray, density)) = linear.aim([x[i], y[i], z[i]], [u[i], v[i]]) {
                        rays.put(i, &ray, density, linear.arrive(&ray));
                    }
                }
            }
        }
        self.to_world(&poses, Some([x, y, z]), times, &mut rays);
        rays
    }
}

/// Transforms world points to camera space and clamps their pupil samples to [0, 1]. If a number of a point
/// is not finite, the point's x becomes NaN.
struct ToCamera<'a> {
    poses: &'a Poses,
    points: [&'a [f64]; 5],
    inside: [&'a mut [f64]; 5],
}

impl BlockStep for ToCamera<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.points[0].len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let [x, y, z, u, v] = load(cpu, &self.points, at);
        let [x, y, z] = self.poses.lanes(cpu, at).point([x, y, z]);
        let are_numbers = L::both(u.less_equal(u), v.less_equal(v));
        // 0; NaN if a number is infinite or NaN.
        let nothing = (x + y + z) * L::select(are_numbers, zero, L::splat(cpu, f64::NAN));
        let [u, v] = [u.larger(zero).smaller(one), v.larger(zero).smaller(one)];
        store([x + nothing, y, z, u, v], &mut self.inside, at);
    }
}

/// Transforms a block's rays to the world in place. `toward_lens` receives the fields of [`Aimed`] except its
/// importance; `traced` receives [`Importance`]. All are 0 for a blocked ray. The weight of a traced ray
/// becomes the shutter's transmission.
struct AdjointToWorld<'a> {
    camera: &'a AdjointCamera,
    poses: &'a Poses,
    /// Scene points from which the directions start, world space.
    points: Option<[&'a [f64]; 3]>,
    traced: LensRays<'a, f64>,
    toward_lens: [&'a mut [f64]; 7],
}

impl BlockStep for AdjointToWorld<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.traced.weight.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let number = |number: f64| L::splat(cpu, number);
        let [x, y, z, dx, dy, dz, density] = load(cpu, &self.toward_lens, at);
        let pose = self.poses.lanes(cpu, at);
        let turned = pose.turned([dx, dy, dz]);
        let density = density * turned.per_solid_angle;
        let Some(points) = self.points else {
            return self.importance(cpu, at, &turned, pose.per_area(), number(0.0).less_equal(density));
        };
        let (origin, point) = (pose.outside([x, y, z]), load(cpu, &points, at));
        let mut square = number(0.0);
        for axis in 0..3 {
            let offset = point[axis] - origin[axis];
            square = offset.mul_add(offset, square);
        }
        let (distance, [nearest, farthest]) = (square.sqrt(), self.camera.distances.map(number));
        let is_within = L::both(nearest.less_equal(distance), distance.less_equal(farthest));
        let is_one = L::both(number(LEAST).less(density), density.less_equal(number(f64::from(f32::MAX))));
        let is_seen = L::both(is_within, is_one);
        let ([x, y, z], [dx, dy, dz]) = (origin, turned.direction);
        let mut found = [x, y, z, dx, dy, dz, density];
        for number in &mut found {
            *number = number.or_zero(is_seen);
        }
        store(found, &mut self.toward_lens, at);
        self.importance(cpu, at, &turned, pose.per_area(), is_seen);
    }
}

impl AdjointToWorld<'_> {
    /// Computes the importance of rays in the world.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn importance<L: Lanes<Scalar = f64>>(
        &mut self,
        cpu: Cpu<L>,
        at: usize,
        turned: &TurnedDirections<L>,
        per_area: L,
        is_seen: L::Mask,
    ) {
        let number = |number: f64| L::splat(cpu, number);
        let front_area = self.camera.front_area;
        let LensRays { origin, direction, weight: share } = &mut self.traced;
        let [x, y, weight] = load(cpu, origin, at);
        let density = L::load(cpu, &direction[0][at..]) * turned.per_throughput;
        let importance = weight * density * L::load(cpu, &share[at..]);
        let area_density = number(front_area.recip()) * per_area;
        let solid_angle_density = density * turned.seen_area * number(front_area);
        // The host receives single precision, so an importance whose numbers do not fit becomes 0.
        let most = importance.larger(density).larger(area_density).larger(solid_angle_density);
        let least = importance.smaller(density).smaller(area_density).smaller(solid_angle_density);
        let fits = L::both(number(LEAST).less(least), most.less_equal(number(f64::from(f32::MAX))));
        let counts = L::both(fits, is_seen);
        let numbers = [x, y, importance, density, area_density, solid_angle_density];
        for axis in 0..3 {
            numbers[axis].or_zero(counts).store(&mut origin[axis][at..]);
            numbers[3 + axis].or_zero(counts).store(&mut direction[axis][at..]);
        }
    }
}
