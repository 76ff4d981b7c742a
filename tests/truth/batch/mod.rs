//! Requests for many samples: each sample has the bits of a single call, whatever the request and the layout of
//! its arrays.

mod memory;
mod subjects;

use std::ffi::CStr;
use std::ptr::{null, null_mut};

use realistic::ffi::*;

use super::support::{
    Random,
    abi_camera::{Camera, camera},
    abi_rays::{UNTOUCHED, bits},
    inline::*,
};
use memory::{Memory, UNWRITTEN};
use subjects::{Subject, subjects};

/// Requests made of each camera.
const ROUNDS: u64 = 60;

/// Components of the fields of samples: image, lens, time.
const SAMPLE: [usize; 3] = [2, 2, 1];
/// Components of the fields of rays: origin, direction, mint, maxt, time, weight, reason.
const RAY: [usize; 7] = [3, 3, 1, 1, 1, 1, 1];
/// Components of the fields of both neighbours: origin, direction, weight.
const NEIGHBOURS: [usize; 6] = [3, 3, 1, 3, 3, 1];

/// Returns the ray of a single call, at a wavelength if one is given.
fn single(camera: &Camera, sample: &realistic_sample, wavelength: Option<f32>) -> (realistic_ray, f32) {
    let mut ray = UNTOUCHED;
    // SAFETY: the camera is live.
    let weight = unsafe {
        match wavelength {
            Some(wavelength) => ray_at(camera.0, sample, wavelength, &mut ray),
            None => realistic_generate_ray(camera.0, sample, null(), &mut ray),
        }
    };
    (ray, weight)
}

/// A ray and its neighbours, whose numbers are stored as bits.
#[derive(PartialEq, Debug)]
struct Differential {
    ray: [u32; 10],
    has: u32,
    neighbours: [u32; 12],
}

impl Differential {
    const UNTOUCHED: realistic_ray_differential = realistic_ray_differential {
        struct_size: size_of::<realistic_ray_differential>() as u32,
        has: 77,
        ray: UNTOUCHED,
        rx_o: [-82.0; 3],
        rx_d: [-83.0; 3],
        ry_o: [-84.0; 3],
        ry_d: [-85.0; 3],
    };

    fn of(ray: &realistic_ray_differential, weight: f32) -> Self {
        let numbers = [ray.rx_o, ray.rx_d, ray.ry_o, ray.ry_d];
        let neighbours = std::array::from_fn(|i| numbers[i / 3][i % 3].to_bits());
        Self { ray: bits(&ray.ray, weight), has: ray.has, neighbours }
    }

    /// Builds the result from three calls without differentials. A blocked neighbour repeats the ray itself.
    fn by_three_calls(subject: &Subject, sample: &realistic_sample, wavelength: Option<f32>) -> Self {
        let mut found = Self::UNTOUCHED;
        let (ray, weight) = single(&subject.camera, sample, wavelength);
        found.ray = ray;
        if weight > 0.0 {
            let mut has = 0;
            let mut neighbour = |sample: realistic_sample, bit| {
                let (beside, weight) = single(subject.open(), &sample, wavelength);
                has |= u32::from(weight > 0.0) * bit;
                if weight > 0.0 { (beside.o, beside.d) } else { (ray.o, ray.d) }
            };
            let (image_x, image_y) = (sample.image_x + 1.0, sample.image_y + 1.0);
            let rx = neighbour(realistic_sample { image_x, ..*sample }, REALISTIC_HAS_RX);
            let ry = neighbour(realistic_sample { image_y, ..*sample }, REALISTIC_HAS_RY);
            ((found.rx_o, found.rx_d), (found.ry_o, found.ry_d)) = (rx, ry);
            found.has = has;
        }
        Self::of(&found, weight)
    }

    /// Builds the result from one call.
    fn by_one_call(camera: &Camera, sample: &realistic_sample, wavelength: Option<f32>) -> Self {
        let mut ray = Self::UNTOUCHED;
        // SAFETY: the camera is live.
        let weight = unsafe {
            match wavelength {
                Some(wavelength) => differential_at(camera.0, sample, wavelength, &mut ray),
                None => realistic_generate_ray_differential(camera.0, sample, null(), &mut ray),
            }
        };
        Self::of(&ray, weight)
    }
}

