//! Rays at individual wavelengths: against cameras built at each wavelength, closed forms, and brute force over the
//! rear element's disk.

use std::f64::consts::{FRAC_PI_4, SQRT_2};

use crate::support::columns::{RayAt as _, RayColumns, SampleColumns};
use ::realistic_camera::{
    Camera, CameraBuilder, Outcome, Precision, Pupil, Sample, Samples, Weighting, WorldRay,
    sampling::{PupilDisk, WarpedPupil},
};
use realistic_optics::{
    imaging::focus::Focus,
    lens::Lens,
    prescription::{Prescription, catalogue, glass::D_LINE, read},
    trace::Path,
};

use super::support::{Random, on_all_cores};

/// Wavelengths, nm: both ends of the range, and wavelengths at and between the tables of the pupil.
const WAVELENGTHS: [f32; 9] = [380.0, 386.0, 400.0, 434.0, 486.13, 546.07, 587.56, 660.0, 780.0];
/// Width and height of the image, pixels.
const SIZE: [u32; 2] = [1200, 800];

/// A lens at any wavelength, with a fixed film.
struct Subject {
    name: String,
    text: Option<String>,
    prescription: Prescription,
    film_distance: f64,
    film_diagonal: f64,
    stop: f64,
}

impl Subject {
    /// Returns a lens of the catalogue focused at infinity, with the stop closed to a fraction of its diameter.
    fn of_catalogue(name: &str, film_diagonal: f64, stop: f64) -> Self {
        let prescription = catalogue::find(name).expect("listed");
        Self::new(name, None, prescription, film_diagonal, stop)
    }

    fn of_text(text: &str, film_diagonal: f64) -> Self {
        let prescription = read("own.dat", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        Self::new("own.dat", Some(text.to_owned()), prescription, film_diagonal, 1.0)
    }

    fn new(
        name: &str,
        text: Option<String>,
        prescription: Prescription,
        film_diagonal: f64,
        stop: f64,
    ) -> Self {
        let lens = Lens::at_d_line(&prescription);
        let focused = || Focus::new(&lens).ok()?.film_distance(f64::INFINITY).ok();
        let film_distance = lens.nominal_film_distance.or_else(focused).unwrap_or(40.0);
        Self { name: name.to_owned(), text, prescription, film_distance, film_diagonal, stop }
    }

    fn builder(&self, wavelength: f64) -> CameraBuilder {
        let builder = match &self.text {
            Some(text) => Camera::builder().lens_text(&self.name, text.as_bytes()),
            None => Camera::builder().lens_file(&self.name),
        };
        let builder = builder
            .film_distance(self.film_distance)
            .film_diagonal(self.film_diagonal)
            .wavelength(wavelength)
            .resolution(SIZE[0], SIZE[1]);
        if self.stop == 1.0 {
            return builder;
        }
        let lens = self.lens(wavelength);
        builder.aperture_diameter(2.0 * lens.surfaces[lens.stop_index().expect("a stop")].semi_diameter)
    }

    fn lens(&self, wavelength: f64) -> Lens {
        let mut lens = Lens::new(&self.prescription, wavelength);
        if let Some(stop) = lens.stop_index() {
            lens.surfaces[stop].semi_diameter *= self.stop;
        }
        lens
    }

    fn pixel(&self) -> f64 {
        self.film_diagonal / f64::from(SIZE[0]).hypot(SIZE[1].into())
    }

    /// Returns the radius of the image on the film at a wavelength, mm, at most the film's corner.
    fn image_radius(&self, wavelength: f64) -> f64 {
        let lens = self.lens(wavelength);
        let film = lens.rear().vertex - self.film_distance;
        let reach = self.film_diagonal / 2.0 + 3.0 * SQRT_2 * self.pixel();
        let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
        let disks = [cover, PupilDisk::exit(&lens, film)];
        let pupil = WarpedPupil::new(&Path::film_to_scene(&lens), film, reach, disks);
        pupil.image_radius().unwrap_or(f64::INFINITY).min(self.film_diagonal / 2.0)
    }

    /// Returns the raster point at a distance from the axis, mm.
    fn raster(&self, height: f64) -> [f32; 2] {
        let (sin, cos) = 0.6_f64.sin_cos();
        let at = |side: u32, part: f64| (f64::from(side) / 2.0 + height / self.pixel() * part) as f32;
        [at(SIZE[0], cos), at(SIZE[1], sin)]
    }
}

/// Returns samples anywhere in the image, and a wavelength for each.
fn anywhere<const N: usize>(seed: u64) -> (SampleColumns, [f32; N]) {
    let mut random = Random::new(seed);
    let mut next = || random.next() as f32;
    let mut samples = SampleColumns::new(N);
    let wavelengths = std::array::from_fn(|i| {
        let (image_x, image_y) = (next() * SIZE[0] as f32, next() * SIZE[1] as f32);
        samples.set(i, &Sample { image_x, image_y, lens_u: next(), lens_v: next(), time: 0.5 });
        380.0 + 400.0 * next()
    });
    (samples, wavelengths)
}

/// Returns the largest of three differences between two rays: of the directions, of the origins relative to 100 mm, and
/// of the weights relative to their size.
fn difference((a, wa): (WorldRay, f32), (b, wb): (WorldRay, f32)) -> f64 {
    let apart = |a: [f32; 3], b: [f32; 3]| {
        a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(b)).abs()).fold(0.0, f64::max)
    };
    let weights = (f64::from(wa) - f64::from(wb)).abs() / f64::from(wb);
    apart(a.direction, b.direction).max(apart(a.origin, b.origin) / 100.0).max(weights)
}

