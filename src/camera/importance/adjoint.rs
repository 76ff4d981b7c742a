//! The adjoint camera: rays and points of the world in, importance and directions out.

use super::{
    Aimed, FilmWe, Importance, LensDirection, ScenePoint,
    lens::AdjointLens,
    linear::Linear,
    pose::{Pose, TurnedDirection},
};
use crate::{
    camera::{
        placement::{Placement, motion::CameraMotion, shutter::Shutter},
        ray::WorldRay,
    },
    lens::Ray,
    numeric,
};

/// What takes rays from the front to the film, in camera space.
#[derive(Clone, Debug)]
enum Optics {
    Lens(Box<AdjointLens>),
    Linear(Box<Linear>),
}

/// An adjoint camera. Immutable, and may be shared between threads.
#[derive(Clone, Debug)]
pub struct AdjointCamera {
    optics: Optics,
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
}

/// How far, over the interval, a time may lie outside the shutter's by its rounding.
const ROUNDING: f32 = 1e-5;

impl AdjointCamera {
    /// Of a lens with its film; `units_per_mm` world units are a millimetre.
    pub(crate) fn of_lens(lens: AdjointLens, placement: &Placement, units_per_mm: f64) -> Self {
        let front_area = lens.front_area();
        let clip = placement.clip.map(f64::from);
        Self::new(Optics::Lens(Box::new(lens)), placement, units_per_mm, front_area, clip)
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
        Self::new(Optics::Linear(Box::new(linear.clone())), placement, units, front_area, distances)
    }

