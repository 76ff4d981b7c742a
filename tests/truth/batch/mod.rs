//! Batches have the bits of single calls, for any number of samples, strides and alignment.

mod strided;

use std::mem::size_of;
use std::ptr::{null, null_mut};

use realistic::unstable::abi::*;

use super::support::{
    Random,
    abi_camera::{Camera, camera},
    abi_rays::{Bits, UNTOUCHED, bits},
    inline::*,
};

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
        ("bare", camera(|options| options.transmission = c"bare".as_ptr())),
        (
            "ghosts",
            camera(|options| {
                options.transmission = c"quarter-wave".as_ptr();
                options.ghosts = 0.4;
            }),
        ),
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

fn singles(camera: &Camera, samples: &[realistic_sample]) -> Vec<Bits> {
    let one = |sample: &realistic_sample| {
        let mut ray = UNTOUCHED;
        // SAFETY: a live camera.
        let weight = unsafe { realistic_generate_ray(camera.0, sample, null(), &mut ray) };
        bits(&ray, weight)
    };
    samples.iter().map(one).collect()
}

/// Bytes from one sample and one ray to the next: packed, a pbrt-v1 host's, and with a rest. What begins at an odd byte is
/// aligned nowhere.
const STRIDES: [[usize; 2]; 3] = [[20, 36], [88, 36], [23, 41]];

/// Room for structures that begins `odd` bytes beyond where they would be aligned.
struct Structures {
    bytes: Vec<u8>,
    start: usize,
    stride: usize,
}

impl Structures {
    fn new<T: Copy>(n: usize, stride: usize, odd: usize, first: impl Fn(usize) -> T) -> Self {
        let bytes = vec![0_u8; 8 + n * stride];
        let start = bytes.as_ptr().align_offset(4) + odd;
        let mut made = Self { bytes, start, stride };
        for i in 0..n {
            // SAFETY: there is room, aligned or not.
            unsafe { made.at::<T>(i).write_unaligned(first(i)) };
        }
        made
    }

    fn at<T>(&mut self, i: usize) -> *mut T {
        self.bytes[self.start + i * self.stride..].as_mut_ptr().cast()
    }

    /// All of them.
    fn all<T: Copy>(&mut self, n: usize) -> Vec<T> {
        // SAFETY: as in `new`.
        (0..n).map(|i| unsafe { self.at::<T>(i).read_unaligned() }).collect()
    }
}

/// Through arrays of structures at strides, beginning `odd` bytes beyond where they would be aligned. Reasons are 0 where
/// none is asked for.
fn structures(
    camera: &Camera,
    samples: &[realistic_sample],
    [sample_stride, ray_stride]: [usize; 2],
    odd: usize,
    with_reasons: bool,
) -> (Vec<Bits>, Vec<i32>) {
    let n = samples.len();
    let mut from = Structures::new(n, sample_stride, odd, |i| samples[i]);
    let mut to = Structures::new(n, ray_stride, odd, |_| UNTOUCHED);
    let mut weights = Structures::new(n, 4, odd, |_| 0.0_f32);
    let mut reasons = Structures::new(n, 4, odd, |_| 0_i32);
    // SAFETY: all places lie inside, and are read and written unaligned.
    unsafe {
        let status = realistic_camera_generate_rays(
            camera.0,
            n,
            from.at(0),
            sample_stride,
            to.at(0),
            ray_stride,
            weights.at(0),
            if with_reasons { reasons.at(0) } else { null_mut() },
        );
        assert_eq!(status, realistic_status::Ok);
    }
    let weights = weights.all::<f32>(n);
    (to.all(n).iter().zip(weights).map(|(ray, weight)| bits(ray, weight)).collect(), reasons.all(n))
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
        for n in [0, 1, 2, 3, 4, 5, 13, 15, 16, 17, 127, 128, 129, 383, 384, 385, 1000] {
            let samples = samples(n);
            let expected = singles(&camera, &samples);
            for odd in [0, 1] {
                for strides in STRIDES {
                    let (rays, _) = structures(&camera, &samples, strides, odd, false);
                    assert!(rays == expected, "{name}: {n} structures at {strides:?} and {odd}");
                }
                let (rays, _) = arrays(&camera, &samples, odd);
                assert!(rays == expected, "{name}: arrays of {n} at {odd}");
            }
        }
    }
}

