//! Batches have the bits of single calls, for any number of samples, strides and alignment.

use std::ffi::CStr;
use std::mem::{MaybeUninit, size_of};
use std::ptr::null_mut;

use realistic::abi::*;

use super::support;

use support::Random;

struct Camera(*mut realistic_camera);

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: made by `camera`, freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

fn camera(set: impl FnOnce(&mut realistic_options)) -> Camera {
    let mut options = MaybeUninit::<realistic_options>::zeroed();
    let mut camera = null_mut();
    // SAFETY: room for the whole structure; the strings are constants.
    unsafe {
        let size = size_of::<realistic_options>() as u32;
        assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
        let mut options = options.assume_init();
        (options.xres, options.yres) = (40, 30);
        set(&mut options);
        let status = realistic_camera_new(&options, &mut camera);
        assert_eq!(status, realistic_status::Ok, "{:?}", CStr::from_ptr(realistic_last_error()));
    }
    Camera(camera)
}

/// Cameras of every way through the code.
fn cameras() -> Vec<(&'static str, Camera)> {
    let turned = [0.6, 0.0, 0.8, 3.0, 0.0, 2.0, 0.0, -1.0, -0.8, 0.0, 0.6, 5.0, 0.0, 0.0, 0.0, 1.0];
    vec![
        ("default", camera(|_| ())),
        ("rear", camera(|options| options.pupil = c"rear".as_ptr())),
        ("placed", camera(|options| options.camera_to_world = turned)),
        ("moving", camera(|options| options.camera_to_world_end = turned)),
        ("single", camera(|options| options.precision = c"f32".as_ptr())),
        ("walked", camera(|options| options.refraction = c"whitted".as_ptr())),
        ("fisheye", camera(|options| options.specfile = c"fisheye.10mm".as_ptr())),
        ("redrawn", camera(|options| options.disk = c"rejection".as_ptr())),
        ("polar", camera(|options| options.disk = c"polar".as_ptr())),
        ("slit", camera(|options| options.shutter = c"focal-plane".as_ptr())),
        ("leaf", camera(|options| options.shutter = c"leaf".as_ptr())),
        (
            "approximate",
            camera(|options| {
                // One model for single calls and batches.
                options.specfile = c"dgauss.100mm".as_ptr();
                (options.fnumber, options.tolerance) = (16.0, 1.0);
            }),
        ),
        ("thin", camera(|options| options.model = c"thin".as_ptr())),
        ("environment", camera(|options| options.model = c"environment".as_ptr())),
    ]
}

/// Samples all over the film and its margin and some far beyond, with numbers of 0, 1 and one that is none.
fn samples(n: usize) -> Vec<realistic_sample> {
    let mut random = Random::new(5);
    let mut number = || ((1.02 * random.next() - 0.01) as f32).clamp(0.0, 1.0);
    let mut samples: Vec<_> = (0..n)
        .map(|_| realistic_sample {
            image_x: 46.0 * number() - 3.0,
            image_y: 36.0 * number() - 3.0,
            lens_u: number(),
            lens_v: number(),
            time: number(),
        })
        .collect();
    samples.iter_mut().skip(5).step_by(9).for_each(|sample| sample.image_x *= 2.0);
    if let Some(sample) = samples.get_mut(7) {
        sample.lens_u = f32::NAN;
    }
    if let Some(sample) = samples.get_mut(11) {
        sample.image_x = f32::NAN;
    }
    samples
}

const UNTOUCHED: realistic_ray =
    realistic_ray { o: [-77.0; 3], d: [-78.0; 3], mint: -79.0, maxt: -80.0, time: -81.0 };

type Bits = [u32; 10];

fn bits(ray: &realistic_ray, weight: f32) -> Bits {
    let realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time } = *ray;
    [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight].map(f32::to_bits)
}

fn singles(camera: &Camera, samples: &[realistic_sample]) -> Vec<Bits> {
    let one = |sample: &realistic_sample| {
        let mut ray = UNTOUCHED;
        // SAFETY: a live camera.
        let weight = unsafe { realistic_generate_ray(camera.0, sample, &mut ray) };
        bits(&ray, weight)
    };
    samples.iter().map(one).collect()
}

/// Through arrays of structures at strides with a rest, beginning at an odd byte.
fn structures(camera: &Camera, samples: &[realistic_sample]) -> (Vec<Bits>, Vec<i32>) {
    const SAMPLE: usize = 23;
    const RAY: usize = 41;
    let n = samples.len();
    let mut from = vec![0_u8; 1 + n * SAMPLE];
    let mut to = vec![0_u8; 1 + n * RAY];
    let mut weights = vec![0_u8; 1 + 4 * n];
    let mut reasons = vec![0_u8; 1 + 4 * n];
    // SAFETY: all places lie inside, and are read and written unaligned.
    unsafe {
        for (i, sample) in samples.iter().enumerate() {
            from.as_mut_ptr().add(1 + i * SAMPLE).cast::<realistic_sample>().write_unaligned(*sample);
            to.as_mut_ptr().add(1 + i * RAY).cast::<realistic_ray>().write_unaligned(UNTOUCHED);
        }
        let weights_at = weights.as_mut_ptr().add(1).cast::<f32>();
        let reasons_at = reasons.as_mut_ptr().add(1).cast::<realistic_reason>();
        let status = realistic_camera_generate_rays(
            camera.0,
            n,
            from.as_ptr().add(1).cast(),
            SAMPLE,
            to.as_mut_ptr().add(1).cast(),
            RAY,
            weights_at,
            reasons_at,
        );
        assert_eq!(status, realistic_status::Ok);
        let ray = |i| to.as_ptr().add(1 + i * RAY).cast::<realistic_ray>().read_unaligned();
        let rays = (0..n).map(|i| bits(&ray(i), weights_at.add(i).read_unaligned())).collect();
        (rays, (0..n).map(|i| reasons_at.cast::<i32>().add(i).read_unaligned()).collect())
    }
}

