//! Directions toward the lens from points of the scene.

use super::{
    super::{
        boundary::{self, realistic_status},
        exchange::{required_arrays, take},
        object,
        types::realistic_camera,
    },
    arrays::{BLOCK, backward, get_or, put, realistic_importance},
};
use crate::camera::{Aimed, ScenePoint};

/// Points of the scene from which directions toward the lens are sampled, as structure of arrays, one number per point in
/// each.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_scene_points {
    /// `sizeof(realistic_scene_points)`.
    pub struct_size: u32,
    /// x of each point, world space.
    pub x: *const f32,
    /// y.
    pub y: *const f32,
    /// z.
    pub z: *const f32,
    /// Where in the pupil as the point sees it: u and v in [0, 1].
    pub u: *const f32,
    /// v.
    pub v: *const f32,
    /// When, in the unit of `shutteropen`; may be NULL for the middle of the shutter's interval.
    pub time: *const f32,
}

/// Directions toward the lens, as structure of arrays, one number per point in each. `ox`, `oy` and `oz` may be NULL.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_aimed {
    /// `sizeof(realistic_aimed)`.
    pub struct_size: u32,
    /// x of where the ray meets the front of the lens: what lies between the point and this hides the light.
    pub ox: *mut f32,
    /// y.
    pub oy: *mut f32,
    /// z.
    pub oz: *mut f32,
    /// x of the unit vector from the point toward there.
    pub dx: *mut f32,
    /// y.
    pub dy: *mut f32,
    /// z.
    pub dz: *mut f32,
    /// Density of the direction per solid angle at the point; 0, and all other numbers, too, where there is no direction
    /// from which light could reach the film.
    pub density: *mut f32,
}

/// Directions toward the lens from `n` points of the scene, sampled from the pupil as each point sees it, and the importance
/// of a ray along each, as by `realistic_camera_importance`. A point that shines with radiance L at an angle of cosine c to
/// its normal adds importance · L · c / (density · density of the point) at (image_x, image_y); importance 0 belongs to the
/// mean. Points that are not in front of the lens between `hither` and `yon` have no direction. A camera's first call builds
/// the entrance-pupil table, in 25 to 150 ms.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_sample_importance(
    camera: *const realistic_camera,
    n: usize,
    points: *const realistic_scene_points,
    aimed: *const realistic_aimed,
    importance: *const realistic_importance,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise for all four.
        let handle = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?;
        let points = unsafe { take("realistic_scene_points", "points", points)? };
        let aimed = unsafe { take("realistic_aimed", "aimed", aimed)? };
        let importance = unsafe { take("realistic_importance", "importance", importance)? };
        let backward = backward(handle)?;
        boundary::fits_memory(n, size_of::<f32>())?;
        if n == 0 {
            return Ok(());
        }
        let arrays = [points.x, points.y, points.z, points.u, points.v];
        required_arrays("points", ["x", "y", "z", "u", "v"], arrays)?;
        let room = [aimed.dx, aimed.dy, aimed.dz, aimed.density].map(|array| array.cast_const());
        required_arrays("aimed", ["dx", "dy", "dz", "density"], room)?;
        importance.check()?;
        let middle = backward.middle_time();
        let (mut asked, mut found) = (Vec::with_capacity(n.min(BLOCK)), vec![Aimed::default(); n.min(BLOCK)]);
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            asked.clear();
            // SAFETY: the caller's promise, and the arrays that must be there are.
            unsafe {
                asked.extend((first..first + count).map(|i| {
                    let [x, y, z, u, v] = arrays.map(|array| array.add(i).read_unaligned());
                    ScenePoint { point: [x, y, z], sample: [u, v], time: get_or(points.time, i, middle) }
                }));
                backward.aim(&asked, &mut found[..count]);
                give(&aimed, &importance, first, &found[..count]);
            }
        }
        Ok(())
    })
}

/// Hands out directions from element `first` on.
///
/// # Safety
/// The arrays that are not NULL have room.
unsafe fn give(aimed: &realistic_aimed, importance: &realistic_importance, first: usize, found: &[Aimed]) {
    let arrays = [aimed.ox, aimed.oy, aimed.oz, aimed.dx, aimed.dy, aimed.dz, aimed.density];
    for (i, aim) in (first..).zip(found) {
        let ([ox, oy, oz], [dx, dy, dz]) = (aim.origin, aim.direction);
        for (array, number) in arrays.into_iter().zip([ox, oy, oz, dx, dy, dz, aim.density]) {
            // SAFETY: the caller's promise.
            unsafe {
                put(array, i, number);
            }
        }
        // SAFETY: the caller's promise.
        unsafe { importance.give(i, std::slice::from_ref(&aim.importance)) };
    }
}