/// Counts of each reason and each set of neighbours.
#[derive(Default, Debug)]
struct Seen {
    reasons: [u32; 8],
    neighbours: [u32; 4],
}

/// Returns a number of samples: most often fewer than two groups of the widest vectors, otherwise about a block, or
/// more.
fn number_of_samples(random: &mut Random) -> usize {
    match (4.0 * random.next()) as usize {
        0 => [127, 128, 129, 0][(4.0 * random.next()) as usize],
        1 => (500.0 * random.next()) as usize,
        _ => 1 + (70.0 * random.next()) as usize,
    }
}

/// Returns a wavelength, nm; one in ten gives no ray.
fn wavelength(random: &mut Random) -> f32 {
    match (40.0 * random.next()) as usize {
        0 => f32::NAN,
        1 => 379.9,
        2 => f32::INFINITY,
        3 => -550.0,
        _ => (380.0 + 400.0 * random.next()) as f32,
    }
}

fn generate(camera: &Camera, n: usize, request: &realistic_request) -> realistic_status {
    // SAFETY: the camera is live, and all arrays lie in their memory.
    unsafe { realistic_camera_generate_batch(camera.0, n, request) }
}

/// Makes one random request and compares the result with single calls.
fn check(subject: &Subject, round: u64, seen: &mut Seen) {
    let random = &mut Random::new(round);
    let n = number_of_samples(random);
    let mut one_in = |n: f64| n * random.next() < 1.0;
    let (has_wavelengths, has_neighbours, has_range, has_reasons) =
        (one_in(2.0), one_in(2.5), !one_in(4.0), !one_in(4.0));
    let (has_time, is_one_point) = (!one_in(6.0), one_in(8.0));
    let per_sample = if has_wavelengths && one_in(3.0) { 4 } else { 1 };
    let rays = n * per_sample;
    let mut samples = subject.samples(n, random);
    for i in 0..n {
        if is_one_point {
            (samples[i].image_x, samples[i].image_y) = (samples[0].image_x, samples[0].image_y);
        }
        if !has_time {
            samples[i].time = 0.0;
        }
    }
    let wavelengths: Vec<Option<f32>> =
        (0..rays).map(|_| has_wavelengths.then(|| wavelength(random))).collect();

    let mut from = Memory::new(n, &SAMPLE, random);
    for (i, sample) in samples.iter().enumerate() {
        from.set(0, i, [sample.image_x, sample.image_y]);
        from.set(1, i, [sample.lens_u, sample.lens_v]);
        from.set(2, i, [sample.time]);
    }
    let mut at = Memory::new(rays, &[1], random);
    (0..rays).for_each(|i| at.set(0, i, [wavelengths[i].unwrap_or(0.0)]));
    let (mut to, mut beside) = (Memory::new(rays, &RAY, random), Memory::new(rays, &NEIGHBOURS, random));
    let mut request = realistic_request {
        image: from.input(0),
        lens: from.input(1),
        origin: to.output(0),
        direction: to.output(1),
        weight: to.output(5),
        ..Default::default()
    };
    if is_one_point {
        request.image.stride = 0;
    }
    if has_time {
        request.time = from.input(2);
    }
    if has_range {
        [request.mint, request.maxt, request.ray_time] = [2, 3, 4].map(|field| to.output(field));
    }
    if has_reasons {
        let reason = to.output(6);
        (request.reason, request.reason_stride) = (reason.x.cast(), reason.stride);
    }
    if has_wavelengths {
        (request.wavelength, request.wavelengths_per_sample) = (at.input(0), per_sample as u32);
    }
    if has_neighbours {
        [request.rx_origin, request.rx_direction, request.rx_weight] =
            [0, 1, 2].map(|field| beside.output(field));
        [request.ry_origin, request.ry_direction, request.ry_weight] =
            [3, 4, 5].map(|field| beside.output(field));
    }
    assert_eq!(generate(&subject.camera, n, &request), realistic_status::Ok);

    for i in 0..rays {
        let context =
            || format!("{}, round {round}, ray {i} of {rays}: {:?}", subject.name, samples[i / per_sample]);
        let sample = &samples[i / per_sample];
        let expected = Differential::by_three_calls(subject, sample, wavelengths[i]);
        let passes = f32::from_bits(expected.ray[9]) > 0.0;
        let written = |bits: &[u32], is_requested: bool| -> Vec<u32> {
            bits.iter().map(|bits| if passes && is_requested { *bits } else { UNWRITTEN }).collect()
        };
        assert_eq!(to.bits::<1>(5, i)[0], if passes { expected.ray[9] } else { 0 }, "{}", context());
        assert_eq!(to.bits::<3>(0, i)[..], written(&expected.ray[..3], true), "{}", context());
        assert_eq!(to.bits::<3>(1, i)[..], written(&expected.ray[3..6], true), "{}", context());
        for field in 2..5 {
            assert_eq!(
                to.bits::<1>(field, i)[..],
                written(&expected.ray[field + 4..field + 5], has_range),
                "{}",
                context()
            );
        }
        if has_reasons {
            let [reason] = to.bits::<1>(6, i);
            assert_eq!(passes, reason == realistic_reason::Ok as u32, "{}", context());
            let is_none = wavelengths[i].is_some_and(|nm| !(380.0..=780.0).contains(&nm));
            let is_shut = reason == realistic_reason::Shut as u32;
            assert_eq!(reason == realistic_reason::Wavelength as u32, is_none && !is_shut, "{}", context());
            seen.reasons[reason as usize] += 1;
        }
        if has_neighbours {
            for (side, bit) in [REALISTIC_HAS_RX, REALISTIC_HAS_RY].into_iter().enumerate() {
                let [origin, direction] = [0, 1].map(|field| beside.bits::<3>(3 * side + field, i));
                let numbers = written(&expected.neighbours[6 * side..6 * side + 6], true);
                assert_eq!([origin, direction].concat(), numbers, "{}, side {side}", context());
                let [weight] = beside.bits::<1>(3 * side + 2, i);
                assert_eq!(
                    f32::from_bits(weight) > 0.0,
                    passes && expected.has & bit != 0,
                    "{}, side {side}",
                    context()
                );
            }
            assert_eq!(
                Differential::by_one_call(&subject.camera, sample, wavelengths[i]),
                expected,
                "{}",
                context()
            );
            seen.neighbours[if passes { expected.has as usize } else { 0 }] += 1;
        }
    }
    if per_sample == 4 {
        for (sample, four) in samples.iter().zip(wavelengths.chunks(4)) {
            let four: Vec<f32> = four.iter().flatten().copied().collect();
            let (mut rays, mut weights) = ([UNTOUCHED; 4], [-1.0; 4]);
            // SAFETY: every array has four elements.
            let first = unsafe {
                hero_rays(subject.camera.0, sample, four.as_ptr(), rays.as_mut_ptr(), weights.as_mut_ptr())
            };
            assert_eq!(first.to_bits(), weights[0].to_bits(), "the weight that is returned");
            for k in 0..4 {
                let (ray, weight) = single(&subject.camera, sample, Some(four[k]));
                assert_eq!(
                    bits(&rays[k], weights[k]),
                    bits(&ray, weight),
                    "{}, round {round}, {k}",
                    subject.name
                );
            }
        }
    }
    assert!(to.is_whole() && beside.is_whole(), "{}, round {round}: gaps are written", subject.name);
    assert!(has_neighbours || beside.is_untouched());
}

