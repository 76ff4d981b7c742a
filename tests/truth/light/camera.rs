//! A camera's weights against the product over its lens's surfaces, along the rays that the camera generates.

use std::collections::BTreeMap;

use super::{super::support::Random, exact_surfaces};
use crate::support::columns::{RayAt as _, RayColumns, SampleColumns};
use realistic::{Camera, Precision, Pupil, Sample, Transmission, Weighting};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::{Coating, Prescription, SurfaceCoating, catalogue},
    trace::Path,
};

/// Returns a lens at a wavelength with the exact product over its surfaces, for light toward the film.
fn lit(lens: &Lens, coating: Coating) -> LitPath {
    LitPath::new(Path::scene_to_film(lens), &exact_surfaces(lens, coating))
}

/// Returns the share of light transmitted along a camera's ray.
fn exact(lit: &LitPath, origin: [f32; 3], direction: [f32; 3]) -> Option<f64> {
    let (o, d) = (origin.map(f64::from), direction.map(f64::from));
    let back = Ray { origin: std::array::from_fn(|k| o[k] + d[k]), direction: d.map(|x| -x) };
    lit.trace(back).ok().map(|(_, power)| power)
}

/// A cache of the results of [`lit`] by wavelength.
struct Walks<'a> {
    prescription: &'a Prescription,
    coating: Coating,
    made: BTreeMap<u64, LitPath>,
}

impl<'a> Walks<'a> {
    fn new(prescription: &'a Prescription, coating: Coating) -> Self {
        Self { prescription, coating, made: BTreeMap::new() }
    }

    fn at(&mut self, nm: f64) -> &LitPath {
        let make = || lit(&Lens::new(self.prescription, nm), self.coating);
        self.made.entry(nm.to_bits()).or_insert_with(make)
    }
}

fn samples(count: usize) -> Vec<Sample> {
    let mut random = Random::new(23);
    let mut next = |most: f64| (most * random.next()) as f32;
    (0..count)
        .map(|_| Sample {
            image_x: next(60.0),
            image_y: next(40.0),
            lens_u: next(1.0),
            lens_v: next(1.0),
            time: 0.5,
        })
        .collect()
}

#[test]
fn weights_are_lossless_weights_times_the_exact_product() {
    for name in ["dgauss.50mm", "sonnar.50mm", "fisheye.10mm", "zoom.24-70mm", "retrofocus.20mm"] {
        let builder = Camera::builder().lens_file(name).film_diagonal(30.0).resolution(60, 40);
        let plain = builder.clone().build().expect("a camera");
        for (transmission, coating) in
            [(Transmission::Bare, Coating::Bare), (Transmission::QuarterWave, Coating::QuarterWave)]
        {
            let camera = builder.clone().transmission(transmission).build().expect("a camera");
            let walk = lit(&camera.facts().expect("a lens").lens, coating);
            let (mut most, mut count): (f64, u32) = (0.0, 0);
            for sample in samples(1500) {
                let (lossless, lossy) = (plain.ray(&sample), camera.ray(&sample));
                let (Some((ray, whole)), Some((same, left))) = (lossless, lossy) else {
                    assert_eq!(lossless.is_some(), lossy.is_some(), "{name}");
                    continue;
                };
                assert_eq!(ray, same);
                let Some(exact) = exact(&walk, ray.origin, ray.direction) else { continue };
                most = most.max((f64::from(left / whole) / exact - 1.0).abs());
                count += 1;
            }
            assert!(count > 300 && most < 1e-4, "{name} {coating:?}: {most} of {count}");
        }
    }
}

