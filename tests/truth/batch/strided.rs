//! The same between arrays of any strides, as NumPy's.

use std::ffi::CStr;

use super::*;

/// Elements of some components in memory of their own, with what lies between them.
struct Memory {
    bytes: Vec<u8>,
    start: usize,
    stride: isize,
    component_stride: isize,
}

const FILL: u8 = 0xA5;

impl Memory {
    /// One of the layouts that arrays have: element by element, component by component, with gaps, backward, aligned nowhere.
    fn new(n: usize, components: usize, random: &mut Random) -> Self {
        let mut among = |n: usize| (random.next() * n as f64) as usize;
        let (gap, odd) = ([0, 0, 4, 12, 3][among(5)], [0, 0, 1, 2][among(4)]);
        let (mut stride, mut component_stride) = match among(3) {
            0 => (4 * components + gap, 4),
            1 => (4 + gap, (4 + gap) * n.max(1)),
            _ => (4, 4 * n.max(1) + gap),
        };
        if components == 1 {
            (stride, component_stride) = (4 + gap, 0);
        }
        let size = 4 + stride * n + component_stride * components;
        let bytes = vec![FILL; size + 8];
        let start = bytes.as_ptr().align_offset(4) + odd;
        let mut made =
            Self { bytes, start, stride: stride as isize, component_stride: component_stride as isize };
        if among(3) == 0 {
            made.start += stride * n.saturating_sub(1);
            made.stride = -made.stride;
        }
        made
    }

    fn place(&self, i: usize, k: usize) -> usize {
        self.start.wrapping_add_signed(i as isize * self.stride + k as isize * self.component_stride)
    }

    fn set(&mut self, i: usize, k: usize, number: f32) {
        let place = self.place(i, k);
        self.bytes[place..place + 4].copy_from_slice(&number.to_ne_bytes());
    }

    fn bits(&self, i: usize, k: usize) -> u32 {
        let place = self.place(i, k);
        u32::from_ne_bytes(self.bytes[place..place + 4].try_into().unwrap())
    }

    fn input(&self) -> realistic_input {
        let first = self.bytes[self.start..].as_ptr();
        let y = first.wrapping_offset(self.component_stride).cast();
        realistic_input { x: first.cast(), y, stride: self.stride }
    }

    fn output(&mut self) -> realistic_output {
        let first = self.bytes[self.start..].as_mut_ptr();
        let [y, z] = [1, 2].map(|k| first.wrapping_offset(k * self.component_stride).cast());
        realistic_output { x: first.cast(), y, z, stride: self.stride }
    }

    /// Whether nothing lies between the elements that was not there before.
    fn is_whole(&self, n: usize, components: usize) -> bool {
        let mut bytes = self.bytes.clone();
        for (i, k) in (0..n).flat_map(|i| (0..components).map(move |k| (i, k))) {
            let place = self.place(i, k);
            bytes[place..place + 4].fill(FILL);
        }
        bytes.iter().all(|byte| *byte == FILL)
    }
}

const NO_INPUT: realistic_input = realistic_input::NONE;
const NO_OUTPUT: realistic_output = realistic_output::NONE;

/// A request that asks for nothing yet.
fn nothing() -> realistic_request {
    realistic_request::default()
}

/// Samples in memory of their own.
struct Asked {
    image: Memory,
    lens: Memory,
    time: Memory,
}

impl Asked {
    fn new(samples: &[realistic_sample], random: &mut Random) -> Self {
        let n = samples.len();
        let mut made = Self {
            image: Memory::new(n, 2, random),
            lens: Memory::new(n, 2, random),
            time: Memory::new(n, 1, random),
        };
        for (i, sample) in samples.iter().enumerate() {
            for (k, number) in [sample.image_x, sample.image_y].into_iter().enumerate() {
                made.image.set(i, k, number);
            }
            for (k, number) in [sample.lens_u, sample.lens_v].into_iter().enumerate() {
                made.lens.set(i, k, number);
            }
            made.time.set(i, 0, sample.time);
        }
        made
    }

    fn batch(&self) -> realistic_request {
        realistic_request {
            image: self.image.input(),
            lens: self.lens.input(),
            time: self.time.input(),
            ..nothing()
        }
    }
}

/// Room for origin, direction, weight, range, time and reason of rays.
struct Found([Memory; 7]);

const COMPONENTS: [usize; 7] = [3, 3, 1, 1, 1, 1, 1];

impl Found {
    fn new(n: usize, random: &mut Random) -> Self {
        Self(COMPONENTS.map(|components| Memory::new(n, components, random)))
    }

