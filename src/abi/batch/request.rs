//! A caller's request, checked before anything is read or written: each array becomes numbers at strides.

use std::mem::MaybeUninit;

use super::{
    super::{
        boundary::{self, Failure, realistic_status},
        exchange, object,
        types::{realistic_camera, realistic_output, realistic_request},
    },
    answer::{CheckedRequest, PerRay},
    strided::{Strided, numbers, pair, required_room, room, vectors},
};

/// Rays of `n` samples: what `realistic_generate_ray` and `realistic_generate_ray_differential` make of each, to the bit (with
/// a `tolerance`, within it). Where `n` is 0 all arrays may be NULL.
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
        let [x, y] = pair("image", n, &request.image)?;
        let [u, v] = pair("lens", n, &request.lens)?;
        let time = numbers("time", n, &request.time)?;
        let [ox, oy, oz] = vectors("origin", rays, &request.origin)?;
        let [dx, dy, dz] = vectors("direction", rays, &request.direction)?;
        if !per_ray.weights.is_there() {
            return Err(boundary::null("request.weight.x"));
        }
        let mint = room("mint", rays, &request.mint)?;
        let maxt = room("maxt", rays, &request.maxt)?;
        let ray_time = room("ray_time", rays, &request.ray_time)?;
        let checked = CheckedRequest {
            handle,
            samples: [x, y, u, v, time],
            numbers: [ox, oy, oz, dx, dy, dz, mint, maxt, ray_time],
            neighbours: neighbours(request, rays)?,
            per_ray,
        };
        // SAFETY: the caller's promise; what must be there is.
        unsafe { checked.answer() };
        Ok(())
    })
}

/// Room for the neighbours on both sides, if they are asked for: origin, direction and weight.
///
/// # Errors
/// A part of it is missing, or cannot be.
#[inline(always)]
fn neighbours(request: &realistic_request, rays: usize) -> Result<Option<[[Strided; 7]; 2]>, Failure> {
    let right = [&request.rx_origin, &request.rx_direction, &request.rx_weight];
    let below = [&request.ry_origin, &request.ry_direction, &request.ry_weight];
    let is_none = |given: &realistic_output| given.x.is_null();
    if right.into_iter().all(is_none) && below.into_iter().all(is_none) {
        return Ok(None);
    }
    Ok(Some([
        side(rays, ["rx_origin", "rx_direction", "rx_weight"], right)?,
        side(rays, ["ry_origin", "ry_direction", "ry_weight"], below)?,
    ]))
}

/// Room for the neighbours on one side.
#[inline(always)]
fn side(
    rays: usize,
    [of_origin, of_direction, of_weight]: [&str; 3],
    [origin, direction, weight]: [&realistic_output; 3],
) -> Result<[Strided; 7], Failure> {
    let [ox, oy, oz] = vectors(of_origin, rays, origin)?;
    let [dx, dy, dz] = vectors(of_direction, rays, direction)?;
    let weight = required_room(of_weight, rays, weight)?;
    Ok([ox, oy, oz, dx, dy, dz, weight])
}
