//! One sample of a camera, however it was made: its ray, or the rays that a request asks for.

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
use crate::camera::{RayArrays, RayBlock, Sample, WorldRay};

/// One ray of a camera, made by `CreateCamera` or by `realistic_camera_new`. Returns its weight; 0, with `*ray` as it was,
/// where the lens blocks the ray, a pointer is NULL, or the camera is another library's.
///
/// `request` is NULL, or requests wavelengths or a reason; `ray` has room for `wavelengths_per_sample` rays. The weight of
/// the first is returned. 0 with a message, and nothing written, where the request is refused. A camera's first request
/// for a wavelength takes 2 to 35 ms, 50 for a phone lens, once for all threads.
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

/// [`realistic_generate_ray`] without a request, under the name and with the types that the assignment gives it: for
/// `const Camera *`, `const Sample *` and `Ray *` of a pbrt-v1 host.
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
/// As [`realistic_generate_ray`].
#[inline(always)]
unsafe fn plain(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    // Where the tracer writes it, to be read once.
    let mut weight = 0.0;
    let is_done = boundary::ray(false, || {
        // SAFETY: the caller's promise.
        let parts = unsafe {
            (object::handle_of(camera), sample.cast::<Sample>().as_ref(), ray.cast::<WorldRay>().as_mut())
        };
        if let (Some(handle), Some(sample), Some(ray)) = parts {
            float_environment::for_ray(|| handle.camera().trace_one(sample, ray, &mut weight));
        }
        true
    });
    if is_done { weight } else { 0.0 }
}

/// # Safety
/// As [`realistic_generate_ray`]; the request is not NULL.
#[inline(never)]
unsafe fn requested(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
    ray: *mut realistic_ray,
) -> f32 {
    boundary::value(0.0, || {
        // SAFETY: the caller's promise.
        let (one, ray) = unsafe { (OneSample::new(camera, sample, request)?, not_null("ray", ray)?) };
        let Some(count) = one.at_wavelengths() else {
            // SAFETY: the caller's promise.
            let (ray, mut weight) = (unsafe { &mut *ray.cast::<WorldRay>() }, 0.0);
            one.camera().trace_one(one.sample, ray, &mut weight);
            return Ok(one.told(0, weight));
        };
        if count == 1 {
            // SAFETY: the caller's promise, and a wavelength that there is.
            let (ray, mut weight) = (unsafe { &mut *ray.cast::<WorldRay>() }, 0.0);
            one.camera().trace_one_at(one.sample, one.wavelength(0), ray, &mut weight);
            return Ok(one.told(0, weight));
        }
        let mut first = 0.0;
        for begin in (0..count).step_by(FOUR) {
            let wavelengths = [0, 1, 2, 3].map(|k| one.wavelength((begin + k).min(count - 1)));
            let found = one.camera().hero_rays(one.sample, &wavelengths);
            for (k, found) in (begin..count).zip(found) {
                if let Some((found, _)) = found {
                    // SAFETY: the caller's promise.
                    unsafe { *ray.add(k) = found.into() };
                }
                let weight = one.told(k, found.map_or(0.0, |(_, weight)| weight));
                first = if k == 0 { weight } else { first };
            }
        }
        Ok(first)
    })
}

/// Wavelengths that are traced side by side.
const FOUR: usize = 4;

/// One ray with its differentials, in little more than the time of one: the ray of the sample, and those one pixel to the right
/// and one pixel down, the same to the bit as `realistic_generate_ray` gives at `image_x` + 1 and at `image_y` + 1. Returns the
/// weight as it does, for the same `request`; 0 with a message where `ray->struct_size` is not set.
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
/// As [`realistic_generate_ray_differential`].
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
        // SAFETY: not NULL; the first field is always there.
        let size = unsafe { (&raw const (*ray).struct_size).read() } as usize;
        if size != size_of::<realistic_ray_differential>() {
            return no_such_size(size as u32);
        }
        // SAFETY: the caller's promise, and the size is right.
        let parts = unsafe { (object::handle_of(camera), sample.cast::<Sample>().as_ref(), &mut *ray) };
        let (Some(handle), Some(sample), ray) = parts else { return 0.0 };
        let mut rays = RayBlock::new();
        float_environment::for_ray(|| handle.camera().trace_neighbours(sample, &mut rays));
        if rays.weight(0) > 0.0 {
            give(&mut rays, ray);
        }
        rays.weight(0)
    })
}

/// Leaves the message.
#[cold]
fn no_such_size(size: u32) -> f32 {
    boundary::value(0.0, || {
        check_size("realistic_ray_differential", size, size_of::<realistic_ray_differential>()).map(|()| 0.0)
    })
}