#[test]
fn weights_at_wavelengths_are_times_the_product_at_each() {
    // Without dispersion, a lens has the camera's own pupil at every wavelength only if the pupil is a disk. The true
    // pupil at other wavelengths has a separate table, which maps a sample to another ray.
    for (name, pupil) in
        [("dgauss.50mm", Pupil::Rear), ("planar.50mm", Pupil::Warped), ("tele.135mm", Pupil::Warped)]
    {
        let prescription = catalogue::find(name).expect("in the catalogue");
        let builder = Camera::builder().lens_file(name).pupil(pupil).film_diagonal(30.0).resolution(60, 40);
        let plain = builder.clone().build().expect("a camera");
        for (transmission, coating) in
            [(Transmission::Bare, Coating::Bare), (Transmission::QuarterWave, Coating::QuarterWave)]
        {
            let camera = builder.clone().transmission(transmission).build().expect("a camera");
            let mut walks = Walks::new(&prescription, coating);
            let (mut most, mut count): (f64, u32) = (0.0, 0);
            for (i, sample) in samples(600).iter().enumerate() {
                let wavelength = 390.0 + (i % 39) as f32 * 10.0;
                let (Some((ray, whole)), Some((_, left))) =
                    (plain.ray_at(sample, wavelength), camera.ray_at(sample, wavelength))
                else {
                    continue;
                };
                let walk = walks.at(wavelength.into());
                let Some(exact) = exact(walk, ray.origin, ray.direction) else { continue };
                most = most.max((f64::from(left / whole) / exact - 1.0).abs());
                count += 1;
            }
            assert!(count > 200 && most < 1e-4, "{name} {coating:?}: {most} of {count}");
        }
    }
}

/// Checks gull-wing aspheres, which rays meet near grazing incidence.
#[test]
fn rays_through_gull_wings_have_the_exact_product() {
    let prescription = catalogue::find("phone.4mm").expect("in the catalogue");
    let samples = samples(256);
    for (transmission, coating, precision) in [
        (Transmission::Bare, Coating::Bare, Precision::F64),
        (Transmission::QuarterWave, Coating::QuarterWave, Precision::F32),
    ] {
        let builder = Camera::builder().lens_file("phone.4mm").film_diagonal(6.0).resolution(60, 40);
        let builder = builder.precision(precision);
        let plain = builder.clone().build().expect("a camera");
        let camera = builder.transmission(transmission).build().expect("a camera");
        let mut walks = Walks::new(&prescription, coating);
        let (mut block, mut rays) = (SampleColumns::new(256), RayColumns::new(256));
        samples.iter().enumerate().for_each(|(i, sample)| block.set(i, sample));
        let wavelengths: Vec<f32> = (0..256_u16).map(|i| 390.0 + f32::from(i % 39) * 10.0).collect();
        for is_spectral in [false, true] {
            let one = |camera: &Camera, i: usize| {
                if is_spectral { camera.ray_at(&samples[i], wavelengths[i]) } else { camera.ray(&samples[i]) }
            };
            if is_spectral {
                camera.trace(&block.first(256).at(&wavelengths), &mut rays.first(256));
            } else {
                camera.trace(&block.first(256), &mut rays.first(256));
            }
            let (mut most, mut count): (f64, u32) = (0.0, 0);
            for (i, wavelength) in wavelengths.iter().enumerate() {
                let (lossless, lossy) = (one(&plain, i), one(&camera, i));
                assert_eq!(rays.get(i), lossy, "a batch has the bits of single calls");
                let (Some((ray, whole)), Some((same, left))) = (lossless, lossy) else {
                    assert_eq!(lossless.is_some(), lossy.is_some());
                    continue;
                };
                assert_eq!(ray, same);
                let nm = if is_spectral { f64::from(*wavelength) } else { 587.56 };
                let Some(exact) = exact(walks.at(nm), ray.origin, ray.direction) else { continue };
                most = most.max((f64::from(left / whole) / exact - 1.0).abs());
                count += 1;
            }
            println!("{coating:?} {precision:?} {is_spectral}: {most:e} of {count}");
            let bound = if precision == Precision::F64 { 1e-5 } else { 5e-5 };
            assert!(count > 150 && most < bound, "{coating:?} {precision:?}: {most} of {count}");
        }
    }
}

