//! Serves the calls of a pbrt-v1 host, which calls three times per sample: at (x, y), at (x + 1, y) and at
//! (x, y + 1), with the same lens and time sample. The first call traces all three rays side by side; the
//! next two calls read their rays from here.
//!
//! The stored rays are identified by the thread, the camera (by its serial number) and the exact floats of
//! the host's expected calls. A camera never changes, so a stored ray equals the ray that a call would trace;
//! a wrong guess only costs the time of tracing two rays.
//!
//! **Store forwarding.** A processor forwards a number that was just stored immediately to a load of the same
//! width. A wider load has to wait until all stores that it covers, and with them all earlier stores, have
//! left the store buffer; the earlier stores are those of the previous call. The host has just written its
//! sample number by number, and an optimising compiler tends to read four numbers at once. This module avoids
//! the wait: it reads the sample number by number ([`read`]), compares stored keys in the same way
//! ([`alike`]), and stores as vectors the numbers that will be loaded as vectors ([`at_points`]). A C
//! caller's sample needs no such care, because the compiled tracer reads each of its numbers separately.

use std::cell::RefCell;

use super::handle::Handle;
use crate::abi::boundary::float_environment::for_triple;
use ::realistic_camera::{
    Rays, Sample, Samples, WorldRay,
    plan::Entry,
    rays::{FourRays, at_points},
};

/// The bits of x and y of an image point.
type RasterBits = [u32; 2];

/// The rays of the last sample traced, of which the host is expected to request the second and the third.
struct Expected {
    /// The camera's serial number; 0 for none.
    serial: u64,
    /// Lens and time samples, by their bits.
    lens_and_time: [u32; 3],
    /// Image points of the second and the third ray.
    images: [RasterBits; 2],
    /// Rays of the three calls; the fourth is not used.
    rays: FourRays,
}

thread_local! {
    static EXPECTED: RefCell<Expected> = const {
        RefCell::new(Expected { serial: 0, lens_and_time: [0; 3], images: [[0; 2]; 2], rays: FourRays::NONE })
    };
}

/// Writes the ray of [`Camera::ray`](::realistic_camera::Camera::ray) for a host's vtable call, and returns
/// the ray's weight. A blocked ray has the smallest normal number as its weight and is nevertheless complete,
/// because a pbrt-v1 host reads an uninitialised alpha if the weight is 0.
#[inline(always)]
pub fn generate(handle: &Handle, sample: &Sample, ray: &mut WorldRay) -> f32 {
    let served = EXPECTED
        .try_with(|expected| {
            let mut expected = expected.try_borrow_mut().ok()?;
            let sample = read(sample);
            let index = match expected.index_of(handle, &sample) {
                Some(index) => index,
                // The host's floating-point environment is read only here, because reading it takes as long
                // as finding a stored ray.
                None => for_triple(|| expected.trace(handle, &sample)).then_some(0)?,
            };
            Some(expected.rays.copy_to(index, ray))
        })
        .ok()
        .flatten();
    match served {
        Some(weight) if weight > 0.0 => weight,
        Some(_) => substitute(handle, sample, ray),
        None => alone(handle, sample, ray),
    }
}

/// Generates a ray like [`generate`], without stored rays.
#[inline(never)]
fn alone(handle: &Handle, sample: &Sample, ray: &mut WorldRay) -> f32 {
    let mut weight = 0.0;
    for_triple(|| {
        handle.camera().trace_as(Entry::One, &Samples::of(sample), &mut Rays::of(ray, &mut weight))
    });
    if weight > 0.0 { weight } else { substitute(handle, sample, ray) }
}

/// Writes the substitute for a blocked ray, and returns its weight.
#[inline(never)]
fn substitute(handle: &Handle, sample: &Sample, ray: &mut WorldRay) -> f32 {
    *ray = for_triple(|| handle.camera().substitute(sample));
    f32::MIN_POSITIVE
}

/// Reads a sample number by number, because its host has just written it that way. The loads are volatile;
/// otherwise the compiler would merge four of them into one.
#[inline(always)]
fn read(sample: &Sample) -> Sample {
    let Sample { image_x, image_y, lens_u, lens_v, time } = sample;
    // SAFETY: the references are valid.
    let [image_x, image_y, lens_u, lens_v, time] = [image_x, image_y, lens_u, lens_v, time]
        .map(|number| unsafe { (&raw const *number).read_volatile() });
    Sample { image_x, image_y, lens_u, lens_v, time }
}

