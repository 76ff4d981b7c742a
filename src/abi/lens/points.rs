//! Exact rays with the point where each meets each surface: what a drawing of a lens is made of.

use super::{
    super::{
        boundary::{self, Failure, fits_memory, realistic_status},
        exchange::{required_arrays, take},
        types::realistic_reason,
    },
    handle::{Way, opened, realistic_lens},
    trace::{arrays, realistic_lens_rays, way},
};
use crate::{lens::Ray, trace::Direction};

/// Where rays meet the surfaces of a lens, lens space, mm. The point of ray i on surface k, counted from 0 at the scene side
/// whichever way rays travel, is element i · `surfaces` + k of `x`, `y` and `z`, with `surfaces` of `realistic_lens_info`; NaN
/// where the ray does not get so far.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_lens_points {
    /// `sizeof(realistic_lens_points)` of the caller's header.
    pub struct_size: u32,
    /// x of the points.
    pub x: *mut f64,
    /// y.
    pub y: *mut f64,
    /// z.
    pub z: *mut f64,
    /// How many surfaces each ray meets, the one that stops it included; one element per ray, may be NULL.
    pub met: *mut u32,
}

/// As `realistic_lens_trace`, surface by surface and one ray after another, with the points on the way. It is the slower of
/// the two; their rays agree but for rounding, and where that decides at the very edge of an aperture.
///
/// # Safety
/// `lens` is NULL or a live lens; `rays` and `points` are NULL or valid; the arrays of `rays` are NULL or have room for `n`
/// elements, as `points.met`, and those of `points` for `n` times the lens's surfaces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_trace_points(
    lens: *const realistic_lens,
    from: i32,
    n: usize,
    rays: *const realistic_lens_rays,
    points: *const realistic_lens_points,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let (opened, rays, points) = unsafe {
            (
                opened(lens)?,
                take("realistic_lens_rays", "rays", rays)?,
                take("realistic_lens_points", "points", points)?,
            )
        };
        let way = way(opened, from)?;
        let surfaces = opened.lens.surfaces.len();
        fits_memory(n, surfaces * size_of::<f64>())?;
        if n == 0 {
            return Ok(());
        }
        let (arrays, room) = (arrays(&rays)?, point_arrays(&points)?);
        for i in 0..n {
            // SAFETY: the caller's promise.
            unsafe { one(way, arrays.map(|array| array.add(i)), rays.reason, points.met, i, room, surfaces) };
        }
        Ok(())
    })
}

/// Coordinates of the points, none of them NULL.
fn point_arrays(points: &realistic_lens_points) -> Result<[*mut f64; 3], Failure> {
    let arrays = [points.x, points.y, points.z];
    required_arrays("points", ["x", "y", "z"], arrays.map(|array| array.cast_const()))?;
    Ok(arrays)
}

/// Takes ray `i` through the lens.
///
/// # Safety
/// `numbers` are readable and writable; `reasons` and `met` are NULL or have more than `i` elements, and `room` more than
/// `i` times `surfaces`.
unsafe fn one(
    way: &Way,
    numbers: [*mut f64; 6],
    reasons: *mut realistic_reason,
    met: *mut u32,
    i: usize,
    room: [*mut f64; 3],
    surfaces: usize,
) {
    let place = |surface: usize| room.map(|array| array.wrapping_add(i * surfaces + surface));
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