/// # Safety
/// As [`realistic_generate_ray_differential`]; the request is not NULL.
#[inline(never)]
unsafe fn requested_differential(
    camera: *const realistic_camera,
    sample: *const realistic_sample,
    request: *const realistic_request,
    ray: *mut realistic_ray_differential,
) -> f32 {
    boundary::value(0.0, || {
        // SAFETY: the caller's promise.
        let (one, ray) = unsafe { (OneSample::new(camera, sample, request)?, not_null("ray", ray)?) };
        // SAFETY: not NULL; the first field is always there.
        let size = unsafe { (&raw const (*ray).struct_size).read() };
        check_size("realistic_ray_differential", size, size_of::<realistic_ray_differential>())?;
        let mut rays = RayBlock::new();
        let mut first = 0.0;
        for k in 0..one.at_wavelengths().unwrap_or(1) {
            match one.at_wavelengths() {
                Some(_) => one.camera().trace_neighbours_at(one.sample, one.wavelength(k), &mut rays),
                None => one.camera().trace_neighbours(one.sample, &mut rays),
            }
            let weight = one.told(k, rays.weight(0));
            if weight > 0.0 {
                // SAFETY: the caller's promise, and the size is right.
                give(&mut rays, unsafe { &mut *ray.add(k) });
            }
            first = if k == 0 { weight } else { first };
        }
        Ok(first)
    })
}

/// A sample and what is requested of it.
struct OneSample<'a> {
    handle: &'a Handle,
    sample: &'a Sample,
    per_ray: PerRay,
}

impl<'a> OneSample<'a> {
    /// # Safety
    /// As [`realistic_generate_ray`].
    #[inline(always)]
    unsafe fn new(
        camera: *const realistic_camera,
        sample: *const realistic_sample,
        request: *const realistic_request,
    ) -> Result<Self, Failure> {
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
        Ok(Self { handle, sample, per_ray })
    }

    #[inline(always)]
    fn camera(&self) -> &'a crate::camera::Camera {
        self.handle.camera()
    }

    /// How many wavelengths are asked for, if any.
    #[inline(always)]
    fn at_wavelengths(&self) -> Option<usize> {
        self.per_ray.wavelengths.is_there().then_some(self.per_ray.rays)
    }

    #[inline(always)]
    fn wavelength(&self, k: usize) -> f32 {
        // SAFETY: the caller's promise in `new`; nobody asks for one beyond the last.
        unsafe { self.per_ray.wavelengths.get(k) }
    }

    /// Writes the weight of ray `k`, and its reason, where they are asked for; the weight.
    #[inline(always)]
    fn told(&self, k: usize, weight: f32) -> f32 {
        let PerRay { weights, reasons, .. } = self.per_ray;
        // SAFETY: the caller's promise in `new`.
        unsafe {
            if weights.is_there() {
                weights.put(k, weight);
            }
            reasons.give(k, &[weight], |_| match self.at_wavelengths() {
                Some(_) => self.handle.reason_at(self.sample, self.wavelength(k)),
                None => self.handle.reason(self.sample),
            });
        }
        weight
    }
}

/// A pointer that must not be NULL.
fn not_null<T>(name: &str, pointer: *mut T) -> Result<*mut T, Failure> {
    if pointer.is_null() { Err(boundary::null(name)) } else { Ok(pointer) }
}

/// Hands out a ray and its neighbours, number by number, as they were written in vectors.
#[inline(always)]
fn give(rays: &mut RayBlock<4>, to: &mut realistic_ray_differential) {
    let RayArrays { origin, direction, mint, maxt, time, weight } = rays.arrays(4);
    let first = |array: Option<&mut [f32]>| array.map_or(0.0, |array| array[0]);
    // Of a neighbour that is missing, the ray itself.
    let [rx, ry] = [1, 2].map(|place| if weight[place] > 0.0 { place } else { 0 });
    to.has = u32::from(rx != 0) * REALISTIC_HAS_RX + u32::from(ry != 0) * REALISTIC_HAS_RY;
    for axis in 0..3 {
        let (o, d) = (&*origin[axis], &*direction[axis]);
        (to.ray.o[axis], to.rx_o[axis], to.ry_o[axis]) = (o[0], o[rx], o[ry]);
        (to.ray.d[axis], to.rx_d[axis], to.ry_d[axis]) = (d[0], d[rx], d[ry]);
    }
    (to.ray.mint, to.ray.maxt, to.ray.time) = (first(mint), first(maxt), first(time));
}
