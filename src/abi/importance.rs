//! Light tracing: the importance of rays from the scene, and directions toward the lens; the caller's arrays
//! are used in place.
//!
//! A renderer that traces paths from light sources connects them to the camera by one of two calls. It requests the
//! importance of a ray that reaches the lens ([`realistic_camera_importance`]), or it samples a direction from a scene
//! point toward the lens, with importance and density ([`realistic_camera_sample_importance`]). Both return importance
//! as [`realistic_importance`].

use super::{
    boundary::{self, Failure, realistic_status},
    exchange::take,
    object::{self, Handle},
    types::{realistic_camera, realistic_input, realistic_output},
    views::{input, optional_input, optional_output, output},
};
use ::realistic_camera::{
    AdjointCamera, WorldRay,
    columns::Strided,
    importance_block::{BLOCK, PointColumns},
};

/// Importance of rays; all numbers are 0 for a ray without importance. Each array except `importance` may be
/// omitted.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_importance {
    /// `sizeof(realistic_importance)`.
    pub struct_size: u32,
    /// Raster coordinates (x, y), pixels, of the points where the rays reach the film.
    pub image: realistic_output,
    /// Importance We (E. Veach 1997; PBRT's `We`), the factor that multiplies radiance times cosθ dA dω. dA
    /// is area in square world units on the plane z = 0 of camera space, and θ is the angle to the plane's
    /// normal. With `weighting` "radiometric", We is the reciprocal of the film's area in square world units,
    /// times the shutter's transmission.
    pub importance: realistic_output,
    /// Density of the camera's own rays at this ray, per cosθ dA dω, for samples uniform over the picture, the lens and
    /// time: `importance` is this density times the weight of the same ray.
    pub density: realistic_output,
    /// Density per area on the plane z = 0: the reciprocal of the area of the front clear aperture or, for a
    /// stock camera, of its lens.
    pub area_density: realistic_output,
    /// Density per solid angle that corresponds to `area_density`: the product of the two is `density` times
    /// cosθ.
    pub solid_angle_density: realistic_output,
}

impl realistic_importance {
    /// Returns the columns in the order of `ArrivingRays::importance_columns`.
    ///
    /// # Errors
    /// An array is invalid, or `importance` is missing.
    fn columns(&self, n: usize) -> Result<[Strided; 6], Failure> {
        let [x, y] = optional_output("importance.image", n, &self.image)?;
        let [importance] = output("importance.importance", n, &self.importance)?;
        let [density] = optional_output("importance.density", n, &self.density)?;
        let [area] = optional_output("importance.area_density", n, &self.area_density)?;
        let [solid_angle] = optional_output("importance.solid_angle_density", n, &self.solid_angle_density)?;
        Ok([x, y, importance, density, area, solid_angle])
    }
}

/// Writes numbers to the elements of a column from `first` on, unless the column is omitted.
///
/// # Safety
/// The column has room for the numbers.
unsafe fn put(column: Strided, first: usize, numbers: &[f64]) {
    if column.is_there() {
        // SAFETY: the caller's promise.
        (first..).zip(numbers).for_each(|(i, number)| unsafe { column.put(i, *number as f32) });
    }
}

/// Returns the adjoint camera. If it is not built yet, first checks that there is enough memory to build it.
///
/// # Errors
/// There is not enough memory, or the camera has no importance.
fn adjoint(handle: &Handle) -> Result<&AdjointCamera, Failure> {
    let camera = handle.camera();
    if !camera.has_adjoint() {
        boundary::memory_to_build()?;
    }
    camera.adjoint().map_err(|error| Failure::invalid(error.to_string()))
}

/// Rays in world space that enter a camera.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_importance_rays {
    /// `sizeof(realistic_importance_rays)`.
    pub struct_size: u32,
    /// A point (x, y, z) on each ray, in front of the lens or on its front surface; the origins of the camera's own rays
    /// are valid.
    pub origin: realistic_input,
    /// Directions (x, y, z) of any length but 0, toward the camera.
    pub direction: realistic_input,
    /// Arrival times, in the unit of `shutter_open`; the middle of the shutter's interval if omitted.
    pub time: realistic_input,
}