    fn new(optics: Optics, placement: &Placement, units: f64, front_area: f64, distances: [f64; 2]) -> Self {
        let still = match &placement.to_world {
            CameraMotion::Still(placed) => Some(Pose::new(placed, units)),
            CameraMotion::Moving(_) => None,
        };
        let placement = placement.clone();
        Self { optics, placement, still, units, front_area, distances, shutter: Shutter::Global, rows: 1.0 }
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
            Optics::Lens(lens) => lens.is_tabulated(),
            Optics::Linear(_) => true,
        }
    }

    /// Where the camera stands at some times.
    fn poses(&self, times: impl Iterator<Item = f32>) -> Poses<'_> {
        let pose = |time| Pose::new(&self.placement.to_world.at(time), self.units);
        match &self.still {
            Some(pose) => Poses::Still(pose),
            None => Poses::Moving(times.map(pose).collect()),
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
        let poses = self.poses(rays.iter().map(|ray| ray.time));
        let inside = |(i, ray): (usize, &WorldRay)| {
            let (pose, origin) = (poses.of(i), ray.origin.map(f64::from));
            let direction = pose.direction(ray.direction.map(f64::from));
            (Ray { origin: pose.point(origin), direction }, pose.rounding(origin))
        };
        let moved: Vec<(Ray, f64)> = rays.iter().enumerate().map(inside).collect();
        let we = self.count(&moved);
        let rays = rays.iter().zip(&moved).enumerate();
        for ((found, we), (i, (ray, (inside, _)))) in found.iter_mut().zip(we).zip(rays) {
            let importance = |we| {
                let direction = unit(inside.direction)?;
                self.importance(&we, poses.of(i), &poses.of(i).turned(direction), ray.time)
            };
            *found = we.and_then(importance).unwrap_or_default();
        }
    }

    fn count(&self, rays: &[(Ray, f64)]) -> Vec<Option<FilmWe>> {
        let mut we = Vec::with_capacity(rays.len());
        match &self.optics {
            Optics::Lens(lens) => lens.arrive(rays, &mut we),
            Optics::Linear(linear) => we.extend(rays.iter().map(|(ray, rounding)| {
                let [dx, dy, dz] = unit(ray.direction)?;
                let [x, y, z] = ray.origin;
                let back = Ray {
                    origin: [x - rounding * dx, y - rounding * dy, z - rounding * dz],
                    direction: [dx, dy, dz],
                };
                linear.arrive(&back)
            })),
        }
        we
    }

    /// What a ray counts in the world.
    fn importance(
        &self,
        we: &FilmWe,
        pose: &Pose,
        turned: &TurnedDirection,
        time: f32,
    ) -> Option<Importance> {
        let FilmWe { raster, weight, density } = *we;
        let number = self.time_number(time)?;
        let share = self.shutter.transmission(raster[1] as f32 / self.rows, number);
        let density = density / turned.throughput;
        let area_density = 1.0 / (self.front_area * pose.area());
        let importance = Importance {
            raster,
            importance: weight * density * f64::from(share),
            density,
            area_density,
            solid_angle_density: density * turned.cosine / area_density,
        };
        // What single precision cannot hold, as a host gets it, counts nothing.
        let largest = importance.importance.max(importance.density).max(importance.solid_angle_density);
        (importance.importance as f32 > 0.0 && largest <= f64::from(f32::MAX)).then_some(importance)
    }

    /// Directions toward the lens from points of the scene, one for each. All is 0 for points that the camera does not see
    /// and for NaN; where the direction does not get through to the film, only the importance is.
    ///
    /// # Panics
    /// The slices differ in length.
    pub fn aim(&self, points: &[ScenePoint], found: &mut [Aimed]) {
        assert_eq!(points.len(), found.len(), "a batch needs as much room as it has points");
        let poses = self.poses(points.iter().map(|point| point.time));
        let inside = |(i, ScenePoint { point, sample, .. }): (usize, &ScenePoint)| {
            let inside = poses.of(i).point(point.map(f64::from));
            let numbers = sample.map(|number| f64::from(number).clamp(0.0, 1.0));
            numbers.iter().chain(&inside).all(|number| number.is_finite()).then_some((inside, numbers))
        };
        let inside: Vec<Option<([f64; 3], [f64; 2])>> = points.iter().enumerate().map(inside).collect();
        let mut aimed = Vec::with_capacity(points.len());
        match &self.optics {
            Optics::Lens(lens) => lens.aim(&inside, &mut aimed),
            Optics::Linear(linear) => aimed.extend(
                inside.iter().map(|inside| inside.and_then(|(point, numbers)| linear.aim(point, numbers))),
            ),
        }
        for (i, ((found, point), aimed)) in found.iter_mut().zip(points).zip(aimed).enumerate() {
            *found = aimed.and_then(|aimed| self.aimed(&aimed, point, poses.of(i))).unwrap_or_default();
        }
    }

    /// A direction toward the lens in the world; `None` where the camera does not see the point.
    fn aimed(&self, toward_lens: &LensDirection, point: &ScenePoint, pose: &Pose) -> Option<Aimed> {
        let LensDirection { ray: Ray { origin, direction }, density, we } = toward_lens;
        let (origin, turned) = (pose.outside(*origin), pose.turned(*direction));
        let density = density / turned.solid_angle;
        let square = |axis: usize| (f64::from(point.point[axis]) - origin[axis]).powi(2);
        let distance = (0..3).map(square).sum::<f64>().sqrt();
        let is_seen = distance >= self.distances[0] && distance <= self.distances[1];
        if !(is_seen && density as f32 > 0.0 && density <= f64::from(f32::MAX)) {
            return None;
        }
        let importance = we.and_then(|we| self.importance(&we, pose, &turned, point.time));
        Some(Aimed {
            origin,
            direction: turned.direction,
            density,
            importance: importance.unwrap_or_default(),
        })
    }
}

/// Where the camera stands for each of some rays or points.
enum Poses<'a> {
    /// For all of them.
    Still(&'a Pose),
    Moving(Vec<Pose>),
}

impl Poses<'_> {
    fn of(&self, i: usize) -> &Pose {
        match self {
            Self::Still(pose) => pose,
            Self::Moving(poses) => &poses[i],
        }
    }
}

/// A vector of length 1; `None` of what has no direction.
fn unit(direction: [f64; 3]) -> Option<[f64; 3]> {
    let found = numeric::unit(direction);
    found.iter().all(|part| part.is_finite()).then_some(found)
}