#[test]
fn a_request_has_the_bits_of_single_calls() {
    let mut seen = Seen::default();
    for subject in subjects() {
        for round in 0..ROUNDS {
            check(&subject, round, &mut seen);
        }
    }
    use realistic_reason::{Clipped, Ok, Redraw, Shut, Wavelength};
    assert!(
        [Ok, Clipped, Redraw, Shut, Wavelength].iter().all(|reason| seen.reasons[*reason as usize] > 20),
        "{seen:?}"
    );
    assert!(seen.neighbours.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn a_batch_that_cannot_be_is_refused_by_the_name_of_its_part() {
    let camera = camera(|_| ());
    let random = &mut Random::new(14);
    let mut from = Memory::new(4, &SAMPLE, random);
    let mut to = Memory::new(4, &RAY, random);
    (0..4).for_each(|i| from.set(0, i, [20.0, 15.0]));
    let reason = to.output(6);
    let good = realistic_request {
        image: from.input(0),
        lens: from.input(1),
        time: from.input(2),
        origin: to.output(0),
        direction: to.output(1),
        weight: to.output(5),
        reason: reason.x.cast(),
        reason_stride: reason.stride,
        ..Default::default()
    };
    let refused = |set: &dyn Fn(&mut realistic_request), status: realistic_status, words: &str| {
        let mut request = good;
        set(&mut request);
        assert_eq!(generate(&camera, 4, &request), status, "{words}");
        // SAFETY: the message lives until the next call.
        let message = unsafe { CStr::from_ptr(realistic_last_error()) }.to_str().unwrap().to_owned();
        assert!(message.contains(words), "{message}");
    };
    use realistic_status::{InvalidParameter, NotACamera, NullPointer, StructSize};
    refused(&|request| request.image = realistic_input::NONE, NullPointer, "request.image.x");
    refused(&|request| request.lens.y = null(), NullPointer, "request.lens.y");
    refused(&|request| request.weight = realistic_output::NONE, NullPointer, "request.weight.x");
    refused(&|request| request.origin.z = null_mut(), NullPointer, "request.origin.z");
    refused(&|request| request.rx_weight = request.weight, NullPointer, "request.rx_origin.x");
    refused(&|request| request.origin.stride = 0, InvalidParameter, "request.origin.stride is 0");
    refused(&|request| request.time.stride = -2, InvalidParameter, "request.time.stride is -2");
    refused(&|request| request.reason_stride = 1, InvalidParameter, "request.reason.stride is 1");
    for stride in [isize::MAX, isize::MIN, isize::MAX / 3 + 1, 1 << 46] {
        refused(&|request| request.lens.stride = stride, InvalidParameter, "n is 4");
    }
    refused(&|request| request.wavelengths_per_sample = 4, NullPointer, "request.wavelength.x");
    refused(&|request| request.struct_size = 8, StructSize, "realistic_request.struct_size");
    // The request is for more rays than there are addresses.
    let endless = realistic_request { wavelengths_per_sample: u32::MAX, wavelength: good.image, ..good };
    assert_eq!(generate(&camera, usize::MAX / 2, &endless), InvalidParameter);
    // SAFETY: NULL is not read.
    unsafe {
        assert_eq!(realistic_camera_generate_batch(camera.0, 4, null()), NullPointer);
        assert_eq!(realistic_camera_generate_batch(null(), 4, &good), NotACamera);
    }
    assert!(to.is_untouched(), "a refused batch writes nothing");
}

#[test]
fn a_single_call_without_a_part_has_no_ray_and_writes_nothing() {
    let camera = camera(|_| ());
    let sample = realistic_sample { image_x: 20.0, image_y: 15.0, lens_u: 0.5, lens_v: 0.5, time: 0.0 };
    let (mut rays, mut weights, wavelengths) = ([UNTOUCHED; 4], [-1.0; 4], [500.0_f32; 4]);
    let (to, weight) = (rays.as_mut_ptr(), weights.as_mut_ptr());
    // SAFETY: pointers other than NULL are valid.
    unsafe {
        assert_eq!(ray_at(null(), &sample, 500.0, to), 0.0);
        assert_eq!(ray_at(camera.0, null(), 500.0, to), 0.0);
        assert_eq!(ray_at(camera.0, &sample, 500.0, null_mut()), 0.0);
        assert_eq!(hero_rays(camera.0, &sample, null(), to, weight), 0.0);
        assert_eq!(hero_rays(camera.0, &sample, wavelengths.as_ptr(), to, null_mut()), 0.0);
    }
    assert_eq!((rays, weights), ([UNTOUCHED; 4], [-1.0; 4]));
}
