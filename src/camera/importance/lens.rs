//! The importance of a lens: rays from the scene traced to the film, and directions toward the lens from scene points.

use super::{FilmWe, LensDirection, entrance::SeenPupil, film::ImportanceFilm, front::Front};
use crate::{
    camera::pipeline::{body::CameraBody, on_demand::OnDemand},
    lens::{Lens, Ray, pupil::EntrancePupil, refraction::Refraction},
    prescription::Blades,
    trace::{
        Direction, Path,
        kernel::{Kernel, RayBuffer},
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
pub(crate) struct AdjointLens {
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

impl AdjointLens {
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