    fn ask(&mut self, batch: &mut realistic_request) {
        let [origin, direction, weight, mint, maxt, time, reason] = self.0.each_mut().map(Memory::output);
        (batch.origin, batch.direction, batch.weight) = (origin, direction, weight);
        (batch.mint, batch.maxt, batch.ray_time) = (mint, maxt, time);
        (batch.reason, batch.reason_stride) = (reason.x.cast(), reason.stride);
    }

    /// As [`bits`] of a ray, where there is one.
    fn bits(&self, i: usize) -> Bits {
        let [origin, direction, weight, mint, maxt, time, _] = &self.0;
        let [ox, oy, oz] = [0, 1, 2].map(|k| origin.bits(i, k));
        let [dx, dy, dz] = [0, 1, 2].map(|k| direction.bits(i, k));
        [ox, oy, oz, dx, dy, dz, mint.bits(i, 0), maxt.bits(i, 0), time.bits(i, 0), weight.bits(i, 0)]
    }

    fn assert(&self, i: usize, expected: &Bits, told: &str) {
        let (found, reason) = (self.bits(i), self.0[6].bits(i, 0));
        if f32::from_bits(expected[9]) > 0.0 {
            assert_eq!((found, reason), (*expected, 0), "{told}, sample {i}");
        } else {
            assert_eq!(found[9], 0, "{told}, sample {i}");
            assert_eq!(found[..9], [u32::from_ne_bytes([FILL; 4]); 9], "{told}, sample {i} is written to");
            assert_ne!(reason, 0, "{told}, sample {i}");
        }
    }
}

fn ask(camera: &Camera, n: usize, batch: &realistic_request) -> realistic_status {
    // SAFETY: a live camera; all arrays lie in their memory.
    unsafe { realistic_camera_generate_batch(camera.0, n, batch) }
}

#[test]
fn arrays_of_any_strides_have_the_bits_of_single_calls() {
    let mut random = Random::new(11);
    for (name, camera) in cameras() {
        for n in [1, 2, 3, 5, 127, 128, 129, 300] {
            let samples = samples(n);
            let expected = singles(&camera, &samples);
            for round in 0..6 {
                let asked = Asked::new(&samples, &mut random);
                let mut found = Found::new(n, &mut random);
                let mut batch = asked.batch();
                found.ask(&mut batch);
                assert_eq!(ask(&camera, n, &batch), realistic_status::Ok);
                for (i, expected) in expected.iter().enumerate() {
                    found.assert(i, expected, &format!("{name}, {n}, round {round}"));
                }
                for (memory, components) in found.0.iter().zip(COMPONENTS) {
                    assert!(memory.is_whole(n, components), "{name}, {n}, round {round}");
                }
            }
        }
    }
}

#[test]
fn what_is_left_out_is_nothing_and_an_element_may_serve_all_samples() {
    let camera = camera(|_| ());
    let mut random = Random::new(12);
    let n = 200;
    let mut samples = samples(n);
    for sample in &mut samples {
        (sample.image_x, sample.image_y, sample.time) = (21.5, 13.25, 0.0);
    }
    let expected = singles(&camera, &samples);
    let asked = Asked::new(&samples, &mut random);
    let mut batch = asked.batch();
    let point = [21.5_f32, 13.25];
    batch.image = realistic_input { x: &raw const point[0], y: &raw const point[1], stride: 0 };
    batch.time = NO_INPUT;
    let mut found = Found::new(n, &mut random);
    found.ask(&mut batch);
    (batch.mint, batch.maxt, batch.ray_time, batch.reason) = (NO_OUTPUT, NO_OUTPUT, NO_OUTPUT, null_mut());
    assert_eq!(ask(&camera, n, &batch), realistic_status::Ok);
    for (i, expected) in expected.iter().enumerate() {
        let has_ray = f32::from_bits(expected[9]) > 0.0;
        let told = if has_ray { [expected[0], expected[5]] } else { [u32::from_ne_bytes([FILL; 4]); 2] };
        let found = found.bits(i);
        assert_eq!(([found[0], found[5]], found[9]), (told, expected[9]), "sample {i}");
    }
    assert!(found.0[3..].iter().all(|memory| memory.bytes.iter().all(|byte| *byte == FILL)));
}

