//! What both calls have in common: importance handed out as arrays, and single numbers of arrays that may be missing.

use super::super::{
    boundary::{Failure, memory},
    exchange::required_arrays,
    object::Handle,
};
use crate::camera::{Backward, Importance};

/// Rays or points that are taken at once.
pub(super) const BLOCK: usize = 256;

/// Importance as structure of arrays, one number per ray in each; all 0 where a ray has no importance. Each array but
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
    /// We (E. Veach 1997; PBRT's `We`): what radiance times cosθ dA dω is multiplied by, dA being area in square world units
    /// on the plane z = 0 of camera space and θ the angle to its normal. With `weighting` "radiometric" it is 1 over the
    /// film's area in square world units, times what the shutter lets through.
    pub importance: *mut f32,
    /// Density of the camera's own rays there, per cosθ dA dω, where samples are spread evenly over the picture, the lens and
    /// time: `importance` is this times the weight of the same ray.
    pub density: *mut f32,
    /// A density per area on that plane: 1 over the area of the front clear aperture (of the lens of a stock camera).
    pub area_density: *mut f32,
    /// The density per solid angle that goes with it: their product is `density` times cosθ.
    pub solid_angle_density: *mut f32,
}

impl realistic_importance {
    /// Refuses a structure without room for what must be taken.
    pub(super) fn check(&self) -> Result<(), Failure> {
        required_arrays("importance", ["importance"], [self.importance.cast_const()])
    }

    /// Hands out importance from element `first` on.
    ///
    /// # Safety
    /// The arrays that are not NULL have room.
    pub(super) unsafe fn give(&self, first: usize, found: &[Importance]) {
        let arrays = [
            self.image_x,
            self.image_y,
            self.importance,
            self.density,
            self.area_density,
            self.solid_angle_density,
        ];
        for (i, importance) in (first..).zip(found) {
            let Importance { raster: [x, y], importance, density, area_density, solid_angle_density } =
                *importance;
            let numbers = [x, y, importance, density, area_density, solid_angle_density];
            for (array, number) in arrays.into_iter().zip(numbers) {
                // SAFETY: the caller's promise.
                unsafe { put(array, i, number) };
            }
        }
    }
}

/// Writes a number where there is an array.
///
/// # Safety
/// `array` is NULL or has an element `i`.
pub(super) unsafe fn put(array: *mut f32, i: usize, number: f64) {
    if !array.is_null() {
        // SAFETY: the caller's promise.
        unsafe { array.add(i).write_unaligned(number as f32) };
    }
}

/// The adjoint camera, with the memory that it may still take.
pub(super) fn backward(handle: &Handle) -> Result<&Backward, Failure> {
    let camera = handle.camera();
    if !camera.has_backward() {
        memory::to_build()?;
    }
    camera.backward().map_err(|error| Failure::invalid(error.to_string()))
}

/// A number of an array, or another where there is none.
///
/// # Safety
/// `array` is NULL or has an element `i`.
pub(super) unsafe fn get_or(array: *const f32, i: usize, other: f32) -> f32 {
    // SAFETY: the caller's promise.
    if array.is_null() { other } else { unsafe { array.add(i).read_unaligned() } }
}
