//! Traces exact rays through a lens in either direction, many in one call. On request it also returns the
//! point where each ray meets each surface, for drawings of lenses.

use super::{
    super::{
        boundary::{self, Failure, realistic_status},
        exchange::take,
        types::{realistic_reason, realistic_vectors},
        views::{optional_column, vectors},
    },
    handle::{DirectedLens, OpenedLens, opened, realistic_lens},
};
use ::realistic_camera::columns::Strided;
use realistic_optics::{
    lens::Ray,
    trace::{Direction, Walk},
};
use realistic_trace::kernel::RayBuffer;

/// The side of a lens from which rays come. The numbers are part of the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_side {
    /// Rays come from behind the lens and travel toward +z.
    Film = 0,
    /// Rays come from in front of the lens and travel toward -z.
    Scene = 1,
}

/// Rays in lens space: a point on each ray, mm, and its direction.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_rays {
    /// `sizeof(realistic_lens_rays)`.
    pub struct_size: u32,
    /// A point on each ray.
    pub origin: realistic_vectors,
    /// Directions, of any length but 0.
    pub direction: realistic_vectors,
    /// Result of each ray; may be NULL.
    pub reason: *mut realistic_reason,
    /// Bytes from one reason to the next.
    pub reason_stride: isize,
    /// Result of each ray: the optical path, mm (lengths times indices), from the given point of the ray to the
    /// one that replaces it; may be NULL.
    pub optical_path: *mut f64,
    /// Bytes from one optical path to the next.
    pub optical_path_stride: isize,
}

/// The columns of a caller's rays.
#[derive(Clone, Copy)]
struct RayColumns {
    /// Origins and directions.
    numbers: [Strided<f64>; 6],
    reasons: Strided<realistic_reason>,
    optical_paths: Strided<f64>,
}

/// What becomes of a ray.
struct TracedRay {
    ray: Ray,
    reason: realistic_reason,
    optical_path: f64,
}

impl From<Walk> for TracedRay {
    fn from(Walk { ray, optical_path, blocked, .. }: Walk) -> Self {
        Self { ray, reason: blocked.map_or(realistic_reason::Ok, realistic_reason::from), optical_path }
    }
}

impl RayColumns {
    /// # Errors
    /// An array is missing or invalid.
    fn of(rays: &realistic_lens_rays, n: usize) -> Result<Self, Failure> {
        let [x, y, z] = vectors("rays.origin", n, &rays.origin)?;
        let [dx, dy, dz] = vectors("rays.direction", n, &rays.direction)?;
        let reasons = optional_column("rays.reason", n, rays.reason, rays.reason_stride)?;
        let optical_paths =
            optional_column("rays.optical_path", n, rays.optical_path, rays.optical_path_stride)?;
        Ok(Self { numbers: [x, y, z, dx, dy, dz], reasons, optical_paths })
    }

    /// # Safety
    /// Ray `i` exists.
    unsafe fn get(&self, i: usize) -> Ray {
        // SAFETY: the caller's promise.
        let [x, y, z, dx, dy, dz] = self.numbers.map(|column| unsafe { column.get(i) });
        Ray { origin: [x, y, z], direction: [dx, dy, dz] }
    }

    /// Writes a ray, if its numbers are finite, its reason and its optical path.
    ///
    /// # Safety
    /// Ray `i` exists.
    unsafe fn put(&self, i: usize, TracedRay { ray, reason, optical_path }: TracedRay) {
        let Ray { origin: [x, y, z], direction: [dx, dy, dz] } = ray;
        let found = [x, y, z, dx, dy, dz];
        // SAFETY: the caller's promise.
        unsafe {
            if found.iter().all(|number| number.is_finite()) {
                self.numbers.into_iter().zip(found).for_each(|(column, number)| column.put(i, number));
            }
            if self.reasons.is_there() {
                self.reasons.put(i, reason);
            }
            if self.optical_paths.is_there() {
                self.optical_paths.put(i, optical_path);
            }
        }
    }
}

/// Number of rays that are loaded and traced side by side.
const BLOCK: usize = 256;

/// Traces `n` rays through the lens from side `from` (`realistic_side`). Each ray is replaced by the point
/// where it leaves the last surface and its unit direction there. A blocked ray is replaced by the point on
/// the last surface that it met and its direction behind that surface; if it met none, only its direction
/// changes, to unit length. Rays may start anywhere before the lens. A ray with numbers that are not finite,
/// or with a direction of length 0, counts as `REALISTIC_REASON_MISSED` and does not change. Optical paths end
/// where the ray does.
///
/// `points` is NULL, or requests the points where the rays meet each surface. With points, rays are traced
/// one after another, which is slower. The results are the same as without points, except for rounding, which
/// may matter at the very edge of an aperture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_trace(
    lens: *const realistic_lens,
    from: i32,
    n: usize,
    rays: *const realistic_lens_rays,
    points: *const realistic_lens_points,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let (opened, rays) = unsafe { (opened(lens)?, take("realistic_lens_rays", "rays", rays)?) };
        let directed = directed(opened, from)?;
        let points = match points.is_null() {
            true => None,
            // SAFETY: the caller's promise.
            false => Some(unsafe { take("realistic_lens_points", "points", points)? }),
        };
        if n == 0 {
            return Ok(());
        }
        let rays = RayColumns::of(&rays, n)?;
        // SAFETY: the caller's promise.
        unsafe {
            match points {
                None => in_blocks(directed, n, &rays),
                Some(points) => walk_each(
                    directed,
                    n,
                    &rays,
                    &SurfacePointColumns::of(&points, n, opened.lens.surfaces.len())?,
                ),
            }
        }
        Ok(())
    })
}