impl Expected {
    /// Returns the index of the sample's ray, if it is stored.
    #[inline(always)]
    fn index_of(&self, handle: &Handle, sample: &Sample) -> Option<usize> {
        if self.serial != handle.serial() || !alike(self.lens_and_time, lens_and_time(sample)) {
            return None;
        }
        let image = [sample.image_x, sample.image_y].map(f32::to_bits);
        let [next, last] = self.images;
        if alike(next, image) {
            Some(1)
        } else if alike(last, image) {
            Some(2)
        } else {
            None
        }
    }

    /// Traces a sample and the two expected after it. Returns `false` if this is no faster for the camera.
    #[inline(always)]
    fn trace(&mut self, handle: &Handle, sample: &Sample) -> bool {
        // If tracing panics, the stored rays then belong to no camera.
        self.serial = 0;
        let points @ [[x, y], [right, _], [back, below]] = host_points(sample);
        let samples = at_points(sample, [x, right, back, back], [y, y, below, below]);
        let traced = handle.camera().trace_three(&samples, &mut self.rays);
        if traced {
            let [_, next, last] = points.map(|point| point.map(f32::to_bits));
            (self.serial, self.lens_and_time, self.images) =
                (handle.serial(), lens_and_time(sample), [next, last]);
        }
        traced
    }
}

/// Whether two keys are equal. They are compared number by number, because the compiler would turn `==` into
/// wider loads.
#[inline(always)]
fn alike<const N: usize>(a: [u32; N], b: [u32; N]) -> bool {
    let mut difference = 0;
    for i in 0..N {
        difference |= a[i] ^ b[i];
    }
    difference == 0
}

fn lens_and_time(sample: &Sample) -> [u32; 3] {
    [sample.lens_u, sample.lens_v, sample.time].map(f32::to_bits)
}