#[test]
fn wavelengths_and_neighbours_are_those_of_structures_of_arrays() {
    let mut random = Random::new(13);
    let n = 300;
    let samples = samples(n);
    let column = |number: fn(&realistic_sample) -> f32| samples.iter().map(number).collect::<Vec<_>>();
    let columns = [
        column(|sample| sample.image_x),
        column(|sample| sample.image_y),
        column(|sample| sample.lens_u),
        column(|sample| sample.lens_v),
        column(|sample| sample.time),
    ];
    let [image_x, image_y, lens_u, lens_v, time] = columns.each_ref().map(|column| column.as_ptr());
    let soa = realistic_samples_soa { image_x, image_y, lens_u, lens_v, time };
    let wavelengths: Vec<f32> = (0..n).map(|i| 380.0 + 400.0 * i as f32 / n as f32).collect();
    for (name, camera) in
        [("default", camera(|_| ())), ("slit", camera(|o| o.shutter = c"focal-plane".as_ptr()))]
    {
        let mut rooms = vec![vec![f32::from_ne_bytes([FILL; 4]); n]; 30];
        let mut room = |k: usize| {
            let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] =
                std::array::from_fn(|part| rooms[10 * k + part].as_mut_ptr());
            realistic_rays_soa { ox, oy, oz, dx, dy, dz, mint, maxt, time, weight, reason: null_mut() }
        };
        let (rays, rx, ry) = (room(0), room(1), room(2));
        let number = |k: usize, part: usize, i: usize| rooms[10 * k + part][i].to_bits();
        let asked = Asked::new(&samples, &mut random);
        let mut found = Found::new(n, &mut random);

        // SAFETY: a live camera, arrays of `n` elements.
        let status = unsafe { rays_at_soa::<1>(camera.0, n, &soa, wavelengths.as_ptr(), &rays) };
        assert_eq!(status, realistic_status::Ok);
        let mut at = Memory::new(n, 1, &mut random);
        (0..n).for_each(|i| at.set(i, 0, wavelengths[i]));
        let mut batch = asked.batch();
        batch.wavelength = at.input();
        found.ask(&mut batch);
        assert_eq!(ask(&camera, n, &batch), realistic_status::Ok);
        for i in 0..n {
            found.assert(
                i,
                &std::array::from_fn(|part| number(0, part, i)),
                &format!("{name} at a wavelength"),
            );
        }

        // SAFETY: as above.
        let status = unsafe { differentials_at_soa(camera.0, n, &soa, null(), &rays, &rx, &ry) };
        assert_eq!(status, realistic_status::Ok);
        let mut batch = asked.batch();
        let mut found = Found::new(n, &mut random);
        let mut beside = [Found::new(n, &mut random), Found::new(n, &mut random)];
        found.ask(&mut batch);
        let [[rx_origin, rx_direction, rx_weight, ..], [ry_origin, ry_direction, ry_weight, ..]] =
            beside.each_mut().map(|found| found.0.each_mut().map(Memory::output));
        batch = realistic_request {
            rx_origin,
            rx_direction,
            rx_weight,
            ry_origin,
            ry_direction,
            ry_weight,
            ..batch
        };
        assert_eq!(ask(&camera, n, &batch), realistic_status::Ok);
        for i in 0..n {
            found.assert(
                i,
                &std::array::from_fn(|part| number(0, part, i)),
                &format!("{name} with neighbours"),
            );
            for (k, beside) in beside.iter().enumerate() {
                let found = beside.bits(i);
                let expected: Bits = std::array::from_fn(|part| number(1 + k, part, i));
                assert_eq!(
                    (&found[..6], found[9]),
                    (&expected[..6], expected[9]),
                    "{name}, neighbour {k} of {i}"
                );
            }
        }
    }
}

/// Origin, direction and weight of rays at wavelengths, and of their neighbours, by structures of arrays.
fn differential_columns(
    camera: &Camera,
    samples: &[realistic_sample],
    wavelengths: &[f32],
) -> [[Vec<f32>; 7]; 3] {
    let n = samples.len();
    let column = |number: fn(&realistic_sample) -> f32| samples.iter().map(number).collect::<Vec<_>>();
    let asked = [
        column(|sample| sample.image_x),
        column(|sample| sample.image_y),
        column(|sample| sample.lens_u),
        column(|sample| sample.lens_v),
        column(|sample| sample.time),
    ];
    let [image_x, image_y, lens_u, lens_v, time] = asked.each_ref().map(|column| column.as_ptr());
    let soa = realistic_samples_soa { image_x, image_y, lens_u, lens_v, time };
    let fill = f32::from_ne_bytes([FILL; 4]);
    let mut rooms: [[Vec<f32>; 7]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| vec![fill; n]));
    let [rays, rx, ry] = rooms.each_mut().map(|room| {
        let [ox, oy, oz, dx, dy, dz, weight] = room.each_mut().map(|column| column.as_mut_ptr());
        let (mint, maxt, time, reason) = (null_mut(), null_mut(), null_mut(), null_mut());
        realistic_rays_soa { ox, oy, oz, dx, dy, dz, mint, maxt, time, weight, reason }
    });
    // SAFETY: a live camera, arrays of `n` elements.
    let status = unsafe {
        let at = wavelengths.as_ptr();
        differentials_at_soa(camera.0, n, &soa, at, &rays, &rx, &ry)
    };
    assert_eq!(status, realistic_status::Ok);
    rooms
}