/// Ones of differentials that are compared: of a blocked ray only the weight, 0.
type DifferentialBits = (Bits, u32, [u32; 12]);

fn differential_bits(ray: &realistic_ray_differential, weight: f32) -> DifferentialBits {
    let numbers = [ray.rx_o, ray.rx_d, ray.ry_o, ray.ry_d];
    let flat = std::array::from_fn(|i| numbers[i / 3][i % 3].to_bits());
    (bits(&ray.ray, weight), ray.has, flat)
}

const UNTOUCHED_DIFFERENTIAL: realistic_ray_differential = realistic_ray_differential {
    struct_size: size_of::<realistic_ray_differential>() as u32,
    has: 77,
    ray: UNTOUCHED,
    rx_o: [-82.0; 3],
    rx_d: [-83.0; 3],
    ry_o: [-84.0; 3],
    ry_d: [-85.0; 3],
};

/// By three calls without differentials, the neighbours through `open`: the same camera with its shutter open.
fn by_three_calls(camera: &Camera, open: &Camera, sample: &realistic_sample) -> DifferentialBits {
    let call = |camera: &Camera, sample: &realistic_sample, ray: &mut realistic_ray| {
        // SAFETY: a live camera.
        unsafe { realistic_generate_ray(camera.0, sample, null(), ray) }
    };
    by_calls(camera, open, sample, call)
}

/// The same by any calls of one ray, which return its weight.
fn by_calls(
    camera: &Camera,
    open: &Camera,
    sample: &realistic_sample,
    call: impl Fn(&Camera, &realistic_sample, &mut realistic_ray) -> f32,
) -> DifferentialBits {
    let (mut found, mut has) = (UNTOUCHED_DIFFERENTIAL, 0);
    let weight = call(camera, sample, &mut found.ray);
    if weight > 0.0 {
        let mut neighbour = |sample: realistic_sample, bit| {
            let mut ray = found.ray;
            let passes = call(open, &sample, &mut ray) > 0.0;
            has |= u32::from(passes) * bit;
            (ray.o, ray.d)
        };
        let (image_x, image_y) = (sample.image_x + 1.0, sample.image_y + 1.0);
        let rx = neighbour(realistic_sample { image_x, ..*sample }, REALISTIC_HAS_RX);
        let ry = neighbour(realistic_sample { image_y, ..*sample }, REALISTIC_HAS_RY);
        ((found.rx_o, found.rx_d), (found.ry_o, found.ry_d)) = (rx, ry);
        found.has = has;
    }
    differential_bits(&found, weight)
}

/// On the axis, and at many radii beside: those at which pupils are tabulated are powers of 2 of the largest.
fn along_the_radius() -> Vec<realistic_sample> {
    let mut samples = samples(400);
    for (i, sample) in samples.iter_mut().enumerate() {
        sample.image_y = 15.0;
        sample.image_x = 20.0 + (i as f32 - 100.0) / 16.0;
    }
    samples[0].image_x = 20.0;
    samples
}

/// At the film radii that tables of pupils may have, 64ths of the farthest and their square roots, and one float to either
/// side; the same for the neighbour to the right.
fn at_tabulated_radii() -> Vec<realistic_sample> {
    // Of the 40 x 30 film, pixels: its corner, and three pixels each way for a host's filter.
    let farthest = 25.0 + 3.0 * std::f64::consts::SQRT_2;
    let parts = (0..=64).map(|k| f64::from(k) / 64.0);
    let radii = parts.flat_map(|part| [part, part.sqrt()]).map(|part| part * farthest);
    let at = radii.map(|radius| (20.0 + radius) as f32);
    let beside = at.flat_map(|x| [x.next_down(), x, x.next_up()]).flat_map(|x| [x, x - 1.0]);
    let lens = samples(97).into_iter().cycle();
    beside.zip(lens).map(|(image_x, sample)| realistic_sample { image_x, image_y: 15.0, ..sample }).collect()
}

