//! A lens the other way round: rays from the scene traced to the film, and directions toward the lens from a point.

use super::{
    counted::Towards,
    entrance::{self, Entrance, FilmRay, Node, Probe, Work},
    fan::{LIMITS, Limit},
    film::{Counted, FilmCount},
};
use crate::{
    camera::pipeline::{body::CameraBody, on_demand::OnDemand},
    lens::{Lens, Ray, Surface, pupil::EntrancePupil, refraction::Refraction},
    numeric::{quasirandom::STEPS, root},
    prescription::{BladeConstants, Blades},
    trace::{
        Direction, Path,
        kernel::{Kernel, RayBuffer},
    },
};

/// How far behind the front vertex, or its rim, the points of the axis lie that the scene is seen from, over the front
/// surface's clear semi-diameter.
const BEHIND: f64 = 0.05;
/// How far before where it is said to begin a ray begins, over the front surface's clear semi-diameter: those of a camera
/// begin on the surface, but for rounding.
const BACK: f64 = 1e-4;

/// A lens and the film behind it, for rays from the scene.
#[derive(Clone, Debug)]
pub(crate) struct LensBackward {
    lens: Lens,
    count: FilmCount,
    /// From scene to film, with the blades.
    kernel: Kernel<f64>,
    /// z of the entrance pupil, if that lies in the lens.
    pupil: f64,
    entrance: OnDemand<Option<Entrance>>,
    /// Sides of the film.
    window: [Limit; 4],
    /// Straight edges that hold the blades' figure in the stop; none where it nearly fills that.
    blades: Vec<Limit>,
}

impl LensBackward {
    /// Of a lens, the blades in its stop and what lies behind and around it.
    pub fn new(lens: &Lens, blades: Option<Blades>, body: &CameraBody) -> Self {
        let front = lens.front();
        let pupil = EntrancePupil::of_lens(lens).position().unwrap_or(0.0);
        let path = Path::new(lens, Direction::SceneToFilm, Refraction::Fused).with_blades(lens, blades);
        let count = FilmCount::new(body);
        Self {
            lens: lens.clone(),
            window: count.window().limits(),
            blades: edges(lens, blades),
            count,
            kernel: Kernel::along(&path),
            pupil: pupil.max(lens.rear().vertex).min(-BEHIND * front.semi_diameter),
            entrance: OnDemand::new(),
        }
    }

    /// Whether the lens has been looked at from everywhere.
    pub fn is_tabulated(&self) -> bool {
        self.entrance.get().is_some()
    }

    /// Area of the front clear aperture, mm².
    pub fn front_area(&self) -> f64 {
        std::f64::consts::PI * self.lens.front().semi_diameter.powi(2)
    }

    /// Whether a point lies before the front surface or anywhere beside it: a fisheye sees what lies behind its rim.
    fn is_in_front(&self, [x, y, z]: [f64; 3]) -> bool {
        let (front, height) = (self.lens.front(), x.hypot(y));
        height >= front.semi_diameter || z > front.sagitta(height)
    }

    /// Whether a ray of unit direction that begins in front meets the front surface from outside: one that begins farther
    /// back than the lens goes toward +z.
    fn comes_from_outside(&self, ray: &Ray) -> bool {
        let front = self.lens.front();
        if ray.origin[2] > self.lens.rear().vertex {
            return true;
        }
        if front.figure.is_some() || !(ray.direction[2] > 0.0) {
            return false;
        }
        let [x, y, z] = front_point(front, ray);
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let ahead = (x - ox) * dx + (y - oy) * dy + (z - oz) * dz;
        // The gradient of c (x² + y² + z²) + 2 z.
        let inward = front.curvature * (x * dx + y * dy + z * dz) + dz;
        ahead > 0.0 && inward < 0.0
    }

