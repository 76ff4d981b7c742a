//! Weights of cameras between media: irradiance by closed forms and by brute force, light, and wavelengths.

use std::f64::consts::PI;

use super::{EYE, FISHEYE, IMMERSED, near};
use crate::support::{Random, build, host_with, lens_of, ray, sample};
use ::realistic_camera::{Camera, Outcome};
use realistic_light::{LitPath, Surfaces};
use realistic_optics::{
    imaging::irradiance::on_axis,
    lens::{Lens, film_ray},
    prescription::{Coating, SurfaceCoating},
    trace::{Path, Ray},
};

/// Builds a camera for the text of a lens.
pub(super) fn camera(text: &str, given: &[(&str, &str)]) -> Camera {
    build(&host_with(text), given).unwrap_or_else(|error| panic!("{given:?}: {error}\n{text}")).0
}

/// Returns the mean weight of a grid of lens samples at a raster point.
fn mean_weight(camera: &Camera, image: [f32; 2], side: u16) -> f64 {
    let at = |i: u16| (f32::from(i) + 0.5) / f32::from(side);
    let grid = (0..side).flat_map(|i| (0..side).map(move |j| [at(i), at(j)]));
    let sum: f64 =
        grid.filter_map(|lens| ray(camera, image, lens)).map(|(_, weight)| f64::from(weight)).sum();
    sum / f64::from(side).powi(2)
}

const MIDDLE: [f32; 2] = [200.0, 150.0];

#[test]
fn a_plane_interface_lets_all_of_a_uniform_sky_to_the_film() {
    for (pupil, tolerance) in [("warped", 2e-3), ("rear", 0.02)] {
        let given = [("film_distance", "1"), ("film_diagonal", "0.1"), ("pupil", pupil)];
        let mean = |text: &str| mean_weight(&camera(text, &given), MIDDLE, 300);
        // A film in a denser medium sees the sky within the critical angle: E = π L.
        for index in ["1.1", "1.336", "1.9"] {
            near(mean(&format!("0 1 {index} 8\n")) / PI, 1.0, tolerance);
        }
        // A film in air sees water in the half space, but for the plane's edge: E = π L/n² · 4²/(4² + 1).
        let seen = 16.0 / 17.0 / 1.33306_f64.powi(2);
        near(mean("medium 1.33306\n0 1 1 8\n") / (PI * seen), 1.0, tolerance);
    }
}

/// Returns the film irradiance for unit radiance at the distance `height` from the axis, by brute force over slopes.
fn irradiance(lens: &Lens, film: f64, height: f64) -> f64 {
    const SIDE: u32 = 700;
    let path = Path::<f64>::film_to_scene(lens);
    let rear = lens.rear();
    let reach = 1.05 * (rear.semi_diameter + height) / (rear.vertex + rear.sagitta_range()[0] - film);
    let step = 2.0 * reach / f64::from(SIDE);
    let at = |i: u32| (f64::from(i) + 0.5) * step - reach;
    let mut sum = 0.0;
    for [sx, sy] in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| [at(i), at(j)])) {
        if path.trace(film_ray([height, 0.0], film, [sx, sy])).is_ok() {
            sum += step * step / (1.0 + sx * sx + sy * sy).powi(2);
        }
    }
    sum * (rear.n_film / lens.front().n_scene).powi(2)
}

#[test]
fn mean_weights_are_the_irradiance_by_brute_force() {
    for (text, film, diagonal) in [(EYE, 16.32, 8.0), (FISHEYE, 39.34, 20.0), (IMMERSED, 64.7, 30.0)] {
        let lens = lens_of(text);
        let z = lens.rear().vertex - film;
        let (distance, size) = (film.to_string(), diagonal.to_string());
        let given = [("film_distance", &*distance), ("film_diagonal", &size)];
        let with = |more: &[(&str, &str)]| camera(text, &[&given[..], more].concat());
        let axis = on_axis(&Path::<f64>::film_to_scene(&lens), z, 2.0) * lens.radiance_factor();
        for precision in ["f64", "f32"] {
            let own = with(&[("precision", precision)]);
            let relative = with(&[("precision", precision), ("weighting", "relative")]);
            for right in [0.0_f32, 100.0] {
                let exact = irradiance(&lens, z, f64::from(right) * diagonal / 500.0);
                let image = [200.0 + right, 150.0];
                near(mean_weight(&own, image, 128) / exact, 1.0, 3e-3);
                // Relative weights are divided by the same light on the axis.
                near(mean_weight(&relative, image, 128) * axis / exact, 1.0, 3e-3);
            }
        }
        // On the axis the ideal lenses have the light of the exact one: E = π L/(4 n² N²).
        for model in ["lens", "thick", "thin"] {
            let found = mean_weight(&with(&[("model", model), ("fnumber", "16")]), MIDDLE, 64);
            let exact = PI / (4.0 * (16.0 * lens.front().n_scene).powi(2));
            eprintln!("{model}: {}", found / exact);
            near(found / exact, 1.0, 0.02);
        }
    }
}

