//! Exact rays through a lens, either way, many in one call.

use super::{
    super::{
        boundary::{self, Failure, fits_memory, realistic_status},
        exchange::{required_arrays, take},
        types::realistic_reason,
    },
    handle::{OpenedLens, Way, opened, realistic_lens},
    points::{Places, realistic_lens_points},
};
use crate::{
    lens::Ray,
    trace::{Walk, kernel::RayBuffer},
};

/// The side of a lens that rays come from. The numbers are part of the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_side {
    /// From behind the lens; rays travel toward +z.
    Film = 0,
    /// From in front of it; rays travel toward -z.
    Scene = 1,
}

/// Rays in lens space as structure of arrays, one number per ray in each: a point on it, mm, and its direction.
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
    /// What became of each ray; may be NULL.
    pub reason: *mut realistic_reason,
}

/// Rays traced side by side before the next are loaded.
const BLOCK: usize = 256;

/// Takes `n` rays through the lens from side `from` (`realistic_side`) and puts in their place the points where they leave
/// the last surface and their unit directions there. A blocked ray ends on the last surface that it met, with the direction
/// behind it, or, where it met none, stays as it was but for the length of its direction. A start may lie anywhere before the
/// lens. Numbers that are not finite, or a direction of length 0, count as `REALISTIC_REASON_MISSED`; such a ray stays.
///
/// `points` is NULL, or requests where the rays meet each surface. Rays then go one after another, which is slower; they agree
/// with those without points but for rounding, and where that decides at the very edge of an aperture.
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
        let places = unsafe { Places::of(points, n, opened.lens.surfaces.len())? };
        if n == 0 {
            return Ok(());
        }
        let arrays = arrays(&rays)?;
        // SAFETY: the caller's promise.
        unsafe {
            match places {
                None => in_blocks(way, n, arrays, rays.reason),
                Some(places) => places.walk(way, n, arrays, rays.reason),
            }
        }
        Ok(())
    })
}

/// The lens made ready for rays that come from side `from`.
fn way(opened: &OpenedLens, from: i32) -> Result<&Way, Failure> {
    let way = usize::try_from(from).ok().and_then(|side| opened.ways.get(side));
    way.ok_or_else(|| {
        Failure::invalid(format!("from is {from}; rays come from 0 (the film's side) or 1 (the scene's)"))
    })
}

/// A point on each ray and its direction, by coordinates, of which none is NULL.
fn arrays(rays: &realistic_lens_rays) -> Result<[*mut f64; 6], Failure> {
    let arrays = [rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz];
    required_arrays("rays", ["ox", "oy", "oz", "dx", "dy", "dz"], arrays.map(|array| array.cast_const()))?;
    Ok(arrays)
}

/// # Safety
/// The arrays have room for `n` elements; `reasons` is NULL or has.
unsafe fn in_blocks(way: &Way, n: usize, arrays: [*mut f64; 6], reasons: *mut realistic_reason) {
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

/// Where a ray that the kernel blocks ends, and why. Where the walk lets it through it is within rounding of an edge.
fn blocked(way: &Way, [x, y, z, dx, dy, dz]: [f64; 6]) -> (Option<Ray>, realistic_reason) {
    let Walk { ray, blocked, .. } = way.path.walk(Ray { origin: [x, y, z], direction: [dx, dy, dz] });
    let is_number = ray.origin.iter().chain(&ray.direction).all(|number| number.is_finite());
    (is_number.then_some(ray), blocked.map_or(realistic_reason::Clipped, realistic_reason::from))
}
