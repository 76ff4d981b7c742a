//! The same through the C ABI: batches, strides and alignment, four wavelengths of a sample, reasons.

use std::ptr::{null, null_mut};

use realistic::unstable::abi::*;

use crate::support::{
    Random,
    abi_camera::{self, Camera},
    abi_rays::{Bits, UNTOUCHED, bits},
    inline::*,
};

/// A camera whose glasses have V-numbers.
fn camera(set: impl FnOnce(&mut realistic_options)) -> Camera {
    abi_camera::camera(|options| {
        options.specfile = c"dgauss.100mm".as_ptr();
        set(options);
    })
}

/// Samples all over the film with wavelengths, some of which are none.
fn asked(n: usize) -> (Vec<realistic_sample>, Vec<f32>) {
    let mut random = Random::new(8);
    let mut number = || random.next() as f32;
    let samples = (0..n).map(|_| realistic_sample {
        image_x: 40.0 * number(),
        image_y: 30.0 * number(),
        lens_u: number(),
        lens_v: number(),
        time: number(),
    });
    let samples = samples.collect();
    let wavelengths = (0..n).map(|i| if i % 11 == 5 { 1000.0 * number() } else { 380.0 + 400.0 * number() });
    (samples, wavelengths.collect())
}

fn singles(camera: &Camera, samples: &[realistic_sample], wavelengths: &[f32]) -> Vec<Bits> {
    let one = |(sample, wavelength): (&realistic_sample, &f32)| {
        let mut ray = UNTOUCHED;
        // SAFETY: a live camera.
        let weight = unsafe { ray_at(camera.0, sample, *wavelength, &mut ray) };
        bits(&ray, weight)
    };
    samples.iter().zip(wavelengths).map(one).collect()
}

/// Rays as structure of arrays, each `n` long, that begin so many bytes beyond where floats may.
struct Columns {
    bytes: Vec<Vec<u8>>,
    odd: usize,
    reasons: Vec<realistic_reason>,
}

impl Columns {
    fn new(n: usize, odd: usize) -> Self {
        let realistic_ray { o, d, mint, maxt, time } = UNTOUCHED;
        let numbers = o.into_iter().chain(d).chain([mint, maxt, time, -1.0]);
        let column = |number: f32| {
            let mut bytes = vec![0; odd];
            (0..n).for_each(|_| bytes.extend(number.to_ne_bytes()));
            bytes
        };
        Self { bytes: numbers.map(column).collect(), odd, reasons: vec![realistic_reason::Ok; n] }
    }

    fn soa(&mut self) -> realistic_rays_soa {
        let odd = self.odd;
        // SAFETY: each vector has more bytes than that.
        let mut at = |i: usize| unsafe { self.bytes[i].as_mut_ptr().add(odd).cast::<f32>() };
        let [ox, oy, oz, dx, dy, dz, mint, maxt, time, weight] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(&mut at);
        realistic_rays_soa {
            ox,
            oy,
            oz,
            dx,
            dy,
            dz,
            mint,
            maxt,
            time,
            weight,
            reason: self.reasons.as_mut_ptr(),
        }
    }

    fn rows(&self) -> Vec<Bits> {
        let number = |array: &Vec<u8>, i: usize| {
            let at = self.odd + 4 * i;
            u32::from_ne_bytes([array[at], array[at + 1], array[at + 2], array[at + 3]])
        };
        (0..self.reasons.len()).map(|i| std::array::from_fn(|k| number(&self.bytes[k], i))).collect()
    }
}

/// Samples as structure of arrays.
struct Asked([Vec<f32>; 5]);

impl Asked {
    fn new(samples: &[realistic_sample]) -> Self {
        let column = |get: fn(&realistic_sample) -> f32| samples.iter().map(get).collect();
        Self([
            column(|sample| sample.image_x),
            column(|sample| sample.image_y),
            column(|sample| sample.lens_u),
            column(|sample| sample.lens_v),
            column(|sample| sample.time),
        ])
    }

    fn soa(&self) -> realistic_samples_soa {
        let [image_x, image_y, lens_u, lens_v, time] = self.0.each_ref().map(|column| column.as_ptr());
        realistic_samples_soa { image_x, image_y, lens_u, lens_v, time }
    }
}