/// The last float before the edge of an aperture and the first beyond, along rows of the film, and the same for the
/// neighbour to the right.
fn beside_edges(camera: &Camera) -> Vec<realistic_sample> {
    let mut found = Vec::new();
    for sample in samples(80).into_iter().filter(|sample| sample.image_x.is_finite()) {
        let at = |image_x| realistic_sample { image_x, ..sample };
        let passes = |x| f32::from_bits(singles(camera, &[at(x)])[0][9]) > 0.0;
        let (mut inside, mut outside) = (20.0, 20.0 + 4.0 * (sample.image_x - 20.0));
        if !passes(inside) || passes(outside) {
            continue;
        }
        loop {
            let middle = f32::midpoint(inside, outside);
            match middle == inside || middle == outside {
                true => break,
                false if passes(middle) => inside = middle,
                false => outside = middle,
            }
        }
        found.extend([inside, outside, inside - 1.0, outside - 1.0].map(at));
    }
    found
}

#[test]
fn differentials_have_the_bits_of_three_calls() {
    let (mut seen, mut edges) = ([0; 4], 0);
    for ((name, camera), (_, open)) in cameras().into_iter().zip(cameras()) {
        // Cameras with a shutter have the default's lens.
        let open = if ["slit", "leaf"].contains(&name) { self::camera(|_| ()) } else { open };
        let sets = [0, 1, 2, 3, 4, 5, 15, 16, 17, 63, 64, 65, 127, 128, 129, 385].map(samples);
        // Blocks in which every sample has its ray, and only neighbours are missing, go another way.
        let mut lit = samples(1000);
        lit.retain(|sample| f32::from_bits(by_three_calls(&camera, &open, sample).0[9]) > 0.0);
        let beside = beside_edges(&camera);
        edges += beside.len();
        for samples in sets.into_iter().chain([along_the_radius(), at_tabulated_radii(), beside, lit]) {
            let n = samples.len();
            let expected: Vec<_> =
                samples.iter().map(|sample| by_three_calls(&camera, &open, sample)).collect();
            for (sample, expected) in samples.iter().zip(&expected) {
                let mut ray = UNTOUCHED_DIFFERENTIAL;
                // SAFETY: a live camera.
                let weight =
                    unsafe { realistic_generate_ray_differential(camera.0, sample, null(), &mut ray) };
                assert_eq!(differential_bits(&ray, weight), *expected, "{name}: {sample:?}");
                if weight > 0.0 {
                    seen[ray.has as usize] += 1;
                }
            }
            for (sample_stride, ray_stride, odd) in [(0, 0, 0), (88, 112, 0), (23, 93, 1)] {
                let [from, to] = [sample_stride.max(20), ray_stride.max(92)];
                let mut from = Structures::new(n, from, odd, |i| samples[i]);
                let mut to = Structures::new(n, to, odd, |_| UNTOUCHED_DIFFERENTIAL);
                let mut weights = Structures::new(n, 4, odd, |_| 0.0_f32);
                // SAFETY: all places lie inside, and are read and written unaligned.
                let status = unsafe {
                    differentials(
                        camera.0,
                        n,
                        from.at(0),
                        sample_stride,
                        to.at(0),
                        ray_stride,
                        weights.at(0),
                        null_mut(),
                    )
                };
                assert_eq!(status, realistic_status::Ok);
                let rays = to.all::<realistic_ray_differential>(n).into_iter().zip(weights.all::<f32>(n));
                let rays: Vec<_> = rays.map(|(ray, weight)| differential_bits(&ray, weight)).collect();
                assert!(rays == expected, "{name}: {n} structures at {sample_stride}, {ray_stride}, {odd}");
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 20) && edges > 1000, "{seen:?} {edges}");
}

#[test]
fn a_reason_says_whether_there_is_a_ray() {
    let mut seen = [0; 7];
    for (name, camera) in cameras() {
        let samples = samples(600);
        let (rays, reasons) = structures(&camera, &samples, STRIDES[2], 1, true);
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
