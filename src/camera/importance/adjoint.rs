//! The adjoint camera: rays and points of the world in, importance and directions out.

use super::{
    Aimed, Importance, ScenePoint,
    block::{ArrivingRays, BLOCK, BlockStep, PointColumns, load, store},
    lens::AdjointLens,
    linear::Linear,
    pose::{Pose, Poses, TurnedDirections},
};
use crate::{
    camera::{
        placement::{Placement, motion::CameraMotion, shutter::Shutter},
        rays::WorldRay,
    },
    lens::Ray,
    numeric,
    trace::kernel::{Available, Cpu, Lanes, LensRays},
};

/// What takes rays from the front to the film, in camera space.
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
    /// Where the camera stands; `None` where that is another place at each time.
    still: Option<Pose>,
    /// World units that one of the optics' is.
    units: f64,
    /// Area that densities per area are spread over, in the optics' units.
    front_area: f64,
    /// World units from the lens between which a point is seen.
    distances: [f64; 2],
    shutter: Shutter,
    rows: f32,
    simd: Available,
}

/// How far, over the interval, a time may lie outside the shutter's by its rounding.
const ROUNDING: f32 = 1e-5;
/// What is not larger is 0 in single precision: 2^-150.
const LEAST: f64 = f32::MIN_POSITIVE as f64 / (1_u64 << 24) as f64;

impl AdjointCamera {
    /// Of a lens with its film; `units_per_mm` world units are a millimetre.
    pub(crate) fn of_lens(lens: AdjointLens, placement: &Placement, units_per_mm: f64) -> Self {
        let front_area = lens.front_area();
        let clip = placement.clip.map(f64::from);
        Self::new(AdjointOptics::Lens(Box::new(lens)), placement, units_per_mm, front_area, clip)
    }

    /// Of a camera with linear rays; `units` world units are one of its own, and its lens has this area. `distances` are
    /// those from the lens between which it sees points.
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
        let still = match &placement.to_world {
            CameraMotion::Still(placed) => Some(Pose::new(placed, units)),
            CameraMotion::Moving(_) => None,
        };
        let (placement, shutter, simd) = (placement.clone(), Shutter::Global, Available::best());
        Self { optics, placement, still, units, front_area, distances, shutter, rows: 1.0, simd }
    }

    /// The same behind a shutter, with so many rows of pixels.
    #[must_use]
    pub(crate) fn with_shutter(self, shutter: Shutter, rows: f32) -> Self {
        Self { shutter, rows, ..self }
    }

    /// The middle of the shutter's interval.
    pub fn middle_time(&self) -> f32 {
        self.placement.time(0.5)
    }

    /// Whether nothing is left to be made when somebody asks.
    pub(crate) fn is_complete(&self) -> bool {
        match &self.optics {
            AdjointOptics::Lens(lens) => lens.is_tabulated(),
            AdjointOptics::Linear(_) => true,
        }
    }

    /// Where the camera stands at some times.
    fn poses(&self, times: impl Iterator<Item = f32>) -> Poses {
        let pose = |time| Pose::new(&self.placement.to_world.at(time), self.units);
        match self.still {
            Some(pose) => Poses::still(pose),
            None => Poses::moving(times.map(pose).collect()),
        }
    }

    /// The fraction of the shutter's interval that a time is; `None` outside it. Where the shutter opens and closes at once,
    /// its middle.
    fn time_number(&self, time: f32) -> Option<f32> {
        let [open, close] = self.placement.shutter;
        if open == close {
            return (time == open).then_some(0.5);
        }
        let number = (time - open) / (close - open);
        (-ROUNDING..=1.0 + ROUNDING).contains(&number).then(|| number.clamp(0.0, 1.0))
    }

    /// The importance of rays that enter the lens, one for each: rays of world space with directions of any length but 0,
    /// toward the camera, that begin before the lens or where the camera's own rays do. `mint` and `maxt` are ignored. It is 0
    /// for NaN, for rays from behind, for those that do not get through the lens to the film, and at times at which the shutter
    /// is closed.
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

    /// The same for a block of rays.
    pub(crate) fn arrive_block(&self, rays: &[WorldRay]) -> ArrivingRays {
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

    /// Takes directions and what they count from camera space to the world; where that is farther from `points` or nearer than the
    /// camera sees, all is 0.
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

    /// Directions toward the lens from points of the scene, one for each. All is 0 for points that the camera does not see
    /// and for NaN; where the direction does not get through to the film, only the importance is.
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

    /// The same for a block's points: three coordinates in the world, and where in the pupil.
    pub(crate) fn aim_block(
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
                    if let Some(direction) = linear.aim([x[i], y[i], z[i]], [u[i], v[i]]) {
                        rays.put(i, &direction);
                    }
                }
            }
        }
        self.to_world(&poses, Some([x, y, z]), times, &mut rays);
        rays
    }
}

/// Points of the world that go to camera space, with their two numbers taken into [0, 1]; x is NaN of what is not finite.
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
        // 0, or NaN of what is infinite or NaN.
        let nothing = (x + y + z) * L::select(are_numbers, zero, L::splat(cpu, f64::NAN));
        let [u, v] = [u.larger(zero).smaller(one), v.larger(zero).smaller(one)];
        store([x + nothing, y, z, u, v], &mut self.inside, at);
    }
}

/// A block's rays, in whose place comes what they are in the world: [`Aimed`]'s numbers but for the importance, and in the place of
/// what is traced those of [`Importance`]; all 0 where there is nothing. The traced ray's weight is the share that the shutter lets
/// through.
struct AdjointToWorld<'a> {
    camera: &'a AdjointCamera,
    poses: &'a Poses,
    /// What directions come from, world space.
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
            let way = point[axis] - origin[axis];
            square = way.mul_add(way, square);
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
    /// What rays count in the world.
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
        // What single precision cannot hold, as a host gets it, counts nothing.
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
