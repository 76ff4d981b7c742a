//! The importance of a lens: rays from the scene traced to the film, and directions toward the lens from scene points.

use super::{FilmWe, LensDirection, entrance::SeenPupil, film::ImportanceFilm};
use crate::{
    camera::pipeline::{body::CameraBody, on_demand::OnDemand},
    lens::{Lens, Ray, Surface, pupil::EntrancePupil, refraction::Refraction},
    numeric::root,
    prescription::Blades,
    trace::{
        Direction, Path,
        kernel::{Cpu, Kernel, Lanes, OneLane, Portable, RayBuffer},
    },
};

/// How far behind the front vertex the point of the axis lies at least that the scene is seen from, over the front surface's
/// clear semi-diameter.
const BEHIND: f64 = 0.05;
/// How far before where it is said to begin a ray begins, over the front surface's clear semi-diameter: those of a camera
/// begin on the surface, but for rounding.
const BACK: f64 = 1e-4;

/// A lens and the film behind it, for rays from the scene.
#[derive(Clone, Debug)]
pub(crate) struct LensBackward {
    front: Front,
    film: ImportanceFilm,
    /// From scene to film, with the blades.
    kernel: Kernel<f64>,
    /// The same without them.
    whole: Path,
    /// z of the entrance pupil, if that lies in the lens.
    pupil: f64,
    entrance: OnDemand<Option<SeenPupil>>,
}

impl LensBackward {
    /// Of a lens, the blades in its stop and what lies behind and around it.
    pub fn new(lens: &Lens, blades: Option<Blades>, body: &CameraBody) -> Self {
        let pupil = EntrancePupil::of_lens(lens).position().unwrap_or(0.0);
        let film = ImportanceFilm::new(body);
        let whole = Path::new(lens, Direction::SceneToFilm, Refraction::Fused);
        Self {
            front: Front::of(lens),
            film,
            kernel: Kernel::along(&whole.clone().with_blades(lens, blades)),
            whole,
            pupil: pupil.max(lens.rear().vertex).min(-BEHIND * lens.front().semi_diameter),
            entrance: OnDemand::new(),
        }
    }

    /// Whether the lens has been looked at from everywhere.
    pub fn is_tabulated(&self) -> bool {
        self.entrance.get().is_some()
    }

    /// Area of the front clear aperture, mm².
    pub fn front_area(&self) -> f64 {
        std::f64::consts::PI * self.front.surface.semi_diameter.powi(2)
    }

    /// The importance of rays with directions of any length; NaN and direction 0 have none. `rounding` is how far off its origin
    /// a ray may have been rounded.
    pub fn arrive(&self, rays: &[(Ray, f64)], we: &mut Vec<Option<FilmWe>>) {
        let mut buffer = RayBuffer::<f64>::new(rays.len());
        let back = BACK * self.front.surface.semi_diameter;
        let is_ray: Vec<bool> = rays
            .iter()
            .enumerate()
            .map(|(i, (Ray { origin, direction }, rounding))| {
                let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
                let moved = (back + rounding) / length;
                let start = [0, 1, 2].map(|axis| origin[axis] - moved * direction[axis]);
                let unit = direction.map(|part| part / length);
                let is_ray = start.iter().chain(direction).all(|part| part.is_finite())
                    && self.front.is_before(start)
                    && self.front.meets(&Ray { origin: start, direction: unit });
                if is_ray {
                    buffer.put(i, start, *direction);
                }
                is_ray
            })
            .collect();
        let first = we.len();
        self.land(&mut buffer, we);
        for (we, is_ray) in we[first..].iter_mut().zip(is_ray) {
            *we = we.filter(|_| is_ray);
        }
    }

    /// What rays before the lens count.
    fn land(&self, rays: &mut RayBuffer<f64>, we: &mut Vec<Option<FilmWe>>) {
        self.kernel.trace_in_place(&mut rays.rays());
        self.film.we(rays, we);
    }