#[test]
fn weights_of_a_scaled_lens_are_the_same() {
    let weights = |factor: f64| -> Vec<f32> {
        let scaled = |word: &str| word.parse().map_or(word.to_owned(), |x: f64| (x * factor).to_string());
        let line = |line: &str| match line.split(' ').collect::<Vec<_>>()[..] {
            [radius, thickness, index, diameter] => {
                format!("{} {} {index} {}\n", scaled(radius), scaled(thickness), scaled(diameter))
            }
            _ => format!("{line}\n"),
        };
        let diagonal = scaled("8");
        let camera = camera(&EYE.lines().map(line).collect::<String>(), &[("film_diagonal", &diagonal)]);
        let at = |i: u8| ([180.0 + f32::from(i), 140.0], [0.3, 0.02 * f32::from(i)]);
        (0..50).filter_map(|i| ray(&camera, at(i).0, at(i).1)).map(|(_, weight)| weight).collect()
    };
    let [small, large] = [1.0, 8.0].map(weights);
    assert!(small.len() > 40 && small.len() == large.len());
    // The numbers of the text round.
    assert!(small.iter().zip(&large).all(|(a, b)| (a / b - 1.0).abs() < 1e-5), "{small:?} {large:?}");
}

/// Returns random raster points and lens samples.
pub(super) fn anywhere(seed: u64, count: usize) -> Vec<([f32; 2], [f32; 2])> {
    let mut random = Random::new(seed);
    let mut next = || random.next() as f32;
    (0..count).map(|_| ([400.0 * next(), 300.0 * next()], [next(), next()])).collect()
}

const WIDE: [(&str, &str); 3] = [("film_diagonal", "30"), ("film_distance", "64.7"), ("pupil", "rear")];

#[test]
fn rays_at_wavelengths_are_those_of_a_camera_at_the_wavelength() {
    let text = IMMERSED;
    for (precision, most) in [("f64", 5e-7), ("f32", 2e-5)] {
        for transmission in ["none", "bare", "three-layer"] {
            let more = [("precision", precision), ("transmission", transmission)];
            let at = |wavelength| camera(text, &[&WIDE[..], &more, &[("wavelength", wavelength)]].concat());
            let own = at("587.56");
            for wavelength in ["400", "486.13", "587.56", "700"] {
                let (there, nm) = (at(wavelength), wavelength.parse::<f32>().expect("a number"));
                let (mut worst, mut passed, mut differ) = (0.0_f64, 0, 0);
                for (image, lens) in anywhere(63, 1000) {
                    let sample = sample(image, lens);
                    match (own.generate(&sample, Some(nm)), there.generate(&sample, None)) {
                        (Outcome::Ray(a, weight), Outcome::Ray(b, expected)) => {
                            let apart = |a: [f32; 3], b: [f32; 3]| {
                                (0..3).map(|i| f64::from((a[i] - b[i]).abs())).fold(0.0, f64::max)
                            };
                            worst = worst.max(apart(a.direction, b.direction));
                            worst = worst.max(apart(a.origin, b.origin) / 100.0);
                            // Transmission is carried in single precision, and coatings are fitted.
                            near(f64::from(weight / expected), 1.0, 2e-4);
                            passed += 1;
                        }
                        (Outcome::Ray(..), _) | (_, Outcome::Ray(..)) => differ += 1,
                        _ => {}
                    }
                }
                assert!(
                    worst < most && passed > 100 && differ <= 2,
                    "{precision} {transmission} {wavelength}: {worst:e} {passed} {differ}"
                );
            }
        }
    }
}

#[test]
fn carried_light_is_that_of_the_exact_path() {
    let text = IMMERSED;
    let lens = lens_of(text);
    for coating in [Coating::Bare, Coating::QuarterWave, Coating::ThreeLayer] {
        let plain = camera(text, &WIDE);
        let lit = camera(text, &[&WIDE[..], &[("transmission", coating.name())]].concat());
        let surfaces = Surfaces::new(&lens, SurfaceCoating::from(coating));
        let path = LitPath::new(Path::scene_to_film(&lens), &surfaces);
        let mut passed = 0;
        for (image, at) in anywhere(64, 1000) {
            let (Some((ray, weight)), Some((_, left))) = (ray(&plain, image, at), ray(&lit, image, at))
            else {
                continue;
            };
            let direction = ray.direction.map(|part| -f64::from(part));
            let origin = std::array::from_fn(|axis| f64::from(ray.origin[axis]) - 1e-3 * direction[axis]);
            // Rounding of the origin may block the ray at an edge.
            let Ok((_, share)) = path.trace(Ray { origin, direction }) else { continue };
            near(f64::from(left / weight), share, 1e-4);
            passed += 1;
        }
        assert!(passed > 100, "{passed}");
    }
}