/// Computes the importance of `n` rays that enter the camera. It is 0 for a ray that does not reach the film,
/// comes from behind, arrives while the shutter is closed, or has numbers that are not finite. A ray within
/// rounding of an aperture's edge may have importance 0 although the camera's own ray passes. Returns
/// `REALISTIC_STATUS_INVALID_PARAMETER` for models whose rays all begin at one point or are parallel:
/// "perspective" and "orthographic" without `lens_radius`, and "environment".
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
        if n == 0 {
            return Ok(());
        }
        let origin = input::<3>("rays.origin", n, &rays.origin)?;
        let direction = input::<3>("rays.direction", n, &rays.direction)?;
        let middle = adjoint.middle_time();
        let times = optional_input("rays.time", n, &rays.time)?.or((&raw const middle).cast_mut());
        let columns = importance.columns(n)?;
        let mut requested = Vec::with_capacity(n.min(BLOCK));
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            requested.clear();
            // SAFETY: the caller's promise; the required arrays are present.
            unsafe {
                requested.extend((first..first + count).map(|i| WorldRay {
                    origin: origin.map(|column| column.get(i)),
                    direction: direction.map(|column| column.get(i)),
                    mint: 0.0,
                    maxt: 0.0,
                    time: times.get(i),
                }));
                let found = adjoint.arrive_block(&requested);
                columns
                    .into_iter()
                    .zip(found.importance_columns())
                    .for_each(|(column, numbers)| put(column, first, numbers));
            }
        }
        Ok(())
    })
}

/// Points of the scene from which directions toward the lens are sampled.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_scene_points {
    /// `sizeof(realistic_scene_points)`.
    pub struct_size: u32,
    /// Points (x, y, z), world space.
    pub point: realistic_input,
    /// Samples (u, v), in [0, 1], of the pupil as seen from each point.
    pub lens: realistic_input,
    /// Time of each point's direction, in the unit of `shutter_open`; the middle of the shutter's interval if omitted.
    pub time: realistic_input,
}

/// Directions toward the lens. `origin` may be omitted.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_aimed {
    /// `sizeof(realistic_aimed)`.
    pub struct_size: u32,
    /// Points (x, y, z) where the rays meet the front of the lens; an object between the scene point and such
    /// a point blocks the light.
    pub origin: realistic_output,
    /// Unit vectors (x, y, z) from the scene points toward the points in `origin`.
    pub direction: realistic_output,
    /// Density of each direction per solid angle at the scene point. This number and all others of the point
    /// are 0 if there is no direction along which light could reach the film.
    pub density: realistic_output,
}

/// Samples directions toward the lens from `n` points of the scene, in the pupil as seen from each point.
/// Also computes the importance of a ray along each direction, as `realistic_camera_importance` does. A point
/// that emits radiance L along a direction whose angle to the point's normal has the cosine c adds importance
/// · L · c / (density · density of the point) to the picture at `image`; a sample with importance 0 counts in
/// the mean. A point that is not in front of the lens between `hither` and `yon` has no direction. The first
/// call for a camera builds the entrance-pupil table, which takes 20 to 100 ms on two cores.
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
        if n == 0 {
            return Ok(());
        }
        let [x, y, z] = input("points.point", n, &points.point)?;
        let [u, v] = input("points.lens", n, &points.lens)?;
        let middle = adjoint.middle_time();
        let times = optional_input("points.time", n, &points.time)?.or((&raw const middle).cast_mut());
        let [ox, oy, oz] = optional_output("aimed.origin", n, &aimed.origin)?;
        let [dx, dy, dz] = output("aimed.direction", n, &aimed.direction)?;
        let [density] = output("aimed.density", n, &aimed.density)?;
        let columns = importance.columns(n)?;
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            let mut requested = PointColumns::<5>::new(count);
            for (column, numbers) in [x, y, z, u, v].into_iter().zip(requested.each_mut()) {
                for (i, number) in (first..).zip(numbers) {
                    // SAFETY: the caller's promise; the required arrays are present.
                    *number = unsafe { column.get(i) }.into();
                }
            }
            // SAFETY: as above.
            let times = (first..first + count).map(|i| unsafe { times.get(i) });
            let found = adjoint.aim_block(&requested, times);
            let toward = [ox, oy, oz, dx, dy, dz, density].into_iter().zip(found.toward_lens.each());
            for (column, numbers) in toward.chain(columns.into_iter().zip(found.importance_columns())) {
                // SAFETY: as above.
                unsafe { put(column, first, numbers) };
            }
        }
        Ok(())
    })
}