/// Compares rays over the rear element's disk, whose samples are the same at every wavelength, with cameras built at
/// each wavelength. Returns the largest difference, the number of rays that pass only one of the two cameras, and the
/// number of rays.
fn against_cameras_of_each_wavelength(subject: &Subject, precision: Precision) -> (f64, usize, usize) {
    const N: usize = 512;
    let camera = |wavelength: f64| {
        subject.builder(wavelength).pupil(Pupil::Rear).precision(precision).build().expect("built")
    };
    let own = camera(D_LINE);
    let (samples, _) = anywhere::<N>(11);
    let (mut worst, mut only_one, mut through) = (0.0_f64, 0, 0);
    for wavelength in WAVELENGTHS {
        let there = camera(wavelength.into());
        let (mut found, mut expected) = (RayColumns::new(N), RayColumns::new(N));
        own.trace(&samples.first(N).at(&[wavelength; N]), &mut found.first(N));
        there.trace(&samples.first(N), &mut expected.first(N));
        for i in 0..N {
            match (found.get(i), expected.get(i)) {
                (Some(found), Some(expected)) => {
                    worst = worst.max(difference(found, expected));
                    through += 1;
                }
                (None, None) => {
                    let sample = samples.first(N).get(i);
                    let same = own.generate(&sample, Some(wavelength)) == there.generate(&sample, None);
                    only_one += usize::from(!same);
                }
                _ => only_one += 1,
            }
        }
    }
    (worst, only_one, through)
}

#[test]
fn rays_and_reasons_are_those_of_a_camera_at_the_wavelength() {
    let mut dispersive = 0;
    for name in catalogue::round() {
        let subject = Subject::of_catalogue(name, if name == "phone.4mm" { 5.6 } else { 36.0 }, 1.0);
        for (precision, most) in [(Precision::F64, 4e-7), (Precision::F32, 1e-5)] {
            let (worst, only_one, through) = against_cameras_of_each_wavelength(&subject, precision);
            assert!(worst < most, "{name} {precision}: {worst:e}");
            assert!(only_one <= if precision == Precision::F64 { 0 } else { 8 }, "{name}: {only_one}");
            // The telephone's rear element is so large, and so near the film, that hardly any of its samples pass.
            assert!(through > 50 || name == "phone.4mm", "{name}: {through}");
        }
        dispersive += usize::from(subject.prescription.is_dispersive());
    }
    assert!(dispersive >= 15, "{dispersive}");
}

