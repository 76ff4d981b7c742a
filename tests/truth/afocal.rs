//! Lenses without a focal length: an empty aperture (pinhole), a plate and a telescope. They cannot focus; they take
//! pictures with the film at a given distance.

use super::support;

use std::f64::consts::PI;

use ::realistic_camera::{Camera, Parameters};
use support::{Random, build, host_with, ray, sample};

const PINHOLE: &str = "0 0 1 0.3\n";
const PLATE: &str = "inf 5 1.5 8\ninf 0 1 8\n";
const AFOCAL: [(&str, &str); 2] = [("a pinhole", PINHOLE), ("a plate", PLATE)];

fn camera(text: &str, more: &[(&str, &str)]) -> Camera {
    let given = [&[("film_distance", "30")], more].concat();
    build(&host_with(text), &given).unwrap_or_else(|error| panic!("{given:?}: {error}")).0
}

#[test]
fn rays_through_a_pinhole_are_straight() {
    for pupil in ["warped", "rear", "disk"] {
        let camera = camera(PINHOLE, &[("pupil", pupil)]);
        let mut random = Random::new(1);
        for _ in 0..500 {
            let image = [random.next() * 400.0, random.next() * 300.0].map(|x| x as f32);
            let lens = [random.next(), random.next()].map(|x| x as f32);
            let Some((ray, _)) = ray(&camera, image, lens) else { continue };
            let [x, y] = camera.facts().expect("a lens").film.point(image[0].into(), image[1].into());
            let [ox, oy, oz] = ray.origin.map(f64::from);
            let [dx, dy, dz] = ray.direction.map(f64::from);
            assert!(oz.abs() < 1e-9 && ox.hypot(oy) <= 0.15 * (1.0 + 1e-6), "{pupil}: {ray:?}");
            let (back_x, back_y) = (ox - 30.0 * dx / dz, oy - 30.0 * dy / dz);
            assert!((back_x - x).hypot(back_y - y) < 2e-5, "{pupil} {image:?}: {ray:?}");
        }
    }
}

#[test]
fn a_pinholes_irradiance_is_the_solid_angles() {
    for pupil in ["warped", "rear", "disk"] {
        let camera = camera(PINHOLE, &[("pupil", pupil)]);
        for image in [[200.0, 150.0], [0.0, 0.0], [400.0, 150.0]] {
            let [x, y] = camera.facts().expect("a lens").film.point(f64::from(image[0]), f64::from(image[1]));
            let cos2 = 900.0 / (900.0 + x * x + y * y);
            let expected = PI * 0.15 * 0.15 / 900.0 * cos2 * cos2;
            let side = 64_u8;
            let position = |i: u8| (f32::from(i) + 0.5) / f32::from(side);
            let mean = (0..side)
                .flat_map(|i| (0..side).map(move |j| [position(i), position(j)]))
                .filter_map(|lens| ray(&camera, image, lens))
                .map(|(_, weight)| f64::from(weight))
                .sum::<f64>()
                / f64::from(side).powi(2);
            assert!((mean / expected - 1.0).abs() < 2e-3, "{pupil} {image:?}: {mean} is not {expected}");
        }
    }
}

#[test]
fn every_choice_works_without_a_focal_length() {
    for (name, text) in AFOCAL {
        for given in [
            &[("refraction", "heckbert")][..],
            &[("precision", "f32")],
            &[("tolerance", "0.1")],
            &[("weighting", "relative")],
            &[("weighting", "assignment")],
        ] {
            let camera = camera(text, given);
            assert!(
                camera.facts().expect("a lens").focal_length().is_infinite()
                    && camera.facts().expect("a lens").fnumber().is_infinite()
            );
            assert_eq!(camera.facts().expect("a lens").focus_distance_mm, None);
            assert!(ray(&camera, [200.0, 150.0], [0.5, 0.5]).is_some(), "{name} {given:?}");
            // This is the result of a blocked ray in a pbrt host.
            let out_of_range = sample([9000.0, 150.0], [0.5, 0.5]);
            let direction = camera.substitute(&out_of_range).direction;
            assert!(
                (direction.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-5,
                "{name}: {direction:?}"
            );
        }
    }
}

#[test]
fn without_a_film_distance_the_message_says_to_give_one() {
    let diverging = "-50 2 1.5 20\n50 0 1 20\n";
    for (name, text) in AFOCAL.into_iter().chain([("a diverging lens", diverging)]) {
        for given in [&[][..], &[("focus_distance", "1000")]] {
            let error = build(&host_with(text), given).expect_err(name);
            assert!(error.contains("\"film_distance\""), "{name}: {error}");
        }
    }
    // A thick lens requires a focal length, whatever else is given.
    for model in ["thick", "thin"] {
        for given in [&[][..], &[("film_distance", "30")]] {
            let mut parameters = Parameters::default();
            for (name, value) in [("model", model)].iter().chain(given) {
                parameters.set_from_text(name, value).expect("valid");
            }
            let error = Camera::build(&parameters, &host_with(PINHOLE), &mut |_, _| {}).expect_err(model);
            assert!(
                error.to_string().contains("afocal") && !error.to_string().contains("film_distance"),
                "{error}"
            );
        }
    }
}