#[test]
fn differentials_at_wavelengths_have_the_bits_of_three_calls() {
    let mut random = Random::new(15);
    let mut seen = [0; 4];
    let more = [
        (
            "phone",
            camera(|o| {
                o.specfile = c"phone.4mm".as_ptr();
                o.filmdiag = 6.0;
            }),
        ),
        (
            "zoom",
            camera(|o| {
                o.specfile = c"zoom.24-70mm".as_ptr();
                o.zoom = c"45".as_ptr();
            }),
        ),
    ];
    for (name, camera) in cameras().into_iter().chain(more) {
        // Cameras with a shutter have the default's lens, and neighbours whether it is open there or not.
        let open = if ["slit", "leaf"].contains(&name) { Some(self::camera(|_| ())) } else { None };
        let samples: Vec<_> = samples(400).into_iter().chain(beside_edges(&camera)).collect();
        let n = samples.len();
        let wavelength = |i: usize| match i % 50 {
            7 => f32::NAN,
            17 => 379.9,
            27 => f32::INFINITY,
            37 => -550.0,
            _ => 380.0 + 400.0 * (i as f32 * 0.618).fract(),
        };
        let mut at = Memory::new(n, 1, &mut random);
        (0..n).for_each(|i| at.set(i, 0, wavelength(i)));
        let asked = Asked::new(&samples, &mut random);
        let mut found = Found::new(n, &mut random);
        let mut beside = [Found::new(n, &mut random), Found::new(n, &mut random)];
        let mut batch = asked.batch();
        found.ask(&mut batch);
        let [[rx_origin, rx_direction, rx_weight, ..], [ry_origin, ry_direction, ry_weight, ..]] =
            beside.each_mut().map(|found| found.0.each_mut().map(Memory::output));
        batch = realistic_request {
            wavelength: at.input(),
            rx_origin,
            rx_direction,
            rx_weight,
            ry_origin,
            ry_direction,
            ry_weight,
            ..batch
        };
        assert_eq!(ask(&camera, n, &batch), realistic_status::Ok);
        let columns = differential_columns(&camera, &samples, &(0..n).map(wavelength).collect::<Vec<_>>());
        for (i, sample) in samples.iter().enumerate() {
            let call = |camera: &Camera, sample: &realistic_sample, ray: &mut realistic_ray| {
                // SAFETY: a live camera.
                unsafe { ray_at(camera.0, sample, wavelength(i), ray) }
            };
            let expected @ (own, has, numbers) =
                by_calls(&camera, open.as_ref().unwrap_or(&camera), sample, call);
            let mut ray = UNTOUCHED_DIFFERENTIAL;
            // SAFETY: a live camera.
            let weight = unsafe { differential_at(camera.0, sample, wavelength(i), &mut ray) };
            assert_eq!(differential_bits(&ray, weight), expected, "{name}: {sample:?} {}", wavelength(i));
            found.assert(i, &own, name);
            let has = if weight > 0.0 { has } else { 0 };
            seen[has as usize] += 1;
            for (k, beside) in beside.iter().enumerate() {
                let beside = beside.bits(i);
                let is_there = has & [REALISTIC_HAS_RX, REALISTIC_HAS_RY][k] != 0;
                assert_eq!(f32::from_bits(beside[9]) > 0.0, is_there, "{name}, neighbour {k} of {i}");
                let fill = [u32::from_ne_bytes([FILL; 4]); 6];
                let expected = if weight > 0.0 { &numbers[6 * k..6 * k + 6] } else { &fill };
                assert_eq!(&beside[..6], expected, "{name}, neighbour {k} of {i}");
                let [.., dz, weight] = columns[1 + k].each_ref().map(|column| column[i].to_bits());
                assert_eq!((dz, weight), (beside[5], beside[9]), "{name}, neighbour {k} of {i}, as arrays");
            }
            let [.., dz, weight] = columns[0].each_ref().map(|column| column[i].to_bits());
            assert_eq!((dz, weight), (found.bits(i)[5], found.bits(i)[9]), "{name}, {i}, as arrays");
        }
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

/// Up to more than two groups of the widest vectors: of lanes and of vectors any number is idle.
#[test]
fn batches_of_every_size_have_the_bits_of_single_calls() {
    let aspheres = |name: &CStr, film, precision: &CStr| {
        camera(|options| {
            (options.specfile, options.filmdiag, options.precision) =
                (name.as_ptr(), film, precision.as_ptr());
        })
    };
    let more = [
        ("aspheres", aspheres(c"phone.4mm", 6.0, c"f64")),
        ("aspheres, single", aspheres(c"phone.4mm", 6.0, c"f32")),
        ("zoom", aspheres(c"zoom.24-70mm", 35.0, c"f64")),
    ];
    let samples = samples(70);
    let wavelengths: Vec<f32> = (0..70).map(|i| 380.0 + 400.0 * (i as f32 * 0.618).fract()).collect();
    for (name, camera) in cameras().into_iter().chain(more) {
        let expected = singles(&camera, &samples);
        let expected_at: Vec<_> = samples
            .iter()
            .zip(&wavelengths)
            .map(|(sample, wavelength)| {
                let mut ray = UNTOUCHED;
                // SAFETY: a live camera.
                let weight = unsafe { ray_at(camera.0, sample, *wavelength, &mut ray) };
                bits(&ray, weight)
            })
            .collect();
        for n in 1..=samples.len() {
            let (rays, _) = arrays(&camera, &samples[..n], 0);
            assert!(rays == expected[..n], "{name}: arrays of {n}");
            let mut random = Random::new(n as u64);
            let mut at = Memory::new(n, 1, &mut random);
            (0..n).for_each(|i| at.set(i, 0, wavelengths[i]));
            let asked = Asked::new(&samples[..n], &mut random);
            let mut found = Found::new(n, &mut random);
            let mut batch = realistic_request { wavelength: at.input(), ..asked.batch() };
            found.ask(&mut batch);
            assert_eq!(ask(&camera, n, &batch), realistic_status::Ok);
            for (i, expected) in expected_at[..n].iter().enumerate() {
                found.assert(i, expected, &format!("{name}: {n} at wavelengths"));
            }
        }
    }
}

#[test]
fn a_batch_that_cannot_be_is_refused_by_the_name_of_its_part() {
    let camera = camera(|_| ());
    let mut random = Random::new(14);
    let samples = samples(4);
    let asked = Asked::new(&samples, &mut random);
    let mut found = Found::new(4, &mut random);
    let mut good = asked.batch();
    found.ask(&mut good);
    let refused = |set: &dyn Fn(&mut realistic_request), status: realistic_status, words: &str| {
        let mut batch = good;
        set(&mut batch);
        assert_eq!(ask(&camera, 4, &batch), status, "{words}");
        // SAFETY: the message lives until the next call.
        let message = unsafe { CStr::from_ptr(realistic_last_error()) }.to_str().unwrap().to_owned();
        assert!(message.contains(words), "{message}");
    };
    use realistic_status::{InvalidParameter, NullPointer, StructSize};
    refused(&|batch| batch.image = NO_INPUT, NullPointer, "request.image.x");
    refused(&|batch| batch.lens.y = null(), NullPointer, "request.lens.y");
    refused(&|batch| batch.weight = NO_OUTPUT, NullPointer, "request.weight.x");
    refused(&|batch| batch.origin.z = null_mut(), NullPointer, "request.origin.z");
    refused(&|batch| batch.rx_weight = batch.weight, NullPointer, "request.rx_origin.x");
    refused(&|batch| batch.origin.stride = 0, InvalidParameter, "request.origin.stride is 0");
    refused(&|batch| batch.time.stride = -2, InvalidParameter, "request.time.stride is -2");
    refused(&|batch| batch.reason_stride = 1, InvalidParameter, "request.reason.stride is 1");
    for stride in [isize::MAX, isize::MIN, isize::MAX / 3 + 1, 1 << 46] {
        refused(&|batch| batch.lens.stride = stride, InvalidParameter, "n is 4");
    }
    refused(&|batch| batch.wavelengths_per_sample = 4, NullPointer, "request.wavelength.x");
    refused(&|batch| batch.struct_size = 8, StructSize, "realistic_request.struct_size");
    // More rays than there is room for addresses.
    let endless = realistic_request { wavelengths_per_sample: u32::MAX, wavelength: good.image, ..good };
    assert_eq!(ask(&camera, usize::MAX / 2, &endless), InvalidParameter);
    // SAFETY: nothing of NULL is read.
    let status = unsafe { realistic_camera_generate_batch(camera.0, 4, std::ptr::null()) };
    assert_eq!(status, NullPointer);
    assert!(
        found.0.iter().all(|memory| memory.bytes.iter().all(|byte| *byte == FILL)),
        "a refused batch writes nothing"
    );
}