/// Returns a lens of a few random elements with glasses of every kind that a table can state.
fn random_text(random: &mut Random) -> String {
    let elements = 1 + (4.0 * random.next()) as usize;
    let mut text = String::new();
    for element in 0..elements {
        let radius = (20.0 + 60.0 * random.next()) * if random.next() < 0.5 { 1.0 } else { -1.0 };
        let (n, v) = (1.45 + 0.5 * random.next(), 20.0 + 60.0 * random.next());
        text += &format!("{radius:.4} {:.4} {n:.5} {v:.3} 14\n", 2.0 + 4.0 * random.next());
        if random.next() < 0.4 {
            let radius = (25.0 + 60.0 * random.next()) * if random.next() < 0.5 { 1.0 } else { -1.0 };
            let (n, v) = (1.45 + 0.5 * random.next(), 20.0 + 60.0 * random.next());
            text += &format!("{radius:.4} {:.4} {n:.5} {v:.3} 14\n", 2.0 + 4.0 * random.next());
        }
        let radius = (25.0 + 80.0 * random.next()) * if random.next() < 0.5 { 1.0 } else { -1.0 };
        let last = element + 1 == elements;
        text += &format!("{radius:.4} {} - - 14\n", if last { 0.0 } else { 4.0 + 6.0 * random.next() });
        if element == 0 && !last {
            text += &format!("stop {:.4} {:.3}\n", 4.0 + 3.0 * random.next(), 6.0 + 8.0 * random.next());
        }
    }
    text
}

#[test]
fn random_lenses_have_the_rays_of_a_camera_at_the_wavelength() {
    let mut random = Random::new(2);
    let mut through = 0;
    for number in 0..40 {
        let subject = Subject::of_text(&random_text(&mut random), 30.0);
        for (precision, most) in [(Precision::F64, 4e-7), (Precision::F32, 3e-5)] {
            let (worst, only_one, passed) = against_cameras_of_each_wavelength(&subject, precision);
            assert!(worst < most, "{number} {precision}: {worst:e}\n{:?}", subject.text);
            assert!(
                only_one <= if precision == Precision::F64 { 1 } else { 12 },
                "{number} {precision}: {only_one} of {passed}\n{:?}",
                subject.text
            );
            through += passed;
        }
    }
    assert!(through > 20_000, "{through}");
}

#[test]
fn a_plate_shifts_rays_as_snells_law_has_it_at_each_wavelength() {
    // The n_e and other indices of N-BK7 are from the maker's sheet (Schott, 517642.251).
    const SHEET: [(f32, f64); 6] = [
        (404.7, 1.530_24),
        (435.8, 1.526_68),
        (486.1, 1.522_38),
        (546.1, 1.518_72),
        (587.6, 1.516_80),
        (656.3, 1.514_32),
    ];
    let plate = "0 10 1.5168 64.17 40\n0 0 - - 40\n";
    let subject = Subject::of_text(plate, 20.0);
    let camera = subject.builder(D_LINE).pupil(Pupil::Rear).build().expect("built");
    let thickness = 10.0;
    for (wavelength, index) in SHEET {
        for i in 1..20_u8 {
            let u = 0.5 + 0.02 * f32::from(i);
            let sample = Sample { image_x: 600.0, image_y: 400.0, lens_u: u, lens_v: 0.5, time: 0.5 };
            let (ray, _) = camera.ray_at(&sample, wavelength).expect("through");
            let [dx, _, dz] = ray.direction.map(f64::from);
            let inside = dx / index;
            // The path leads from the film to the plate at the slope in air, and through the plate at the refracted
            // slope.
            let exact = subject.film_distance * dx / dz + thickness * inside / (1.0 - inside * inside).sqrt();
            let off = (f64::from(ray.origin[0]) - exact).abs();
            // Two numbers reproduce the sheet's index within 2e-4.
            assert!(off < 2e-4 * thickness * dx.abs() + 2e-6, "{wavelength} nm: {off:e}");
        }
    }
}

/// Returns lens samples that are spread evenly.
fn even<const N: usize>([image_x, image_y]: [f32; 2]) -> SampleColumns {
    let mut samples = SampleColumns::new(N);
    for i in 0..N {
        let at = |step: f64| (0.5 + (i + 1) as f64 * step).fract() as f32;
        let (lens_u, lens_v) = (at(0.754_877_666_246_692_7), at(0.569_840_290_998_053_2));
        samples.set(i, &Sample { image_x, image_y, lens_u, lens_v, time: 0.5 });
    }
    samples
}

