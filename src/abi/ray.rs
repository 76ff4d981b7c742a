//! Generates the rays of one sample, for a camera made from C or by pbrt: the sample's ray, or the rays of a
//! request.

use std::mem::{MaybeUninit, size_of};

use super::{
    batch::PerRay,
    boundary::{self, Failure, float_environment},
    exchange::{borrow, check_size},
    object::{self, Handle},
    types::{
        REALISTIC_HAS_RX, REALISTIC_HAS_RY, realistic_camera, realistic_ray, realistic_ray_differential,
        realistic_request, realistic_sample,
    },
};
use ::realistic_camera::{Rays, Sample, Samples, WorldRay, plan::Entry, rays::FourRays};

/// Generates one ray of a camera made by `CreateCamera` or `realistic_camera_new`, and returns the ray's
/// weight. The weight is 0, and `*ray` is not changed, if the lens blocks the ray, a pointer is NULL, or the
/// camera was not made by this library.
///
/// `request` is NULL, or requests wavelengths or a reason. With a request, `ray` has room for
/// `wavelengths_per_sample` rays, and the function returns the weight of the first ray. If the request is
/// refused, the function returns 0, stores a message and writes nothing. The first request for a wavelength
/// takes 2 to 35 ms (50 ms for a phone lens), once per camera for all threads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_ray(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
    ray: *mut realistic_ray,
) -> f32 {
    // SAFETY: the caller's promise.
    unsafe {
        if request.is_null() { plain(camera, sample, ray) } else { requested(camera, sample, request, ray) }
    }
}

/// Generates a ray like [`realistic_generate_ray`] without a request, under the name and with the types of
/// the course assignment: it takes `const Camera *`, `const Sample *` and `Ray *` of a pbrt-v1 host.
#[unsafe(no_mangle)]
#[allow(non_snake_case)]
pub unsafe extern "C" fn GenerateRay(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    // SAFETY: the caller's promise.
    unsafe { plain(camera, sample, ray) }
}

/// # Safety
/// The promises of [`realistic_generate_ray`].
#[inline(always)]
unsafe fn plain(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    // The tracer writes the weight to this variable, which is read once.
    let mut weight = 0.0;
    let is_done = boundary::ray(false, || {
        // SAFETY: the caller's promise.
        let parts = unsafe {
            (object::handle_of(camera), sample.cast::<Sample>().as_ref(), ray.cast::<WorldRay>().as_mut())
        };
        if let (Some(handle), Some(sample), Some(ray)) = parts {
            float_environment::for_ray(|| {
                handle.camera().trace_as(Entry::One, &Samples::of(sample), &mut Rays::of(ray, &mut weight))
            });
        }
        true
    });
    if is_done { weight } else { 0.0 }
}

/// # Safety
/// The promises of [`realistic_generate_ray`]; also, the request is not NULL.
#[inline(never)]
unsafe fn requested(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
    ray: *mut realistic_ray,
) -> f32 {
    boundary::value(0.0, || {
        // SAFETY: the caller's promise.
        unsafe {
            let (handle, sample, per_ray) = checked(camera, sample, request)?;
            let ray = not_null("ray", ray)?;
            let mut weight = 0.0;
            let weights = per_ray.weights_or(&mut weight);
            let samples = Samples::of(sample).raw_at(per_ray.wavelengths, per_ray.per_sample);
            if per_ray.rays == 1 {
                let mut own = 0.0;
                let ray = &mut *ray.cast::<WorldRay>();
                handle.camera().trace_as(Entry::One, &samples, &mut Rays::of(ray, &mut own));
                weights.put(0, own);
            } else {
                let mut rays = Rays::raw_structs(ray.cast(), weights, per_ray.rays);
                handle.camera().trace_as(Entry::One, &samples, &mut rays);
            }
            per_ray.give_reasons(handle, &samples, weights);
            Ok(weights.get(0))
        }
    })
}

/// Generates one ray with its differentials, in little more than the time of one ray: the ray of the sample,
/// and the rays one pixel to the right and one pixel down. The latter two are bit-identical to the rays of
/// `realistic_generate_ray` at `image_x` + 1 and at `image_y` + 1, except that they exist even if the shutter
/// is closed there. Returns the weight as `realistic_generate_ray` does, for the same `request`; returns 0
/// and stores a message if `ray->struct_size` is not set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_generate_ray_differential(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
    ray: *mut realistic_ray_differential,
) -> f32 {
    // SAFETY: the caller's promise.
    unsafe {
        if request.is_null() {
            plain_differential(camera, sample, ray)
        } else {
            requested_differential(camera, sample, request, ray)
        }
    }
}