    /// Directions toward the lens from points, each for two numbers in [0, 1], and what they count.
    pub fn aim(&self, points: &[Option<([f64; 3], [f64; 2])>], found: &mut Vec<Option<LensDirection>>) {
        let Some(entrance) = self.entrance.get_or_make(|| self.tabulate()) else {
            found.extend(points.iter().map(|_| None));
            return;
        };
        let mut rays = RayBuffer::<f64>::new(points.len());
        let first = found.len();
        entrance.aim(&self.front, points, &mut rays, found);
        let mut we = Vec::with_capacity(points.len());
        self.land(&mut rays, &mut we);
        for (toward_lens, we) in found[first..].iter_mut().zip(we) {
            *toward_lens = toward_lens.map(|toward_lens| LensDirection { we, ..toward_lens });
        }
    }

    /// Looks at the lens from everywhere. The pupil is that of the whole stop: what of it the blades cover is blocked.
    fn tabulate(&self) -> Option<SeenPupil> {
        SeenPupil::build(&self.whole, &self.front, self.film.z(), self.film.half(), self.pupil)
    }
}

/// The front surface, and how deep the lens is behind it.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub surface: Surface,
    /// z of its foremost point.
    foremost: f64,
    /// z of the rear vertex.
    pub rear: f64,
}

impl Front {
    /// Of a lens.
    pub fn of(lens: &Lens) -> Self {
        let surface = *lens.front();
        Self { surface, foremost: surface.sagitta_range()[1], rear: lens.rear().vertex }
    }

    /// Whether a point lies before the surface or anywhere beside it: a fisheye sees what lies behind its rim.
    pub fn is_before(&self, [x, y, z]: [f64; 3]) -> bool {
        let (front, square) = (&self.surface, x * x + y * y);
        z > self.foremost
            || square >= front.semi_diameter * front.semi_diameter
            || z > front.sagitta(square.sqrt())
    }

    /// Whether a ray of unit direction that begins before it meets the surface from outside: one that begins farther back
    /// than the lens goes toward +z.
    pub fn meets(&self, ray: &Ray) -> bool {
        if ray.origin[2] > self.rear {
            return true;
        }
        let front = &self.surface;
        if front.figure.is_some() || !(ray.direction[2] > 0.0) {
            return false;
        }
        let [x, y, z] = self.point(ray);
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let ahead = (x - ox) * dx + (y - oy) * dy + (z - oz) * dz;
        // The gradient of c (x² + y² + z²) + 2 z.
        let inward = front.curvature * (x * dx + y * dy + z * dz) + dz;
        ahead > 0.0 && inward < 0.0
    }

    /// Where a ray from the scene, with a unit direction, meets the surface; where it misses that, where it begins.
    pub fn point(&self, ray: &Ray) -> [f64; 3] {
        let front = &self.surface;
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
            let [origin, direction] =
                [ray.origin, ray.direction].map(|vector| vector.map(|part| Portable([part])));
            let Portable([length]) = self.length(OneLane::cpu(), origin, direction);
            length
        };
        if length.is_finite() { at(length) } else { ray.origin }
    }

    /// How far along rays with unit directions a sphere, or a plane, is met.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn length<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, [x, y, z]: [L; 3], [dx, dy, dz]: [L; 3]) -> L {
        // c (x² + y² + z²) + 2 z = 0, by its root on the vertex's side.
        let c = L::splat(cpu, self.surface.curvature);
        let half = c * (x * dx + y * dy + z * dz) + dz;
        let constant = c * (x * x + y * y + z * z) + z + z;
        constant / ((half * half - c * constant).sqrt() - half)
    }

    /// Heights from 0 to the rim, and z there: so many and one more.
    pub fn profile(&self, parts: u32) -> Vec<[f64; 2]> {
        let height = |k: u32| self.surface.semi_diameter * f64::from(k) / f64::from(parts);
        (0..=parts).map(|k| [height(k), self.surface.sagitta(height(k))]).collect()
    }
}