/// Returns the light that reaches a film point at a wavelength by `N` random lens samples, its standard error, and the
/// share of the samples that passes.
fn light<const N: usize>(camera: &Camera, raster: [f32; 2], wavelength: f32, seed: u64) -> [f64; 3] {
    let mut random = Random::new(seed);
    let mut samples = SampleColumns::new(N);
    for i in 0..N {
        let [lens_u, lens_v] = [random.next() as f32, random.next() as f32];
        samples.set(i, &Sample { image_x: raster[0], image_y: raster[1], lens_u, lens_v, time: 0.5 });
    }
    let mut rays = RayColumns::new(N);
    camera.trace(&samples.first(N).at(&[wavelength; N]), &mut rays.first(N));
    let [sum, squares, passed] = (0..N).fold([0.0; 3], |[sum, squares, passed], i| {
        let weight = f64::from(rays.weight(i));
        [sum + weight, squares + weight * weight, passed + f64::from(u8::from(weight > 0.0))]
    });
    let [mean, squares, passed] = [sum, squares, passed].map(|number| number / N as f64);
    [mean, ((squares - mean * mean).max(0.0) / N as f64).sqrt(), passed]
}

#[test]
fn light_at_every_wavelength_is_that_of_brute_force() {
    let cases: Vec<(usize, Subject)> = catalogue::round()
        .flat_map(|name| [(24.0, 1.0), (43.3, 0.3), (120.0, 1.0)].map(|camera| (name, camera)))
        .map(|(name, (film_diagonal, stop))| {
            let film_diagonal = if name == "phone.4mm" { 0.16 * film_diagonal } else { film_diagonal };
            Subject::of_catalogue(name, film_diagonal, stop)
        })
        .enumerate()
        .filter(|(_, subject)| subject.prescription.is_dispersive())
        .collect();
    let found = on_all_cores(&cases, |(number, subject)| against_brute_force(subject, 1000 * *number as u64));
    let points: u64 = found.iter().map(|(points, _)| points).sum();
    let worst = found.iter().map(|(_, worst)| worst).min_by(|a, b| a.0.total_cmp(&b.0));
    println!("{points} measurements; the least that get through: {worst:?}");
    assert!(points > 2000, "{points}");
}

/// Returns the number of measurements with a subject, and the least share of samples that pass, with its case; pupils
/// for which the map is given up do not count.
fn against_brute_force(subject: &Subject, seed: u64) -> (u64, (f64, String)) {
    let (mut points, mut worst) = (0, (1.0_f64, String::new()));
    let mut is_given_up = false;
    let warped = subject.builder(D_LINE).build_with_log(&mut |_, text| {
        is_given_up |= text.contains("in the pupil's place");
    });
    let warped = warped.expect("built");
    let rear = subject.builder(D_LINE).pupil(Pupil::Rear).build().expect("built");
    for wavelength in WAVELENGTHS {
        let image = subject.image_radius(wavelength.into());
        for part in [0.0, 0.4, 0.7, 0.9, 0.97, 0.99] {
            let Subject { name, film_diagonal, .. } = subject;
            let what = format!("{name}, film {film_diagonal} mm, {wavelength} nm at {part} of {image} mm");
            let raster = subject.raster(part * image);
            let [found, error, acceptance] = light::<2048>(&warped, raster, wavelength, seed + points);
            if acceptance < worst.0 && !is_given_up {
                worst = (acceptance, what.clone());
            }
            assert!(
                acceptance >= if part < 0.99 { 0.96 } else { 0.85 } || is_given_up,
                "{what}: {acceptance}"
            );
            points += 2;
            let [found, error, _] = match acceptance {
                // Too few samples pass to know the standard error.
                ..0.1 => light::<8192>(&warped, raster, wavelength, seed + points - 2),
                _ => [found, error, acceptance],
            };
            let [expected, brute, _] = light::<8192>(&rear, raster, wavelength, seed + points - 1);
            if brute >= 0.15 * expected {
                // Too few rays pass to know the standard error.
                continue;
            }
            let errors = error.hypot(brute);
            assert!(
                (found - expected).abs() <= 4.0 * errors,
                "{what}: {found:e} ± {error:e}, by brute force {expected:e} ± {brute:e}"
            );
        }
    }
    (points, worst)
}

