//! Traces exact rays through a lens in either direction, many in one call; on request with the point where each ray
//! meets each surface, for drawings of lenses.

use super::{
    super::{
        boundary::{self, Failure, fits_memory, realistic_status},
        exchange::{required_arrays, take},
        types::realistic_reason,
    },
    handle::{LensKernel, OpenedLens, opened, realistic_lens},
};
use realistic_optics::{
    lens::Ray,
    trace::{Direction, Walk},
};
use realistic_trace::kernel::RayBuffer;

/// The side of a lens that rays come from. The numbers are part of the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_side {
    /// Behind the lens; rays travel toward +z.
    Film = 0,
    /// In front of the lens; rays travel toward -z.
    Scene = 1,
}

/// Rays in lens space as structure of arrays, one number per ray in each: a point on the ray, mm, and its direction.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_rays {
    /// `sizeof(realistic_lens_rays)`.
    pub struct_size: u32,
    /// x of a point on each ray.
    pub ox: *mut f64,
    /// y.
    pub oy: *mut f64,
    /// z.
    pub oz: *mut f64,
    /// x of each direction, of any length but 0.
    pub dx: *mut f64,
    /// y.
    pub dy: *mut f64,
    /// z.
    pub dz: *mut f64,
    /// Result of each ray; may be NULL.
    pub reason: *mut realistic_reason,
}

/// Number of rays traced side by side before the next are loaded.
const BLOCK: usize = 256;

/// Traces `n` rays through the lens from side `from` (`realistic_side`) and replaces each by the point where it leaves
/// the last surface and its unit direction there. A blocked ray ends on the last surface that it met, with the
/// direction behind that surface; if it met none, only the length of its direction changes. Rays may start anywhere
/// before the lens. A ray with numbers that are not finite, or with a direction of length 0, counts as
/// `REALISTIC_REASON_MISSED` and does not change.
///
/// `points` is NULL, or requests the points where the rays meet each surface. Rays are then traced one after another,
/// which is slower. They agree with rays without points, except for rounding, which may decide at the very edge of an
/// aperture.
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
        let way = way(opened, from)?;
        fits_memory(n, size_of::<f64>())?;
        // SAFETY: the caller's promise.
        let points = unsafe { checked_points(points, n, opened.lens.surfaces.len())? };
        if n == 0 {
            return Ok(());
        }
        let arrays = arrays(&rays)?;
        // SAFETY: the caller's promise.
        unsafe {
            match points {
                None => in_blocks(way, n, arrays, rays.reason),
                Some(points) => {
                    for i in 0..n {
                        let numbers = arrays.map(|array| array.add(i));
                        walk(way, numbers, rays.reason, &points, i, opened.lens.surfaces.len());
                    }
                }
            }
        }
        Ok(())
    })
}

/// Returns the lens prepared for rays from side `from`.
fn way(opened: &OpenedLens, from: i32) -> Result<&LensKernel, Failure> {
    let way = usize::try_from(from).ok().and_then(|side| opened.ways.get(side));
    way.ok_or_else(|| {
        Failure::invalid(format!("from is {from}; rays come from 0 (the film's side) or 1 (the scene's)"))
    })
}

/// Returns the coordinate arrays of the points and directions; refuses NULL.
fn arrays(rays: &realistic_lens_rays) -> Result<[*mut f64; 6], Failure> {
    let arrays = [rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz];
    required_arrays("rays", ["ox", "oy", "oz", "dx", "dy", "dz"], arrays.map(|array| array.cast_const()))?;
    Ok(arrays)
}

/// # Safety
/// The arrays have room for `n` elements; `reasons` is NULL or has room for `n`, too.
unsafe fn in_blocks(way: &LensKernel, n: usize, arrays: [*mut f64; 6], reasons: *mut realistic_reason) {
    let mut buffer = RayBuffer::<f64>::new(n.min(BLOCK));
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        for i in 0..count {
            // SAFETY: the caller's promise.
            let [x, y, z, dx, dy, dz] = arrays.map(|array| unsafe { array.add(first + i).read_unaligned() });
            buffer.put(i, [x, y, z], [dx, dy, dz]);
        }
        way.kernel.trace_in_place(&mut buffer.part(0..count));
        for i in 0..count {
            let place = arrays.map(|array| array.wrapping_add(first + i));
            let (ray, reason) = match buffer.get(i) {
                Some(traced) => (Some(traced.ray()), realistic_reason::Ok),
                // SAFETY: the caller's promise.
                None => blocked(way, place.map(|number| unsafe { number.read_unaligned() })),
            };
            // SAFETY: the caller's promise.
            unsafe {
                if let Some(Ray { origin: [x, y, z], direction: [dx, dy, dz] }) = ray {
                    for (number, found) in place.into_iter().zip([x, y, z, dx, dy, dz]) {
                        number.write_unaligned(found);
                    }
                }
                if !reasons.is_null() {
                    reasons.add(first + i).write_unaligned(reason);
                }
            }
        }
    }
}