/// Room for numbers, of which the first lies `odd` bytes beyond a place where floats are aligned.
struct Column {
    bytes: Vec<u8>,
    at: usize,
}

impl Column {
    fn new(odd: usize, numbers: impl ExactSizeIterator<Item = [u8; 4]>) -> Self {
        let mut bytes = vec![0; 4 * numbers.len() + 8];
        let at = bytes.as_ptr().align_offset(4) + odd;
        bytes[at..].chunks_mut(4).zip(numbers).for_each(|(place, number)| place.copy_from_slice(&number));
        Self { bytes, at }
    }

    fn start<T>(&mut self) -> *mut T {
        self.bytes[self.at..].as_mut_ptr().cast()
    }

    fn word(&self, i: usize) -> u32 {
        let at = self.at + 4 * i;
        u32::from_ne_bytes(self.bytes[at..at + 4].try_into().expect("four bytes"))
    }
}

/// Through arrays of numbers that begin `odd` bytes beyond where they would be aligned.
fn arrays(camera: &Camera, samples: &[realistic_sample], odd: usize) -> (Vec<Bits>, Vec<i32>) {
    let n = samples.len();
    let column = |part: fn(&realistic_sample) -> f32| {
        Column::new(odd, samples.iter().map(|sample| part(sample).to_ne_bytes()))
    };
    let mut asked = [
        column(|sample| sample.image_x),
        column(|sample| sample.image_y),
        column(|sample| sample.lens_u),
        column(|sample| sample.lens_v),
        column(|sample| sample.time),
    ];
    let [ox, dx] = [UNTOUCHED.o[0], UNTOUCHED.d[0]];
    let fill = [ox, ox, ox, dx, dx, dx, UNTOUCHED.mint, UNTOUCHED.maxt, UNTOUCHED.time, 0.0];
    let mut found = fill.map(|number: f32| Column::new(odd, samples.iter().map(|_| number.to_ne_bytes())));
    let mut reasons = Column::new(odd, samples.iter().map(|_| [0; 4]));
    // SAFETY: each array has room for `n` numbers.
    unsafe {
        let [image_x, image_y, lens_u, lens_v, time] =
            asked.each_mut().map(|a| a.start::<f32>().cast_const());
        let asked = realistic_samples_soa { image_x, image_y, lens_u, lens_v, time };
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] = found.each_mut().map(Column::start);
        let reason = reasons.start();
        let rays = realistic_rays_soa { ox, oy, oz, dx, dy, dz, mint, maxt, time, weight, reason };
        let status = realistic_camera_generate_rays_soa(camera.0, n, &asked, &rays);
        assert_eq!(status, realistic_status::Ok);
    }
    let rays = (0..n).map(|i| found.each_ref().map(|array| array.word(i))).collect();
    (rays, (0..n).map(|i| reasons.word(i) as i32).collect())
}

#[test]
fn batches_have_the_bits_of_single_calls_for_any_number() {
    for (name, camera) in cameras() {
        for n in [0, 1, 2, 13, 255, 256, 257, 1000] {
            let samples = samples(n);
            let expected = singles(&camera, &samples);
            let (rays, _) = structures(&camera, &samples);
            let columns = [0, 1].map(|odd| arrays(&camera, &samples, odd).0);
            for i in 0..n {
                assert_eq!(rays[i], expected[i], "{name}: structure {i} of {n}, {:?}", samples[i]);
                for (odd, columns) in columns.iter().enumerate() {
                    assert_eq!(
                        columns[i], expected[i],
                        "{name}: arrays {i} of {n} at {odd}, {:?}",
                        samples[i]
                    );
                }
            }
        }
    }
}

#[test]
fn a_reason_says_whether_there_is_a_ray() {
    let mut seen = [0; 7];
    for (name, camera) in cameras() {
        let samples = samples(600);
        let (rays, reasons) = structures(&camera, &samples);
        for odd in [0, 1] {
            assert_eq!(arrays(&camera, &samples, odd).1, reasons, "{name}");
        }
        for (ray, reason) in rays.iter().zip(&reasons) {
            let weight = f32::from_bits(ray[9]);
            assert_eq!(weight > 0.0, *reason == realistic_reason::Ok as i32, "{name}");
            seen[*reason as usize] += 1;
        }
    }
    for reason in
        [realistic_reason::Ok, realistic_reason::Clipped, realistic_reason::Redraw, realistic_reason::Shut]
    {
        assert!(seen[reason as usize] > 0, "{reason:?} never came up: {seen:?}");
    }
}