    /// What rays count, of any length of direction; those that are none count nothing. `rounding` is how far off its origin
    /// a ray may have been rounded.
    pub fn arrive(&self, rays: &[(Ray, f64)], counted: &mut Vec<Option<Counted>>) {
        let mut buffer = RayBuffer::<f64>::new(rays.len());
        let back = BACK * self.lens.front().semi_diameter;
        let is_ray: Vec<bool> = rays
            .iter()
            .enumerate()
            .map(|(i, (Ray { origin, direction }, rounding))| {
                let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
                let moved = (back + rounding) / length;
                let start = [0, 1, 2].map(|axis| origin[axis] - moved * direction[axis]);
                let is_ray = start.iter().chain(direction).all(|part| part.is_finite())
                    && self.is_in_front(start)
                    && self.comes_from_outside(&Ray {
                        origin: start,
                        direction: direction.map(|part| part / length),
                    });
                if is_ray {
                    buffer.put(i, start, *direction);
                }
                is_ray
            })
            .collect();
        self.kernel.trace_in_place(&mut buffer.rays());
        counted.extend(is_ray.into_iter().enumerate().map(|(i, is_ray)| {
            let ray = buffer.get(i).filter(|_| is_ray)?.ray();
            let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
            let (slopes, along) = ([dx / dz, dy / dz], self.count.z() - z);
            self.count.count([x + along * slopes[0], y + along * slopes[1]], slopes)
        }));
    }

    /// A direction toward the lens from a point, for two numbers in [0, 1].
    pub fn aim(&self, point: [f64; 3], numbers: [f64; 2]) -> Option<Towards> {
        if !(point.iter().all(|part| part.is_finite()) && self.is_in_front(point)) {
            return None;
        }
        let entrance = self.entrance.get_or_make(|| self.tabulate(&self.work())).as_ref()?;
        let spot = entrance.sight.spot(point);
        let Node { fan, image, stop } = entrance.seen_from(&spot)?;
        let views = [(&image, &self.window[..]), (&stop, &self.blades[..])];
        let (at, density) = fan.sample(&views, spot.azimuth, numbers)?;
        let (ray, stretch) = spot.ray(at, self.lead());
        if !self.comes_from_outside(&Ray { origin: point, ..ray }) {
            return None;
        }
        let density = density * stretch.powi(3) / spot.vergence.powi(2);
        let origin = front_point(self.lens.front(), &ray);
        (density > 0.0).then_some(Towards { ray: Ray { origin, ..ray }, density })
    }

    /// For counting what looking at the lens from everywhere takes.
    pub(super) fn work(&self) -> Work {
        Work::through(&self.lens)
    }

    /// Longer than anything in front of where the scene is seen from.
    fn lead(&self) -> f64 {
        let front = self.lens.front();
        let [low, high] = front.sagitta_range();
        2.0 * (front.semi_diameter + self.pupil.abs() + high - low)
    }