#[test]
fn light_is_that_of_a_camera_built_at_the_wavelength() {
    // Both cameras sample the pupil, so that little noise remains.
    const N: usize = 8192;
    for name in ["dgauss.100mm", "retrofocus.24mm", "petzval.100mm", "fisheye.16mm", "phone.4mm"] {
        let diagonal = if name == "phone.4mm" { 5.6 } else { 36.0 };
        let subject = Subject::of_catalogue(name, diagonal, 1.0);
        let own = subject.builder(D_LINE).build().expect("built");
        for wavelength in WAVELENGTHS {
            let there = subject.builder(wavelength.into()).build().expect("built");
            let image = subject.image_radius(wavelength.into());
            for part in [0.0, 0.5, 0.8, 0.95] {
                let samples = even::<N>(subject.raster(part * image));
                let [light, expected] = [Some(&own), None].map(|at| {
                    let mut rays = RayColumns::new(N);
                    match at {
                        Some(own) => own.trace(&samples.first(N).at(&[wavelength; N]), &mut rays.first(N)),
                        None => there.trace(&samples.first(N), &mut rays.first(N)),
                    }
                    (0..N).map(|i| f64::from(rays.weight(i))).sum::<f64>()
                });
                let off = light / expected - 1.0;
                assert!(off.abs() < 1e-3, "{name} {wavelength} nm at {part} of {image} mm: {off:e}");
            }
        }
    }
}

#[test]
fn rays_have_the_same_bits_by_every_kind_of_request() {
    const N: usize = 301;
    for (name, precision) in [
        ("dgauss.100mm", Precision::F64),
        ("dgauss.100mm", Precision::F32),
        ("phone.4mm", Precision::F64),
        ("macro.105mm", Precision::F32),
    ] {
        for pupil in [Pupil::Warped, Pupil::Rear, Pupil::Disk] {
            let camera = Camera::builder()
                .lens_file(name)
                .precision(precision)
                .pupil(pupil)
                .weighting(Weighting::Relative);
            let camera = if name == "phone.4mm" { camera.film_diagonal(5.6) } else { camera };
            let camera = camera.resolution(SIZE[0], SIZE[1]).build().expect("built");
            let (samples, wavelengths) = anywhere::<N>(7);
            let bits = |ray: Option<(WorldRay, f32)>| {
                ray.map(|(WorldRay { origin, direction, mint, maxt, time }, weight)| {
                    let numbers = origin.into_iter().chain(direction).chain([mint, maxt, time, weight]);
                    numbers.map(f32::to_bits).collect::<Vec<u32>>()
                })
            };
            let singles: Vec<_> =
                (0..N).map(|i| bits(camera.ray_at(&samples.first(N).get(i), wavelengths[i]))).collect();
            assert!(singles.iter().flatten().count() > N / 4 || pupil != Pupil::Warped, "{name}");
            for count in [1, 2, 4, 5, 8, 31, 100, N] {
                let mut rays = RayColumns::new(N);
                camera.trace(&samples.first(count).at(&wavelengths[..count]), &mut rays.first(count));
                for (i, single) in singles.iter().enumerate().take(count) {
                    assert_eq!(&bits(rays.get(i)), single, "{name} {pupil}, {i} of {count}");
                }
            }
            for i in 0..N / 4 {
                let sample = samples.first(N).get(i);
                let four = [0, 1, 2, 3].map(|k| wavelengths[4 * i + k]);
                let mut hero = RayColumns::new(4);
                camera.trace(&Samples::of(&sample).at(&four), &mut hero.all());
                for (k, wavelength) in four.into_iter().enumerate() {
                    let alone = camera.ray_at(&sample, wavelength);
                    assert_eq!(bits(hero.get(k)), bits(alone), "{name} {pupil} hero");
                }
            }
        }
    }
}