fn cameras() -> Vec<(&'static str, Camera)> {
    vec![
        ("default", camera(|_| ())),
        ("single", camera(|options| options.precision = c"f32".as_ptr())),
        ("rear", camera(|options| options.pupil = c"rear".as_ptr())),
        ("walked", camera(|options| options.refraction = c"heckbert".as_ptr())),
        ("slit", camera(|options| options.shutter = c"focal-plane".as_ptr())),
        ("plain", camera(|options| options.specfile = c"dgauss.50mm".as_ptr())),
        (
            "perspective",
            camera(|options| {
                (options.model, options.specfile) = (c"perspective".as_ptr(), null());
            }),
        ),
        ("tolerant", camera(|options| (options.fnumber, options.tolerance) = (16.0, 1.0))),
    ]
}

#[test]
fn batches_have_the_bits_of_single_calls() {
    for (name, camera) in cameras() {
        for n in [0, 1, 3, 4, 5, 127, 128, 400] {
            let (samples, wavelengths) = asked(n);
            let expected = singles(&camera, &samples, &wavelengths);
            // As structures, packed and with a rest; the wavelengths inside structures of 12 bytes.
            let spread: Vec<[f32; 3]> = wavelengths.iter().map(|nm| [-1.0, *nm, -1.0]).collect();
            let first = spread.first().map_or(null(), |three| &raw const three[1]);
            for (wavelengths, stride) in [(wavelengths.as_ptr(), 0), (first, 12)] {
                if wavelengths.is_null() {
                    continue;
                }
                let mut rays = vec![UNTOUCHED; n];
                let (mut weights, mut reasons) = (vec![-1.0; n], vec![realistic_reason::Ok; n]);
                // SAFETY: the arrays are as long as is said.
                let status = unsafe {
                    rays_at(
                        camera.0,
                        n,
                        samples.as_ptr(),
                        0,
                        wavelengths,
                        stride,
                        rays.as_mut_ptr(),
                        0,
                        weights.as_mut_ptr(),
                        reasons.as_mut_ptr(),
                    )
                };
                assert_eq!(status, realistic_status::Ok);
                let found: Vec<Bits> =
                    rays.iter().zip(&weights).map(|(ray, weight)| bits(ray, *weight)).collect();
                assert_eq!(found, expected, "{name}, {n}");
                for (weight, reason) in weights.iter().zip(reasons) {
                    assert_eq!(*weight > 0.0, reason == realistic_reason::Ok, "{name}");
                }
            }
            let asked = Asked::new(&samples);
            for odd in [0, 1] {
                let mut columns = Columns::new(n, odd);
                // SAFETY: the arrays are as long as is said.
                let status = unsafe {
                    rays_at_soa::<1>(camera.0, n, &asked.soa(), wavelengths.as_ptr(), &columns.soa())
                };
                assert_eq!(status, realistic_status::Ok);
                assert_eq!(columns.rows(), expected, "{name}, {n}, {odd}");
                for (i, reason) in columns.reasons.iter().enumerate() {
                    let is_none = !(380.0..=780.0).contains(&wavelengths[i]);
                    let shut = *reason == realistic_reason::Shut;
                    assert_eq!(
                        *reason == realistic_reason::Wavelength,
                        is_none && !shut,
                        "{name} {reason:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn without_wavelengths_batches_have_the_cameras_own_bits() {
    const N: usize = 300;
    for (name, camera) in cameras() {
        let (samples, _) = asked(N);
        let asked = Asked::new(&samples);
        let (mut own, mut at) = (Columns::new(N, 0), Columns::new(N, 0));
        let rays = || (vec![UNTOUCHED; N], vec![-1.0_f32; N]);
        let [(mut a, mut wa), (mut b, mut wb)] = [rays(), rays()];
        // SAFETY: the arrays are as long as is said.
        unsafe {
            let soa = asked.soa();
            let done = [
                realistic_camera_generate_rays_soa(camera.0, N, &soa, &own.soa()),
                rays_at_soa::<1>(camera.0, N, &soa, null(), &at.soa()),
                realistic_camera_generate_rays(
                    camera.0,
                    N,
                    samples.as_ptr(),
                    0,
                    a.as_mut_ptr(),
                    0,
                    wa.as_mut_ptr(),
                    null_mut(),
                ),
                rays_at(
                    camera.0,
                    N,
                    samples.as_ptr(),
                    0,
                    null(),
                    0,
                    b.as_mut_ptr(),
                    0,
                    wb.as_mut_ptr(),
                    null_mut(),
                ),
            ];
            assert_eq!(done, [realistic_status::Ok; 4]);
        }
        assert_eq!(own.rows(), at.rows(), "{name}");
        assert_eq!((own.reasons, a, wa), (at.reasons, b, wb), "{name}");
    }
}

#[test]
fn four_wavelengths_of_a_sample_have_the_bits_of_single_calls() {
    const N: usize = 75;
    for (name, camera) in cameras() {
        let (samples, _) = asked(N);
        let (_, wavelengths) = asked(4 * N);
        let spread: Vec<realistic_sample> = (0..4 * N).map(|i| samples[i / 4]).collect();
        let expected = singles(&camera, &spread, &wavelengths);
        let mut columns = Columns::new(4 * N, 0);
        // SAFETY: the arrays are as long as is said.
        let status = unsafe {
            let asked = Asked::new(&samples);
            let (samples, rays) = (asked.soa(), columns.soa());
            rays_at_soa::<4>(camera.0, N, &samples, wavelengths.as_ptr(), &rays)
        };
        assert_eq!(status, realistic_status::Ok);
        assert_eq!(columns.rows(), expected, "{name}");
        for (i, sample) in samples.iter().enumerate() {
            let (mut rays, mut weights) = ([UNTOUCHED; 4], [-1.0; 4]);
            // SAFETY: four of each.
            let first = unsafe {
                hero_rays(
                    camera.0,
                    sample,
                    wavelengths[4 * i..].as_ptr(),
                    rays.as_mut_ptr(),
                    weights.as_mut_ptr(),
                )
            };
            assert_eq!(first.to_bits(), weights[0].to_bits(), "the weight that is returned");
            for k in 0..4 {
                assert_eq!(bits(&rays[k], weights[k]), expected[4 * i + k], "{name}");
            }
        }
    }
}

#[test]
fn what_is_missing_is_refused_and_nothing_is_written() {
    let camera = camera(|_| ());
    let (samples, wavelengths) = asked(4);
    let (mut ray, mut weights) = ([UNTOUCHED; 4], [-1.0; 4]);
    let asked = Asked::new(&samples);
    let mut columns = Columns::new(4, 0);
    let before = columns.rows();
    // SAFETY: what is not NULL is valid.
    unsafe {
        let sample = &raw const samples[0];
        assert_eq!(ray_at(null(), sample, 500.0, &mut ray[0]), 0.0);
        assert_eq!(ray_at(camera.0, null(), 500.0, &mut ray[0]), 0.0);
        assert_eq!(ray_at(camera.0, sample, 500.0, null_mut()), 0.0);
        assert_eq!(ray_at(camera.0, sample, f32::NAN, &mut ray[0]), 0.0);
        let (rays, to) = (ray.as_mut_ptr(), weights.as_mut_ptr());
        assert_eq!(hero_rays(camera.0, sample, null(), rays, to), 0.0);
        assert_eq!(hero_rays(camera.0, sample, wavelengths.as_ptr(), rays, null_mut()), 0.0);
        let (samples, rays) = (asked.soa(), columns.soa());
        let null_pointer = realistic_status::NullPointer;
        let hero = rays_at_soa::<4>(camera.0, 1, &samples, null(), &rays);
        assert_eq!(hero, null_pointer);
        let nm = wavelengths.as_ptr();
        assert_eq!(rays_at_soa::<1>(camera.0, 4, null(), nm, &rays), null_pointer);
        assert_eq!(rays_at_soa::<1>(camera.0, 4, &samples, nm, null()), null_pointer);
        let no_camera = rays_at_soa::<1>(null(), 4, &samples, nm, &rays);
        assert_eq!(no_camera, realistic_status::NotACamera);
        let endless = rays_at_soa::<4>(camera.0, usize::MAX / 8, &samples, nm, &rays);
        assert_eq!(endless, realistic_status::InvalidParameter);
        assert_eq!(rays_at_soa::<4>(camera.0, 0, &samples, null(), &rays), realistic_status::Ok);
    }
    assert_eq!((ray, weights, columns.rows()), ([UNTOUCHED; 4], [-1.0; 4], before));
}