/// Returns the image points of the host's three calls for a sample, beginning with the sample's own. The host
/// adds 1 to x, subtracts it again, and adds 1 to y, in single precision, in which x + 1 - 1 may differ from
/// x.
fn host_points(sample: &Sample) -> [[f32; 2]; 3] {
    let Sample { image_x, image_y, .. } = *sample;
    let right = image_x + 1.0;
    [[image_x, image_y], [right, image_y], [right - 1.0, image_y + 1.0]]
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::{
        SplitMix64,
        rand_core::{Rng, SeedableRng},
    };

    use super::*;
    use ::realistic_camera::{Host, Parameters, Raster};

    fn handle(given: &[(&str, &str)]) -> Handle {
        let mut parameters = Parameters::default();
        for (name, text) in given {
            parameters.set_from_text(name, text).expect("a parameter");
        }
        let host = Host::new(Raster { xres: 40, yres: 30 }, None);
        Handle::build(None, &parameters, &host, &mut |_, _| ()).expect("a camera")
    }

    /// The bits that a host would receive without stored rays.
    fn plain(handle: &Handle, sample: &Sample) -> [u32; 10] {
        let found = handle.camera().ray(sample);
        let (ray, weight) = found.unwrap_or_else(|| (handle.camera().substitute(sample), f32::MIN_POSITIVE));
        bits(&ray, weight)
    }

    fn served(handle: &Handle, sample: &Sample) -> [u32; 10] {
        let mut ray = WorldRay::default();
        let weight = generate(handle, sample, &mut ray);
        bits(&ray, weight)
    }

    fn bits(ray: &WorldRay, weight: f32) -> [u32; 10] {
        let WorldRay { origin: [ox, oy, oz], direction: [dx, dy, dz], mint, maxt, time } = *ray;
        [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight].map(f32::to_bits)
    }

    struct Random(SplitMix64);

    impl Random {
        fn below(&mut self, end: usize) -> usize {
            (self.0.next_u64() % end as u64) as usize
        }

        /// Returns a number in [0, 1], both ends included.
        fn number(&mut self) -> f32 {
            self.below(1001) as f32 / 1000.0
        }

        /// Returns a sample on the film, in the filter's margin, far outside the film, or at an x that
        /// differs from x + 1 - 1.
        fn sample(&mut self) -> Sample {
            Sample {
                image_x: [
                    1e-9,
                    46.0 * self.number() - 3.0,
                    46.0 * self.number() - 3.0,
                    300.0 * self.number(),
                ][self.below(4)],
                image_y: 36.0 * self.number() - 3.0,
                lens_u: self.number(),
                lens_v: self.number(),
                time: self.number(),
            }
        }
    }

    /// Returns the calls of one sample, in the host's order or any other, with some left out or repeated.
    fn calls(random: &mut Random) -> Vec<Sample> {
        let first = random.sample();
        let points = host_points(&first);
        let all = points.map(|[image_x, image_y]| Sample { image_x, image_y, ..first });
        match random.below(3) {
            0 => all.to_vec(),
            1 => (0..5).map(|_| all[random.below(3)]).collect(),
            _ => all[..random.below(4)].to_vec(),
        }
    }

    /// Calls both cameras in random order, and returns the number of calls.
    fn play(cameras: [&Handle; 2], seed: u64) -> usize {
        let mut random = Random(SplitMix64::seed_from_u64(seed));
        let mut done = 0;
        for _ in 0..400 {
            let mut queues = [calls(&mut random), calls(&mut random)];
            while queues.iter().any(|queue| !queue.is_empty()) {
                let which = random.below(2);
                if let Some(sample) = (!queues[which].is_empty()).then(|| queues[which].remove(0)) {
                    assert_eq!(served(cameras[which], &sample), plain(cameras[which], &sample), "{sample:?}");
                    // Request the same sample from the other camera.
                    if random.below(4) == 0 {
                        let other = cameras[1 - which];
                        assert_eq!(served(other, &sample), plain(other, &sample), "{sample:?}");
                    }
                    done += 1;
                }
            }
        }
        done
    }

    #[test]
    fn every_order_of_calls_gets_the_bits_of_single_calls() {
        for given in [
            &[][..],
            &[("pupil", "rear")],
            &[("precision", "f32")],
            &[("refraction", "whitted")],
            &[("fnumber", "8"), ("tolerance", "0.003")],
            &[("fnumber", "8"), ("tolerance", "0.1")],
            &[("fnumber", "2.8"), ("tolerance", "0.01")],
            &[("fnumber", "22"), ("tolerance", "1")],
            &[("shutter", "focal-plane")],
            &[("disk", "rejection"), ("shutter", "leaf")],
            &[("model", "thin")],
            &[("model", "environment")],
        ] {
            let (one, two) = (handle(given), handle(&[("film_distance", "37")]));
            assert!(play([&one, &two], 7) > 1000);
        }
    }

    #[test]
    fn threads_do_not_disturb_each_other() {
        let (one, two) = (handle(&[]), handle(&[("pupil", "rear")]));
        std::thread::scope(|scope| {
            for seed in 0..4 {
                let (one, two) = (&one, &two);
                scope.spawn(move || play([one, two], seed));
            }
        });
    }

    #[test]
    fn a_new_camera_is_not_taken_for_one_that_was_freed() {
        let made = |i: usize| handle(&[("film_distance", &(36 + i % 3).to_string()), ("pupil", "rear")]);
        let first = Sample { image_x: 20.0, image_y: 15.0, lens_u: 0.4, lens_v: 0.6, time: 0.0 };
        let [_, [image_x, image_y], _] = host_points(&first);
        let next = Sample { image_x, image_y, ..first };
        // Each camera lies at the address of the previous one and is called immediately with the sample whose
        // ray is stored for the previous one.
        let mut camera = made(0);
        for i in 1..20 {
            for sample in [next, first] {
                assert_eq!(served(&camera, &sample), plain(&camera, &sample));
            }
            camera = made(i);
        }
    }

    #[test]
    fn the_hosts_second_and_third_call_find_their_rays() {
        let camera = handle(&[]);
        let sample = Sample { image_x: 1e-9, image_y: 4.5, lens_u: 0.3, lens_v: 0.8, time: 0.0 };
        let points = host_points(&sample);
        assert_ne!(points[2][0], points[0][0], "x + 1 - 1 is x here");
        served(&camera, &sample);
        for [image_x, image_y] in &points[1..] {
            let image = [image_x, image_y].map(|x| x.to_bits());
            assert!(EXPECTED.with_borrow(|expected| expected.images.contains(&image)));
        }
        EXPECTED.with_borrow_mut(|expected| expected.rays = FourRays::NONE);
        let [_, _, [image_x, image_y]] = points;
        let third = Sample { image_x, image_y, ..sample };
        let substitute = camera.camera().substitute(&third);
        assert_eq!(served(&camera, &third), bits(&substitute, f32::MIN_POSITIVE), "it was traced anew");
    }
}