#[test]
fn at_the_cameras_own_wavelength_the_rays_are_its_own() {
    const N: usize = 400;
    for wavelength in [400.0_f32, 632.8] {
        for precision in [Precision::F64, Precision::F32] {
            let camera = Camera::builder().lens_file("dgauss.100mm").wavelength(wavelength);
            let camera = camera.pupil(Pupil::Rear).precision(precision).resolution(SIZE[0], SIZE[1]).build();
            let camera = camera.expect("built");
            let (samples, _) = anywhere::<N>(3);
            let (mut own, mut at) = (RayColumns::new(N), RayColumns::new(N));
            camera.trace(&samples.first(N), &mut own.first(N));
            camera.trace(&samples.first(N).at(&[wavelength; N]), &mut at.first(N));
            for (own, at) in (0..N).filter_map(|i| own.get(i).zip(at.get(i))) {
                assert!(difference(own, at) < 3e-6, "{own:?} {at:?}");
            }
        }
    }
}

#[test]
fn without_dispersion_every_wavelength_has_the_same_bits() {
    const N: usize = 200;
    let none = Subject::of_catalogue("dgauss.50mm", 35.0, 1.0);
    assert!(!none.prescription.is_dispersive());
    for camera in [
        none.builder(D_LINE).build(),
        Camera::builder()
            .lens_file("dgauss.100mm")
            .model(::realistic_camera::Model::Thin)
            .resolution(SIZE[0], SIZE[1])
            .build(),
    ] {
        let camera = camera.expect("built");
        let (samples, mut wavelengths) = anywhere::<N>(9);
        let (mut own, mut at) = (RayColumns::new(N), RayColumns::new(N));
        camera.trace(&samples.first(N), &mut own.first(N));
        camera.trace(&samples.first(N).at(&wavelengths), &mut at.first(N));
        assert!((0..N).all(|i| own.get(i) == at.get(i)));
        wavelengths[17] = 379.9;
        wavelengths[18] = f32::NAN;
        camera.trace(&samples.first(N).at(&wavelengths), &mut at.first(N));
        for i in 0..N {
            let expected = if i == 17 || i == 18 { None } else { own.get(i) };
            assert_eq!(at.get(i), expected);
        }
    }
}

#[test]
fn any_bits_as_a_wavelength_make_a_sound_ray_or_none() {
    const N: usize = 4096;
    let mut random = Random::new(31);
    let strange = [
        f32::NAN,
        f32::INFINITY,
        -f32::INFINITY,
        0.0,
        -0.0,
        -500.0,
        f32::MIN_POSITIVE,
        1e-42,
        f32::MAX,
        167.3,
        379.999_97,
        380.0,
        780.0,
        780.000_1,
    ];
    for (name, precision) in
        [("dgauss.100mm", Precision::F64), ("phone.4mm", Precision::F32), ("zoom.24-70mm", Precision::F32)]
    {
        let camera = Camera::builder().lens_file(name).precision(precision).resolution(SIZE[0], SIZE[1]);
        let camera = if name == "phone.4mm" { camera.film_diagonal(5.6) } else { camera };
        let camera = camera.build().expect("built");
        let (samples, mut wavelengths) = anywhere::<N>(4);
        for (i, wavelength) in wavelengths.iter_mut().enumerate() {
            match (strange.get(i), i % 3) {
                (Some(strange), _) => *wavelength = *strange,
                (None, 0) => *wavelength = f32::from_bits((random.next() * 4_294_967_296.0) as u32),
                _ => {}
            }
        }
        let mut rays = RayColumns::new(N);
        camera.trace(&samples.first(N).at(&wavelengths), &mut rays.first(N));
        let mut sound = 0;
        for (i, wavelength) in wavelengths.into_iter().enumerate() {
            let outcome = camera.generate(&samples.first(N).get(i), Some(wavelength));
            let Some((ray, weight)) = rays.get(i) else {
                assert!(!matches!(outcome, Outcome::Ray(..)), "{wavelength}");
                continue;
            };
            assert_eq!(outcome, Outcome::Ray(ray, weight));
            assert!((380.0..=780.0).contains(&wavelength), "{wavelength}");
            let length: f32 = ray.direction.iter().map(|part| part * part).sum();
            assert!((length - 1.0).abs() < 1e-6 && ray.origin.iter().all(|part| part.is_finite()));
            assert!(weight > 0.0 && weight.is_finite());
            sound += 1;
        }
        assert!(sound > N / 8, "{name}: {sound}");
        assert_eq!(camera.generate(&samples.first(N).get(0), Some(f32::NAN)), Outcome::Wavelength);
    }
}

