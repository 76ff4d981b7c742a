//! Generates many rays in one call; the arrays may have any strides.
//!
//! A caller's request is checked and converted to columns, from which the camera generates rays. The
//! documentation of `camera/pipeline` describes the further path of the rays.

use std::mem::MaybeUninit;

use super::{
    boundary::{self, Failure, realistic_status},
    exchange,
    object::{self, Handle},
    types::{realistic_camera, realistic_output, realistic_reason, realistic_request},
    views::{input, optional_column, optional_input, optional_output, output},
};
use ::realistic_camera::{Rays, Samples, columns::Strided};

/// The part of a request that every call may use, for one sample or for many.
#[derive(Clone, Copy)]
pub(super) struct PerRay {
    /// Total number of rays of all samples.
    pub rays: usize,
    pub per_sample: usize,
    pub wavelengths: Strided,
    pub weights: Strided,
    reasons: Strided<realistic_reason>,
}

impl PerRay {
    /// Reads a request for `n` samples.
    ///
    /// # Errors
    /// An array is invalid or missing, or there is not enough memory for the data that the first request for
    /// wavelengths builds.
    #[inline(always)]
    pub fn of(request: &realistic_request, handle: &Handle, n: usize) -> Result<Self, Failure> {
        let per_sample = request.wavelengths_per_sample.max(1) as usize;
        let rays = n
            .checked_mul(per_sample)
            .ok_or_else(|| boundary::too_many(n, size_of::<f32>().saturating_mul(per_sample)))?;
        let wavelengths = optional_input("request.wavelength", rays, &request.wavelength)?;
        if wavelengths.is_there() {
            if !handle.camera().is_ready_for_wavelengths() {
                boundary::memory_to_build()?;
            }
        } else if per_sample > 1 {
            return Err(boundary::null("request.wavelength.x"));
        }
        let reasons = optional_column("request.reason", rays, request.reason, request.reason_stride)?;
        let [weights] = optional_output("request.weight", rays, &request.weight)?;
        Ok(Self { rays, per_sample, wavelengths, weights, reasons })
    }

    /// Returns the column of weights; if none is requested, a column that consists of `own`, for a single
    /// ray.
    #[inline(always)]
    pub fn weights_or(&self, own: &mut f32) -> Strided {
        self.weights.or(own)
    }

    /// Writes the reason for each ray's weight, if reasons are requested. This is a separate step, because
    /// finding a reason takes longer than a ray.
    ///
    /// # Safety
    /// `samples` are the samples of the rays; their weights and reasons can be read and written.
    #[inline(always)]
    pub unsafe fn give_reasons(&self, handle: &Handle, samples: &Samples<'_>, weights: Strided) {
        if !self.reasons.is_there() {
            return;
        }
        for i in 0..self.rays {
            // SAFETY: the caller's promise.
            unsafe {
                let reason = if weights.get(i) > 0.0 {
                    realistic_reason::Ok
                } else {
                    handle.reason(&samples.get(i), samples.wavelength(i))
                };
                self.reasons.put(i, reason);
            }
        }
    }
}

/// Time of all samples if the times are omitted.
static NO_TIME: f32 = 0.0;

/// Generates the rays of `n` samples. They are bit-identical to those of `realistic_generate_ray` and
/// `realistic_generate_ray_differential`; with a `tolerance`, they agree within it. If `n` is 0, all arrays
/// may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_generate_batch(
    camera: *const realistic_camera,
    n: usize,
    request: *const realistic_request,
) -> realistic_status {
    boundary::status(|| {
        let mut copy = MaybeUninit::uninit();
        // SAFETY: the caller's promise.
        let (handle, request) = unsafe {
            let handle = object::handle_of(camera).ok_or_else(boundary::not_a_camera)?;
            (handle, exchange::borrow("realistic_request", "request", request, &mut copy)?)
        };
        if n == 0 {
            return Ok(());
        }
        let per_ray = PerRay::of(request, handle, n)?;
        let rays = per_ray.rays;
        let [x, y] = input("request.image", n, &request.image)?;
        let [u, v] = input("request.lens", n, &request.lens)?;
        let time = optional_input("request.time", n, &request.time)?.or((&raw const NO_TIME).cast_mut());
        let [ox, oy, oz] = output("request.origin", rays, &request.origin)?;
        let [dx, dy, dz] = output("request.direction", rays, &request.direction)?;
        if !per_ray.weights.is_there() {
            return Err(boundary::null("request.weight.x"));
        }
        let [mint] = optional_output("request.mint", rays, &request.mint)?;
        let [maxt] = optional_output("request.maxt", rays, &request.maxt)?;
        let [ray_time] = optional_output("request.ray_time", rays, &request.ray_time)?;
        let columns = [ox, oy, oz, dx, dy, dz, mint, maxt, ray_time, per_ray.weights];
        let neighbours = neighbours(request, rays)?;
        // SAFETY: the caller's promise; the required arrays are present.
        unsafe {
            let samples = Samples::raw([x, y, u, v, time, per_ray.wavelengths], per_ray.per_sample, rays);
            handle.camera().trace(&samples, &mut Rays::raw(columns, neighbours, rays));
            per_ray.give_reasons(handle, &samples, per_ray.weights);
        }
        Ok(())
    })
}

/// Returns the output columns of both neighbours, if they are requested: origin, direction and weight.
///
/// # Errors
/// An array is missing or invalid.
#[inline(always)]
fn neighbours(request: &realistic_request, rays: usize) -> Result<Option<[[Strided; 10]; 2]>, Failure> {
    let right = [&request.rx_origin, &request.rx_direction, &request.rx_weight];
    let below = [&request.ry_origin, &request.ry_direction, &request.ry_weight];
    let is_none = |given: &realistic_output| given.x.is_null();
    if right.into_iter().all(is_none) && below.into_iter().all(is_none) {
        return Ok(None);
    }
    Ok(Some([
        side(rays, ["request.rx_origin", "request.rx_direction", "request.rx_weight"], right)?,
        side(rays, ["request.ry_origin", "request.ry_direction", "request.ry_weight"], below)?,
    ]))
}

/// Returns the output columns of one neighbour.
#[inline(always)]
fn side(
    rays: usize,
    [of_origin, of_direction, of_weight]: [&str; 3],
    [origin, direction, weight]: [&realistic_output; 3],
) -> Result<[Strided; 10], Failure> {
    let [ox, oy, oz] = output(of_origin, rays, origin)?;
    let [dx, dy, dz] = output(of_direction, rays, direction)?;
    let [weight] = output(of_weight, rays, weight)?;
    let none = Strided::NONE;
    Ok([ox, oy, oz, dx, dy, dz, none, none, none, weight])
}
