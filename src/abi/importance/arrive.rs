//! The importance of rays from the scene.

use super::{
    super::{
        boundary::{self, realistic_status},
        exchange::{required_arrays, take},
        object,
        types::realistic_camera,
    },
    arrays::{BLOCK, backward, get_or, realistic_importance},
};
use crate::camera::{Importance, WorldRay};

/// Rays of world space that enter a camera, as structure of arrays, one number per ray in each.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_importance_rays {
    /// `sizeof(realistic_importance_rays)`.
    pub struct_size: u32,
    /// x of a point on each ray, before the lens or on its front: where the camera's own rays begin will do.
    pub ox: *const f32,
    /// y.
    pub oy: *const f32,
    /// z.
    pub oz: *const f32,
    /// x of each direction, of any length but 0, toward the camera.
    pub dx: *const f32,
    /// y.
    pub dy: *const f32,
    /// z.
    pub dz: *const f32,
    /// When each arrives, in the unit of `shutteropen`; may be NULL for the middle of the shutter's interval.
    pub time: *const f32,
}

/// The importance of `n` rays that enter the camera: 0 for one that does not reach the film, comes from behind, arrives while
/// the shutter is closed, or has numbers that are not finite. One within rounding of an aperture's edge may have
/// importance 0 where the camera's own ray passes. `REALISTIC_STATUS_INVALID_PARAMETER` for models whose rays have no
/// area: "perspective" and "orthographic" without `lensradius`, and "environment".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_importance(
    camera: *const realistic_camera,
    n: usize,
    rays: *const realistic_importance_rays,
    importance: *const realistic_importance,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise for all three.
        let handle = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?;
        let rays = unsafe { take("realistic_importance_rays", "rays", rays)? };
        let importance = unsafe { take("realistic_importance", "importance", importance)? };
        let backward = backward(handle)?;
        boundary::fits_memory(n, size_of::<f32>())?;
        if n == 0 {
            return Ok(());
        }
        let arrays = [rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz];
        required_arrays("rays", ["ox", "oy", "oz", "dx", "dy", "dz"], arrays)?;
        importance.check()?;
        let middle = backward.middle_time();
        let (mut asked, mut found) =
            (Vec::with_capacity(n.min(BLOCK)), vec![Importance::default(); n.min(BLOCK)]);
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            asked.clear();
            // SAFETY: the caller's promise, and the arrays that must be there are.
            unsafe {
                asked.extend((first..first + count).map(|i| {
                    let [ox, oy, oz, dx, dy, dz] = arrays.map(|array| array.add(i).read_unaligned());
                    let time = get_or(rays.time, i, middle);
                    WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint: 0.0, maxt: 0.0, time }
                }));
                backward.arrive(&asked, &mut found[..count]);
                importance.give(first, &found[..count]);
            }
        }
        Ok(())
    })
}