/// Returns the lens prepared for rays from side `from`.
///
/// # Errors
/// There is no such side.
fn directed(opened: &OpenedLens, from: i32) -> Result<&DirectedLens, Failure> {
    let lens = usize::try_from(from).ok().and_then(|side| opened.directed.get(side));
    lens.ok_or_else(|| {
        Failure::invalid(format!("from is {from}; rays come from 0 (the film's side) or 1 (the scene's)"))
    })
}

/// # Safety
/// The columns have `n` rays.
unsafe fn in_blocks(lens: &DirectedLens, n: usize, rays: &RayColumns) {
    let mut buffer = RayBuffer::<f64>::new(n.min(BLOCK));
    let mut optical_paths = [0.0; BLOCK];
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        for i in 0..count {
            // SAFETY: the caller's promise.
            let Ray { origin, direction } = unsafe { rays.get(first + i) };
            buffer.put(i, origin, direction);
        }
        if rays.optical_paths.is_there() {
            lens.path_kernel().trace_in_place(&mut buffer.part(0..count), &mut optical_paths[..count]);
        } else {
            lens.kernel.trace_in_place(&mut buffer.part(0..count));
        }
        for (i, &optical_path) in optical_paths[..count].iter().enumerate() {
            // SAFETY: the caller's promise.
            unsafe {
                let traced = match buffer.get(i) {
                    Some(traced) => {
                        TracedRay { ray: traced.ray(), reason: realistic_reason::Ok, optical_path }
                    }
                    None => blocked(lens, rays.get(first + i)),
                };
                rays.put(first + i, traced);
            }
        }
    }
}

/// Returns the end of a ray that the kernel blocks, and the reason. If the walk lets the ray pass, the ray is
/// within rounding of an edge and counts as clipped.
fn blocked(lens: &DirectedLens, ray: Ray) -> TracedRay {
    let walk = lens.path.walk(ray);
    let clipped = walk.blocked.is_none().then_some(realistic_reason::Clipped);
    let traced = TracedRay::from(walk);
    TracedRay { reason: clipped.unwrap_or(traced.reason), ..traced }
}

/// Points where rays meet the surfaces of a lens, lens space, mm.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_points {
    /// `sizeof(realistic_lens_points)`.
    pub struct_size: u32,
    /// The point of ray i on surface k is element i · `surfaces` + k, where `surfaces` is that of
    /// `realistic_lens_info` and k is counted from 0 at the scene side, whatever the direction of travel. It
    /// is NaN if the ray does not reach the surface.
    pub point: realistic_vectors,
    /// Number of surfaces that each ray meets, including the one that blocks it; one element per ray; may be
    /// NULL.
    pub met: *mut u32,
    /// Bytes from one element of `met` to the next.
    pub met_stride: isize,
}

/// A caller's columns for the points where rays meet the surfaces.
struct SurfacePointColumns {
    point: [Strided<f64>; 3],
    met: Strided<u32>,
    surfaces: usize,
}

impl SurfacePointColumns {
    /// # Errors
    /// An array is missing or invalid.
    fn of(points: &realistic_lens_points, n: usize, surfaces: usize) -> Result<Self, Failure> {
        let all =
            n.checked_mul(surfaces).ok_or_else(|| boundary::too_many(n, surfaces * size_of::<f64>()))?;
        let point = vectors("points.point", all, &points.point)?;
        let met = optional_column("points.met", n, points.met, points.met_stride)?;
        Ok(Self { point, met, surfaces })
    }

    /// Writes the point of ray `i` on a surface.
    ///
    /// # Safety
    /// The columns have an element for this ray and surface.
    unsafe fn put(&self, i: usize, surface: usize, point: [f64; 3]) {
        for (column, number) in self.point.into_iter().zip(point) {
            // SAFETY: the caller's promise.
            unsafe { column.put(i * self.surfaces + surface, number) };
        }
    }
}

/// Traces rays through the lens one after another, and records the points where they meet the surfaces.
///
/// # Safety
/// The columns have `n` rays, and the points have room for as many.
unsafe fn walk_each(lens: &DirectedLens, n: usize, rays: &RayColumns, points: &SurfacePointColumns) {
    let surfaces = points.surfaces;
    for i in 0..n {
        // SAFETY: the caller's promise.
        let put = |surface, point| unsafe { points.put(i, surface, point) };
        (0..surfaces).for_each(|surface| put(surface, [f64::NAN; 3]));
        // SAFETY: the caller's promise.
        let ray = unsafe { rays.get(i) };
        let walk = lens.path.walk_by(ray, |along, point| {
            let surface = match lens.direction {
                Direction::SceneToFilm => along,
                Direction::FilmToScene => surfaces - 1 - along,
            };
            put(surface, point);
        });
        // SAFETY: the caller's promise.
        unsafe {
            if points.met.is_there() {
                points.met.put(i, walk.surfaces_met as u32);
            }
            rays.put(i, walk.into());
        }
    }
}