#[test]
fn a_walked_lens_and_the_kernel_have_the_same_transmission() {
    let builder =
        Camera::builder().lens_file("dgauss.50mm").transmission(Transmission::Bare).resolution(60, 40);
    let camera = builder.clone().build().expect("a camera");
    let others = [builder.clone().refraction(Refraction::Heckbert), builder.tolerance(0.5)];
    for other in others.map(|other| other.build().expect("a camera")) {
        let mut both = 0;
        for sample in samples(400) {
            if let (Some((_, weight)), Some((_, other))) = (camera.ray(&sample), other.ray(&sample)) {
                assert!((other / weight - 1.0).abs() < 1e-5, "{other} {weight}");
                both += 1;
            }
        }
        assert!(both > 300);
    }
}

#[test]
fn transmission_without_effect_warns() {
    let mut warnings = String::new();
    Camera::builder()
        .lens_file("dgauss.50mm")
        .transmission(Transmission::Bare)
        .weighting(Weighting::None)
        .resolution(6, 4)
        .build_with_log(&mut |_, text| warnings += text)
        .expect("a camera");
    assert!(warnings.contains("\"transmission\" changes nothing"), "{warnings}");
}

#[test]
fn the_coatings_of_the_lens_file_count_each_on_its_surface() {
    let table = include_str!("../../../crates/optics/lenses/dgauss.50mm.dat");
    let camera = |lines: &str, transmission| {
        let text = format!("{table}\n{lines}");
        Camera::builder()
            .lens_text("own.dat", text.as_bytes())
            .transmission(transmission)
            .film_diagonal(30.0)
            .resolution(60, 40)
            .build()
    };
    // A coating that the file states for all surfaces equals the parameter's, to the bit.
    let [file, parameter] = [Transmission::File, Transmission::ThreeLayer]
        .map(|transmission| camera("coating all three-layer", transmission).expect("a camera"));
    for sample in samples(300) {
        assert_eq!(file.ray(&sample), parameter.ray(&sample));
    }
    // The same holds for this coating written out as layers.
    let layers = SurfaceCoating::from(Coating::ThreeLayer).from_air();
    let words: Vec<String> = layers.iter().map(|own| format!("{} {}", own.index, own.thickness)).collect();
    let stack = camera(&format!("coating all stack {}", words.join(" ")), Transmission::File);
    let stack = stack.expect("a camera");
    for sample in samples(300) {
        assert_eq!(stack.ray(&sample), parameter.ray(&sample));
    }
    // The surfaces have coatings of their own: one is bare, and one coating is made for another wavelength.
    let lines = "coating all v-coat\ncoating 1 bare\ncoating 11 quarter-wave at=450\n";
    let [plain, own] = [Transmission::None, Transmission::File]
        .map(|transmission| camera(lines, transmission).expect("a camera"));
    let lens = &own.facts().expect("a lens").lens;
    let mut coatings = vec![SurfaceCoating::from(Coating::VCoat); 11];
    coatings[0] = Coating::Bare.into();
    coatings[10] = SurfaceCoating::Named { coating: Coating::QuarterWave, wavelength: 450.0 };
    let walk = LitPath::new(Path::scene_to_film(lens), &Surfaces::untabulated(lens, &coatings));
    let mut count = 0;
    for sample in samples(600) {
        let (Some((ray, whole)), Some((_, left))) = (plain.ray(&sample), own.ray(&sample)) else { continue };
        let Some(exact) = exact(&walk, ray.origin, ray.direction) else { continue };
        assert!((f64::from(left / whole) / exact - 1.0).abs() < 1e-4, "{} {exact}", left / whole);
        count += 1;
    }
    assert!(count > 300, "{count}");
    let error = camera("", Transmission::File).expect_err("no coatings").to_string();
    assert!(error.contains("\"own.dat\" names no coatings; give it lines \"coating ROW NAME\""), "{error}");
}