#[test]
fn what_a_weighting_divides_by_is_the_same_at_every_wavelength() {
    let sample = Sample { image_x: 600.0, image_y: 400.0, lens_u: 0.6, lens_v: 0.5, time: 0.5 };
    let weights = |weighting| {
        let camera =
            Camera::builder().lens_file("dgauss.100mm").weighting(weighting).resolution(SIZE[0], SIZE[1]);
        let camera = camera.build().expect("built");
        [400.0, 550.0, 700.0].map(|wavelength| f64::from(camera.ray_at(&sample, wavelength).expect("lit").1))
    };
    let [a, b, c] = weights(Weighting::Radiometric);
    for weighting in [Weighting::Assignment, Weighting::Relative] {
        let [x, y, z] = weights(weighting);
        for (ratio, expected) in [(x / y, a / b), (z / y, c / b)] {
            assert!((ratio / expected - 1.0).abs() < 1e-6, "{weighting}");
        }
    }
    assert_eq!(weights(Weighting::None), [1.0; 3]);
    // The mean on the axis is 1 at the camera's own wavelength, and near 1 elsewhere.
    assert!(weights(Weighting::Relative).iter().all(|weight| (weight - 1.0).abs() < FRAC_PI_4 / 10.0));
}

#[test]
fn light_near_the_images_end_is_right_at_every_wavelength() {
    // Every image ends on film of 120 mm, the phone's image on a sixth of that; wavelengths between those of the tables
    // are included. Fisheyes are excluded: in the last hundredth of their images, both cameras give up the map.
    const N: usize = 4096;
    let subjects: Vec<Subject> = catalogue::round()
        .filter(|name| !name.starts_with("fisheye"))
        .map(|name| Subject::of_catalogue(name, if name == "phone.4mm" { 19.2 } else { 120.0 }, 1.0))
        .filter(|subject| subject.prescription.is_dispersive())
        .collect();
    let found = on_all_cores(&subjects, |subject| {
        let (mut count, mut worst, mut least) = (0, 0.0_f64, 1.0_f64);
        let own = subject.builder(D_LINE).build().expect("built");
        for wavelength in (380..=780_u16).step_by(25).map(f32::from) {
            let there = subject.builder(wavelength.into()).build().expect("built");
            let image = subject.image_radius(wavelength.into());
            // The last hundredth has less than a thousandth of the axis's irradiance: bounds are relative to the
            // irradiance there.
            for (part, enough, most) in [(0.97, 0.96, 4e-3), (0.99, 0.85, 8e-3), (0.999, 0.5, 6e-3)] {
                let samples = even::<N>(subject.raster(part * image));
                let mut rays = RayColumns::new(N);
                there.trace(&samples.first(N), &mut rays.first(N));
                let expected: f64 = (0..N).map(|i| f64::from(rays.weight(i))).sum();
                own.trace(&samples.first(N).at(&[wavelength; N]), &mut rays.first(N));
                let light: f64 = (0..N).map(|i| f64::from(rays.weight(i))).sum();
                let passing = (0..N).filter(|&i| rays.weight(i) > 0.0).count() as f64 / N as f64;
                let off = (light / expected - 1.0).abs();
                let what = format!("{}, {wavelength} nm at {part} of {image} mm", subject.name);
                assert!(off < most, "{what}: off by {off:e}");
                assert!(passing > enough, "{what}: {passing} pass");
                (count, worst, least) = (count + 1, worst.max(off), least.min(passing));
            }
        }
        (count, worst, least)
    });
    let all = |(count, worst, least): (u32, f64, f64), own: (u32, f64, f64)| {
        (count + own.0, worst.max(own.1), least.min(own.2))
    };
    let (count, worst, least) = found.into_iter().fold((0, 0.0, 1.0), all);
    println!("{count} places; off by at most {worst:.1e}, at least {least} pass");
    assert!(count > 700, "{count}");
}
