//! Exact rays with the point where each meets each surface: what a drawing of a lens is made of.

use super::{
    super::{
        boundary::{Failure, fits_memory},
        exchange::{required_arrays, take},
        types::realistic_reason,
    },
    handle::Way,
};
use crate::{lens::Ray, trace::Direction};

/// Where rays meet the surfaces of a lens, lens space, mm. The point of ray i on surface k, counted from 0 at the scene side
/// whichever way rays travel, is element i · `surfaces` + k of `x`, `y` and `z`, with `surfaces` of `realistic_lens_info`; NaN
/// where the ray does not get so far.
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
    /// How many surfaces each ray meets, the one that stops it included; one element per ray, may be NULL.
    pub met: *mut u32,
}

/// Room for the points of rays.
pub(super) struct Places {
    /// Coordinates of the points.
    room: [*mut f64; 3],
    met: *mut u32,
    surfaces: usize,
}

impl Places {
    /// That of a caller, if there is any.
    ///
    /// # Safety
    /// `points` is NULL or points to a structure of its `struct_size` bytes.
    pub(super) unsafe fn of(
        points: *const realistic_lens_points,
        n: usize,
        surfaces: usize,
    ) -> Result<Option<Self>, Failure> {
        if points.is_null() {
            return Ok(None);
        }
        // SAFETY: the caller's promise.
        let realistic_lens_points { x, y, z, met, .. } =
            unsafe { take("realistic_lens_points", "points", points)? };
        fits_memory(n, surfaces * size_of::<f64>())?;
        let room = [x, y, z];
        if n > 0 {
            required_arrays("points", ["x", "y", "z"], room.map(|array| array.cast_const()))?;
        }
        Ok(Some(Self { room, met, surfaces }))
    }

    /// Takes `n` rays through the lens, one after another.
    ///
    /// # Safety
    /// `arrays` have room for `n` elements; `reasons` and `met` are NULL or have, and `room` for `n` times `surfaces`.
    pub(super) unsafe fn walk(
        &self,
        way: &Way,
        n: usize,
        arrays: [*mut f64; 6],
        reasons: *mut realistic_reason,
    ) {
        let Self { room, met, surfaces } = *self;
        for i in 0..n {
            // SAFETY: the caller's promise.
            unsafe { one(way, arrays.map(|array| array.add(i)), reasons, met, i, room, surfaces) };
        }
    }
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
