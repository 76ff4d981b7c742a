//! Light tracing: the importance of rays from the scene, and directions toward the lens, as structures of arrays.
//!
//! A renderer that traces paths from light sources connects them to the camera in one of two ways. It requests the
//! importance of a ray that reaches the lens ([`realistic_camera_importance`]), or it samples a direction from a scene
//! point toward the lens, with importance and density ([`realistic_camera_sample_importance`]). Both return importance
//! as [`realistic_importance`].

use super::{
    boundary::{self, Failure, realistic_status},
    exchange::{required_arrays, take},
    object::{self, Handle},
    types::realistic_camera,
};
use ::realistic_camera::{
    AdjointCamera, WorldRay,
    importance_block::{ArrivingRays, BLOCK, PointColumns},
};

/// Importance as structure of arrays, one number per ray in each; all 0 for a ray without importance. Each array but
/// `importance` may be NULL.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_importance {
    /// `sizeof(realistic_importance)`.
    pub struct_size: u32,
    /// Raster x, pixels, where the ray reaches the film.
    pub image_x: *mut f32,
    /// Raster y.
    pub image_y: *mut f32,
    /// Importance We (E. Veach 1997; PBRT's `We`): the factor of radiance times cosθ dA dω, where dA is area in square
    /// world units on the plane z = 0 of camera space and θ the angle to its normal. With `weighting` "radiometric" it
    /// is 1 over the film's area in square world units, times the shutter's transmission.
    pub importance: *mut f32,
    /// Density of the camera's own rays at this ray, per cosθ dA dω, for samples uniform over the picture, the lens and
    /// time: `importance` is this density times the weight of the same ray.
    pub density: *mut f32,
    /// Density per area on the plane z = 0: 1 over the area of the front clear aperture (of the lens of a stock
    /// camera).
    pub area_density: *mut f32,
    /// Density per solid angle that matches `area_density`: their product is `density` times cosθ.
    pub solid_angle_density: *mut f32,
}

impl realistic_importance {
    /// Refuses a structure without the required array `importance`.
    fn check(&self) -> Result<(), Failure> {
        required_arrays("importance", ["importance"], [self.importance.cast_const()])
    }

    /// Writes importance to the elements from `first` on.
    ///
    /// # Safety
    /// The arrays that are not NULL have room.
    unsafe fn give(&self, first: usize, found: &ArrivingRays) {
        let arrays = [
            self.image_x,
            self.image_y,
            self.importance,
            self.density,
            self.area_density,
            self.solid_angle_density,
        ];
        for (array, numbers) in arrays.into_iter().zip(found.counted()) {
            // SAFETY: the caller's promise.
            unsafe { put(array, first, numbers) };
        }
    }
}

/// Writes numbers to the elements from `first` on, unless the array is NULL.
///
/// # Safety
/// `array` is NULL or has room for them.
unsafe fn put(array: *mut f32, first: usize, numbers: &[f64]) {
    if array.is_null() {
        return;
    }
    for (i, number) in (first..).zip(numbers) {
        // SAFETY: the caller's promise.
        unsafe { array.add(i).write_unaligned(*number as f32) };
    }
}

/// Returns the adjoint camera; checks first for the memory to build it, if it is not built yet.
fn adjoint(handle: &Handle) -> Result<&AdjointCamera, Failure> {
    let camera = handle.camera();
    if !camera.has_adjoint() {
        boundary::memory_to_build()?;
    }
    camera.adjoint().map_err(|error| Failure::invalid(error.to_string()))
}

/// Returns element `i` of an array, or `other` if the array is NULL.
///
/// # Safety
/// `array` is NULL or has an element `i`.
unsafe fn get_or(array: *const f32, i: usize, other: f32) -> f32 {
    // SAFETY: the caller's promise.
    if array.is_null() { other } else { unsafe { array.add(i).read_unaligned() } }
}

/// Rays of world space that enter a camera, as structure of arrays, one number per ray in each.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_importance_rays {
    /// `sizeof(realistic_importance_rays)`.
    pub struct_size: u32,
    /// x of a point on each ray, in front of the lens or on its front surface; the origins of the camera's own rays are
    /// valid.
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
    /// Arrival time of each ray, in the unit of `shutter_open`; may be NULL for the middle of the shutter's interval.
    pub time: *const f32,
}

