//! The front surface of a lens and its intersection with rays from the scene.

use realistic_base::numeric::dot;
use realistic_optics::{
    lens::{Lens, Ray, Surface, refraction::Refraction},
    trace::{Direction, Path},
};
use realistic_simd::{Cpu, Lanes, OneLane, Portable};

/// The front surface of a lens and the z of the rear vertex.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub surface: Surface,
    /// Whether only the walk can tell where rays meet the lens: the surfaces do not share an axis, the front surface is
    /// not symmetric, or mirrors stand in front of it.
    pub is_general: bool,
    /// The path through the lens for rays from the scene; rays are intersected only with its first surface.
    path: Path,
    /// z of the foremost point of the front surface.
    foremost: f64,
    /// z of the rear vertex.
    pub rear: f64,
}

impl Front {
    /// Returns the front of a lens.
    pub fn of(lens: &Lens) -> Self {
        let surface = lens.front().clone();
        let path = Path::new(lens, Direction::SceneToFilm, Refraction::Fused);
        let is_general = !lens.is_round();
        let rear = if is_general { f64::NEG_INFINITY } else { lens.rear().vertex };
        Self { foremost: surface.sagitta_range()[1], surface, is_general, path, rear }
    }

    /// Whether a point lies in front of the surface or beside it at any z; the latter because a fisheye sees
    /// points behind the edge of its front surface.
    pub fn is_before(&self, [x, y, z]: [f64; 3]) -> bool {
        let (front, square) = (&self.surface, x * x + y * y);
        self.is_general
            || z > self.foremost
            || square >= front.semi_diameter * front.semi_diameter
            || z > front.sagitta(square.sqrt())
    }

    /// Whether a ray of unit direction meets the surface from outside, ahead of its origin. Rays that begin before the
    /// foremost point travel toward the lens.
    pub fn meets(&self, ray: &Ray) -> bool {
        let [origin, direction] =
            [ray.origin, ray.direction].map(|vector| vector.map(|part| Portable([part])));
        OneLane::<f64>::all(self.are_met(OneLane::cpu(), origin, direction))
    }

    /// Performs the test of [`Front::meets`] in lanes. For an asphere this rejects only rays that begin
    /// behind the lens; the rays that miss the surface are found by [`Front::point`].
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn are_met<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, origin: [L; 3], direction: [L; 3]) -> L::Mask {
        let number = |number: f64| L::splat(cpu, number);
        let (zero, one, ([x, y, z], [dx, dy, dz])) = (number(0.0), number(1.0), (origin, direction));
        let is_before_rear = number(self.rear).less(z);
        if self.is_general || self.surface.figure.is_some() {
            return is_before_rear;
        }
        let is_far = number(self.foremost).less(z);
        if L::all(is_far) {
            return is_far;
        }
        let length = self.length(cpu, origin, direction);
        let at = [length.mul_add(dx, x), length.mul_add(dy, y), length.mul_add(dz, z)];
        // The gradient of c (x² + y² + z²) + 2 z.
        let along = at[0] * dx + at[1] * dy + at[2] * dz;
        let inward = number(self.surface.curvature).mul_add(along, dz);
        let ahead = L::both(zero.less(length), length.less(number(f64::INFINITY)));
        // Rays that begin behind the lens travel toward +z, to a front surface that bulges.
        let comes = L::select(is_before_rear, one, dz);
        let is_met = L::both(L::both(zero.less(comes), inward.less(zero)), ahead);
        zero.less(L::select(is_far, one, L::select(is_met, one, zero)))
    }

    /// Returns the point where a ray from the scene meets an aspheric surface; if the ray misses the surface,
    /// the ray's origin.
    pub fn point(&self, ray: &Ray) -> [f64; 3] {
        self.path.first_point(*ray).unwrap_or(ray.origin)
    }

    /// Samples a direction from a scene point to a point of the clear aperture, given in the unit disk. Returns the ray's
    /// point on the front surface, its direction and the density per solid angle; `None` if the surface does not face the
    /// point, or is met elsewhere first. Where the aperture has the area A, and N is the normal whose z component is 1,
    /// the density is d²/(A |N·D|) at the distance d.
    pub fn aim(&self, from: [f64; 3], disk: [f64; 2]) -> Option<([f64; 3], [f64; 3], f64)> {
        let radius = self.surface.semi_diameter;
        let (point, normal) = self.path.first_surface_at(disk.map(|part| part * radius))?;
        let to_point: [f64; 3] = std::array::from_fn(|i| point[i] - from[i]);
        let distance = dot(to_point, to_point).sqrt();
        let direction = to_point.map(|part| part / distance);
        let facing = -dot(normal, direction);
        let met = self.path.first_point(Ray { origin: from, direction })?;
        let off: [f64; 3] = std::array::from_fn(|i| met[i] - point[i]);
        // Another crossing lies much farther away than rounding errors.
        let is_first = dot(off, off).sqrt() <= 1e-6 * radius + 1e-9 * distance;
        let density = distance * distance / (std::f64::consts::PI * radius * radius * facing);
        (is_first && facing > 0.0 && density.is_finite()).then_some((point, direction, density))
    }

    /// Returns the distance along rays with unit directions to a sphere or plane.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn length<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, [x, y, z]: [L; 3], [dx, dy, dz]: [L; 3]) -> L {
        // The root of c (x² + y² + z²) + 2 z = 0 that lies on the vertex's side of the sphere.
        let c = L::splat(cpu, self.surface.curvature);
        let half = c * (x * dx + y * dy + z * dz) + dz;
        let constant = c * (x * x + y * y + z * z) + z + z;
        constant / ((half * half - c * constant).sqrt() - half)
    }

    /// Returns `parts` + 1 heights from 0 to the edge of the surface, and z at each height.
    pub fn profile(&self, parts: u32) -> Vec<[f64; 2]> {
        let height = |k: u32| self.surface.semi_diameter * f64::from(k) / f64::from(parts);
        (0..=parts).map(|k| [height(k), self.surface.sagitta(height(k))]).collect()
    }
}