/// # Safety
/// The promises of [`realistic_generate_ray_differential`].
#[inline(always)]
unsafe fn plain_differential(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray_differential,
) -> f32 {
    boundary::ray(0.0, || {
        if ray.is_null() {
            return 0.0;
        }
        // SAFETY: the pointer is not NULL, and the first field is always present.
        let size = unsafe { (&raw const (*ray).struct_size).read() } as usize;
        if size != size_of::<realistic_ray_differential>() {
            return no_such_size(size as u32);
        }
        // SAFETY: the caller's promise; the size is correct.
        let parts = unsafe { (object::handle_of(camera), sample.cast::<Sample>().as_ref(), &mut *ray) };
        let (Some(handle), Some(sample), ray) = parts else { return 0.0 };
        let mut rays = FourRays::NONE;
        float_environment::for_ray(|| handle.camera().trace_neighbours(sample, None, &mut rays));
        if rays.weight(0) > 0.0 {
            give(&rays, ray);
        }
        rays.weight(0)
    })
}

/// Stores the message about a wrong `struct_size`, and returns the weight 0.
#[cold]
fn no_such_size(size: u32) -> f32 {
    boundary::value(0.0, || {
        check_size("realistic_ray_differential", size, size_of::<realistic_ray_differential>()).map(|()| 0.0)
    })
}

/// # Safety
/// The promises of [`realistic_generate_ray_differential`]; also, the request is not NULL.
#[inline(never)]
unsafe fn requested_differential(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
    ray: *mut realistic_ray_differential,
) -> f32 {
    boundary::value(0.0, || {
        // SAFETY: the caller's promise.
        let (handle, sample, per_ray) = unsafe { checked(camera, sample, request)? };
        let ray = not_null("ray", ray)?;
        // SAFETY: the pointer is not NULL, and the first field is always present.
        let size = unsafe { (&raw const (*ray).struct_size).read() };
        check_size("realistic_ray_differential", size, size_of::<realistic_ray_differential>())?;
        let (mut rays, mut weight) = (FourRays::NONE, 0.0);
        let weights = per_ray.weights_or(&mut weight);
        // SAFETY: the caller's promise; the size is correct.
        unsafe {
            for k in 0..per_ray.rays {
                let wavelength = per_ray.wavelengths.is_there().then(|| per_ray.wavelengths.get(k));
                handle.camera().trace_neighbours(sample, wavelength, &mut rays);
                weights.put(k, rays.weight(0));
                if rays.weight(0) > 0.0 {
                    give(&rays, &mut *ray.add(k));
                }
            }
            let samples = Samples::of(sample).raw_at(per_ray.wavelengths, per_ray.per_sample);
            per_ray.give_reasons(handle, &samples, weights);
            Ok(weights.get(0))
        }
    })
}

/// Returns the camera, the sample, and the part of a request that concerns its rays.
///
/// # Safety
/// The promises of [`realistic_generate_ray`].
#[inline(always)]
unsafe fn checked<'a>(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
) -> Result<(&'a Handle, &'a Sample, PerRay), Failure> {
    let mut copy = MaybeUninit::uninit();
    // SAFETY: the caller's promise for all three.
    let (handle, sample, request) = unsafe {
        let handle = object::handle_of(camera).ok_or_else(boundary::not_a_camera)?;
        let sample = sample.cast::<Sample>().as_ref().ok_or_else(|| boundary::null("sample"))?;
        (handle, sample, borrow("realistic_request", "request", request, &mut copy)?)
    };
    let per_ray = PerRay::of(request, handle, 1)?;
    if per_ray.rays > 1 && !per_ray.weights.is_there() {
        return Err(boundary::null("request.weight.x"));
    }
    Ok((handle, sample, per_ray))
}

/// Checks that a pointer is not NULL.
fn not_null<T>(name: &str, pointer: *mut T) -> Result<*mut T, Failure> {
    if pointer.is_null() { Err(boundary::null(name)) } else { Ok(pointer) }
}

/// Copies a ray and its neighbours to the caller number by number, from columns that were written as vectors.
#[inline(always)]
fn give(rays: &FourRays, to: &mut realistic_ray_differential) {
    let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] = rays.columns();
    let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
    // The ray itself replaces a missing neighbour.
    let [rx, ry] = [1, 2].map(|index| if weight[index] > 0.0 { index } else { 0 });
    to.has = u32::from(rx != 0) * REALISTIC_HAS_RX + u32::from(ry != 0) * REALISTIC_HAS_RY;
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        (to.ray.o[axis], to.rx_o[axis], to.ry_o[axis]) = (o[0], o[rx], o[ry]);
        (to.ray.d[axis], to.rx_d[axis], to.ry_d[axis]) = (d[0], d[rx], d[ry]);
    }
    (to.ray.mint, to.ray.maxt, to.ray.time) = (mint[0], maxt[0], time[0]);
}