/// Computes the importance of `n` rays that enter the camera: 0 for a ray that does not reach the film, comes from
/// behind, arrives while the shutter is closed, or has numbers that are not finite. A ray within rounding of an
/// aperture's edge may have importance 0 although the camera's own ray passes. Returns
/// `REALISTIC_STATUS_INVALID_PARAMETER` for models whose rays have no area: "perspective" and "orthographic" without
/// `lens_radius`, and "environment".
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
        let adjoint = adjoint(handle)?;
        boundary::fits_memory(n, size_of::<f32>())?;
        if n == 0 {
            return Ok(());
        }
        let arrays = [rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz];
        required_arrays("rays", ["ox", "oy", "oz", "dx", "dy", "dz"], arrays)?;
        importance.check()?;
        let middle = adjoint.middle_time();
        let mut asked = Vec::with_capacity(n.min(BLOCK));
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
                importance.give(first, &adjoint.arrive_block(&asked));
            }
        }
        Ok(())
    })
}

/// Points of the scene from which directions toward the lens are sampled, as structure of arrays, one number per point
/// in each.
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
    /// u of the pupil sample (u, v), in [0, 1], in the pupil as seen from the point.
    pub u: *const f32,
    /// v of the pupil sample (u, v), in [0, 1].
    pub v: *const f32,
    /// Time of each point's direction, in the unit of `shutter_open`; may be NULL for the middle of the shutter's
    /// interval.
    pub time: *const f32,
}

/// Directions toward the lens, as structure of arrays, one number per point in each. `ox`, `oy` and `oz` may be NULL.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_aimed {
    /// `sizeof(realistic_aimed)`.
    pub struct_size: u32,
    /// x of the point where the ray meets the front of the lens; an object between the scene point and this point
    /// blocks the light.
    pub ox: *mut f32,
    /// y.
    pub oy: *mut f32,
    /// z.
    pub oz: *mut f32,
    /// x of the unit vector from the scene point toward that point.
    pub dx: *mut f32,
    /// y.
    pub dy: *mut f32,
    /// z.
    pub dz: *mut f32,
    /// Density of the direction per solid angle at the scene point. This and all other numbers are 0 if there is no
    /// direction along which light could reach the film.
    pub density: *mut f32,
}

/// Samples directions toward the lens from `n` points of the scene, in the pupil as seen from each point, and computes
/// the importance of a ray along each, as `realistic_camera_importance` does. A point that emits radiance L at an angle
/// of cosine c to its normal adds importance · L · c / (density · density of the point) at (image_x, image_y); a sample
/// of importance 0 counts in the mean. A point that is not in front of the lens between `hither` and `yon` has no
/// direction. A camera's first call builds the entrance-pupil table, in 20 to 100 ms on two cores.
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
        let adjoint = adjoint(handle)?;
        boundary::fits_memory(n, size_of::<f32>())?;
        if n == 0 {
            return Ok(());
        }
        let arrays = [points.x, points.y, points.z, points.u, points.v];
        required_arrays("points", ["x", "y", "z", "u", "v"], arrays)?;
        let room = [aimed.ox, aimed.oy, aimed.oz, aimed.dx, aimed.dy, aimed.dz, aimed.density];
        let [_, _, _, needed @ ..] = room.map(|array| array.cast_const());
        required_arrays("aimed", ["dx", "dy", "dz", "density"], needed)?;
        importance.check()?;
        let middle = adjoint.middle_time();
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            let mut asked = PointColumns::<5>::new(count);
            for (array, column) in arrays.into_iter().zip(asked.each_mut()) {
                for (i, number) in (first..).zip(column) {
                    // SAFETY: the caller's promise, and the arrays that must be there are.
                    *number = unsafe { array.add(i).read_unaligned() }.into();
                }
            }
            // SAFETY: as above.
            let times = (first..first + count).map(|i| unsafe { get_or(points.time, i, middle) });
            let found = adjoint.aim_block(&asked, times);
            for (array, numbers) in room.into_iter().zip(found.toward_lens.each()) {
                // SAFETY: as above.
                unsafe { put(array, first, numbers) };
            }
            // SAFETY: as above.
            unsafe { importance.give(first, &found) };
        }
        Ok(())
    })
}