/// Returns the end of a ray that the kernel blocks, and the reason. If the walk passes the ray, it is within rounding
/// of an edge and counts as clipped.
fn blocked(way: &LensKernel, [x, y, z, dx, dy, dz]: [f64; 6]) -> (Option<Ray>, realistic_reason) {
    let Walk { ray, blocked, .. } = way.path.walk(Ray { origin: [x, y, z], direction: [dx, dy, dz] });
    let is_number = ray.origin.iter().chain(&ray.direction).all(|number| number.is_finite());
    (is_number.then_some(ray), blocked.map_or(realistic_reason::Clipped, realistic_reason::from))
}

/// Points where rays meet the surfaces of a lens, lens space, mm. The point of ray i on surface k, counted from 0 at
/// the scene side for both directions of travel, is element i · `surfaces` + k of `x`, `y` and `z`, with `surfaces` of
/// `realistic_lens_info`; NaN if the ray does not reach the surface.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_points {
    /// `sizeof(realistic_lens_points)`.
    pub struct_size: u32,
    /// x of the points.
    pub x: *mut f64,
    /// y.
    pub y: *mut f64,
    /// z.
    pub z: *mut f64,
    /// Number of surfaces that each ray meets, the one that blocks it included; one element per ray, may be NULL.
    pub met: *mut u32,
}

/// Returns a caller's arrays for the points of rays, if there are any.
///
/// # Safety
/// `points` is NULL or points to a structure of its `struct_size` bytes.
unsafe fn checked_points(
    points: *const realistic_lens_points,
    n: usize,
    surfaces: usize,
) -> Result<Option<realistic_lens_points>, Failure> {
    if points.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    let points = unsafe { take("realistic_lens_points", "points", points)? };
    fits_memory(n, surfaces * size_of::<f64>())?;
    if n > 0 {
        let room = [points.x, points.y, points.z].map(|array| array.cast_const());
        required_arrays("points", ["x", "y", "z"], room)?;
    }
    Ok(Some(points))
}

/// Traces ray `i` through the lens, and records the points where it meets the surfaces.
///
/// # Safety
/// `numbers` are readable and writable; `reasons` and the points' `met` are NULL or have more than `i` elements, and the
/// points' other arrays more than `i` times `surfaces`.
unsafe fn walk(
    way: &LensKernel,
    numbers: [*mut f64; 6],
    reasons: *mut realistic_reason,
    points: &realistic_lens_points,
    i: usize,
    surfaces: usize,
) {
    let realistic_lens_points { x, y, z, met, .. } = *points;
    let place = |surface: usize| [x, y, z].map(|array| array.wrapping_add(i * surfaces + surface));
    let put = |surface: usize, point: [f64; 3]| {
        for (number, found) in place(surface).into_iter().zip(point) {
            // SAFETY: the caller's promise.
            unsafe { number.write_unaligned(found) };
        }
    };
    (0..surfaces).for_each(|surface| put(surface, [f64::NAN; 3]));
    // SAFETY: the caller's promise.
    let [x, y, z, dx, dy, dz] = numbers.map(|number| unsafe { number.read_unaligned() });
    let walk = way.path.walk_by(Ray { origin: [x, y, z], direction: [dx, dy, dz] }, |along, point| {
        let surface = match way.direction {
            Direction::SceneToFilm => along,
            Direction::FilmToScene => surfaces - 1 - along,
        };
        put(surface, point);
    });
    let Ray { origin: [x, y, z], direction: [dx, dy, dz] } = walk.ray;
    let found = [x, y, z, dx, dy, dz];
    // SAFETY: the caller's promise.
    unsafe {
        if found.iter().all(|number| number.is_finite()) {
            numbers.into_iter().zip(found).for_each(|(number, found)| number.write_unaligned(found));
        }
        if !reasons.is_null() {
            let reason = walk.blocked.map_or(realistic_reason::Ok, realistic_reason::from);
            reasons.add(i).write_unaligned(reason);
        }
        if !met.is_null() {
            met.add(i).write_unaligned(walk.surfaces_met as u32);
        }
    }
}