    /// Looks at the lens from everywhere. The pupil is that of the whole stop: what of it the blades cover is blocked.
    pub(super) fn tabulate(&self, work: &Work) -> Option<Entrance> {
        const RINGS: u32 = 8;
        let front = self.lens.front();
        let whole = Kernel::new(&self.lens, Direction::SceneToFilm);
        // Up to the stop, from both sides.
        let stop = self.lens.stop_index().filter(|_| !self.blades.is_empty());
        let part = |surfaces: &[Surface], direction| {
            Kernel::<f64>::new(&Lens { surfaces: surfaces.to_vec(), ..self.lens.clone() }, direction)
        };
        let surfaces = &self.lens.surfaces;
        let to_stop = stop.map(|stop| part(&surfaces[..=stop], Direction::SceneToFilm));
        let from_film = stop.map(|stop| part(&surfaces[stop..], Direction::FilmToScene));
        let ring = |ring: u32| front.semi_diameter * f64::from(ring) / f64::from(RINGS);
        let probe = Probe {
            kernel: &whole,
            to_stop: to_stop.as_ref(),
            film: self.count.z(),
            reach: self.count.side().film.diagonal() / 2.0,
            is_sampled: &|point, slopes| self.count.is_sampled(point, slopes),
            pupil: self.pupil,
            still: self.pupil.min(front.sagitta_range()[0] - BEHIND * front.semi_diameter),
            foremost: -BEHIND * front.semi_diameter,
            cap: (0..=RINGS).map(|number| [ring(number), front.sagitta(ring(number))]).collect(),
            lead: self.lead(),
            work,
        };
        let mut entrance = entrance::build(&probe)?;
        let out = Kernel::<f64>::new(&self.lens, Direction::FilmToScene);
        let side = self.count.side();
        let traced = |kernel: &Kernel<f64>, from: &[([f64; 2], [f64; 2])]| {
            work.count(from.len());
            let mut buffer = RayBuffer::<f64>::new(from.len());
            for (i, ([x, y], [sx, sy])) in from.iter().enumerate() {
                buffer.put(i, [*x, *y, side.z], [*sx, *sy, 1.0]);
            }
            kernel.trace_in_place(&mut buffer.rays());
            buffer
        };
        entrance.repair(work, |first, count| {
            let from: Vec<([f64; 2], [f64; 2])> = (first..first + count)
                .filter_map(|number| side.sample(STEPS.map(|step| (0.5 + number as f64 * step).fract())))
                .map(|(point, sample)| (point, sample.slopes))
                .collect();
            let (through, at_stop) =
                (traced(&out, &from), from_film.as_ref().map(|kernel| traced(kernel, &from)));
            let ray = |i: usize| {
                let stop = at_stop.as_ref().and_then(|buffer| buffer.get(i)).map(|at| at.origin);
                let ray = through.get(i)?.ray();
                Some(FilmRay { ray, film: from[i].0, stop: stop.map(|[x, y, _]| [x, y]) })
            };
            (0..from.len()).filter_map(ray).collect()
        });
        Some(entrance)
    }
}

/// Straight edges in the plane of the stop that hold the figure that blades leave open; none where they are many or it is
/// nearly the circle.
fn edges(lens: &Lens, blades: Option<Blades>) -> Vec<Limit> {
    /// The figure's area over the circle's from which on the circle will do.
    const FULL: f64 = 0.95;
    let (Some(blades), Some(stop)) = (blades, lens.stop_index()) else { return Vec::new() };
    if blades.count as usize > LIMITS || blades.share() > FULL {
        return Vec::new();
    }
    // Where bulge r² + slant r comes to the limit, in the middle of an edge.
    let BladeConstants { bulge, slant, limit } = blades.constants();
    let middle = 2.0 * limit / (slant + (slant * slant + 4.0 * bulge * limit).sqrt());
    let distance = middle * lens.surfaces[stop].semi_diameter;
    blades.normals().map(|[x, y]| [x, y, distance]).collect()
}

/// Where a ray from the scene, with a unit direction, meets the front surface; where it misses that, where it begins.
fn front_point(front: &Surface, ray: &Ray) -> [f64; 3] {
    let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
    let at = |t: f64| [x + t * dx, y + t * dy, z + t * dz];
    let length = if front.figure.is_some() {
        let [low, high] = front.sagitta_range();
        if !(dz < 0.0) {
            return ray.origin;
        }
        let above = |t: f64| {
            let [x, y, z] = at(t);
            z - front.sagitta(x.hypot(y).min(front.semi_diameter))
        };
        root((high - z) / dz, (low - z) / dz, above)
    } else {
        // c (x² + y² + z²) + 2 z = 0, by its root on the vertex's side.
        let c = front.curvature;
        let half = c * (x * dx + y * dy + z * dz) + dz;
        let constant = c * (x * x + y * y + z * z) + 2.0 * z;
        constant / ((half * half - c * constant).sqrt() - half)
    };
    if length.is_finite() { at(length) } else { ray.origin }
}
