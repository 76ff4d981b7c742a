//! Samples whose values are NaN, or beyond every range.

use super::support;

use crate::support::columns::{RayColumns, SampleColumns};
use ::realistic_camera::{Camera, CameraToWorld, Host, Level, Outcome, Parameters, Sample, WorldRay};
use support::{Random, host, host_with};

#[path = "../../fuzz/bodies/any_parameters.rs"]
mod any_parameters;

#[test]
fn numbers_that_are_none_make_no_ray_of_any_model() {
    for model in ["lens", "thick", "thin", "perspective", "orthographic", "environment"] {
        for more in [None, Some(("lens_radius", "2"))] {
            let mut parameters = Parameters::default();
            for (name, value) in [("model", model)].into_iter().chain(more) {
                parameters.set_from_text(name, value).expect("valid");
            }
            let camera = Camera::build(&parameters, &host(), &mut |_, _| {}).expect(model);
            let whole = Sample { image_x: 200.0, image_y: 150.0, lens_u: 0.5, lens_v: 0.5, time: 0.5 };
            assert!(matches!(camera.generate(&whole, None), Outcome::Ray(..)), "{model}");
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38] {
                for sample in [
                    Sample { image_x: bad, ..whole },
                    Sample { image_y: bad, ..whole },
                    Sample { lens_u: bad, ..whole },
                    Sample { lens_v: bad, ..whole },
                    Sample { time: bad, ..whole },
                ] {
                    let found = camera.ray(&sample);
                    assert_eq!(found.is_some(), matches!(camera.generate(&sample, None), Outcome::Ray(..)));
                    let Some((ray, weight)) = found else { continue };
                    let square: f32 = ray.direction.iter().map(|x| x * x).sum();
                    assert!((square - 1.0).abs() < 1e-5 && weight > 0.0, "{model} {sample:?}: {ray:?}");
                    assert!(ray.origin.iter().all(|x| x.is_finite()), "{model} {sample:?}: {ray:?}");
                    assert!((0.0..=1.0).contains(&ray.time), "{model} {sample:?}: {ray:?}");
                }
            }
        }
    }
}

/// Returns any bits.
fn any_bits(random: &mut Random) -> f32 {
    f32::from_bits((random.next() * 2_f64.powi(32)) as u32)
}

/// Returns a sample in or around the picture, far outside it, or of any bits.
fn any_sample(random: &mut Random) -> Sample {
    let far = if random.next() < 0.2 { 10_f64.powf(30.0 * random.next()) } else { 1.0 };
    let numbers = [400.0 * far, 300.0 * far, 1.0, 1.0, 1.0].map(|scale| {
        let number = (scale * (1.2 * random.next() - 0.1)) as f32;
        if random.next() < 0.05 { any_bits(random) } else { number }
    });
    let [image_x, image_y, lens_u, lens_v, time] = numbers;
    Sample { image_x, image_y, lens_u, lens_v, time }
}

/// Returns any size between two powers of ten.
fn size(random: &mut Random, from: f64, to: f64) -> f64 {
    10_f64.powf(from + (to - from) * random.next())
}

/// Returns the text of a lens of up to seven surfaces of any size and index, which may be invalid.
fn any_lens(random: &mut Random) -> String {
    let scale = if random.next() < 0.3 { size(random, -20.0, 30.0) } else { 1.0 };
    let count = 1 + (6.0 * random.next()) as usize;
    let mut text = String::new();
    for row in 0..=count {
        let semi = scale * size(random, 0.3, 1.3);
        let radius = if random.next() < 0.15 {
            0.0
        } else {
            semi * size(random, 0.03, 3.0) * random.signed().signum()
        };
        let index = match random.next() {
            _ if row == count => 1.0,
            high if high < 0.05 => size(random, 0.5, 3.0),
            air if air < 0.5 => 1.0,
            _ => 1.3 + 0.7 * random.next(),
        };
        let thickness = scale * size(random, -1.0, 1.0);
        text += &format!("{radius:e} {thickness:e} {index} {:e}\n", 2.0 * semi);
    }
    text
}

/// Returns parameters that are sometimes far from ordinary, and film at a distance at which most lenses form
/// an image.
fn any_parameters(random: &mut Random) -> Vec<(&'static str, String)> {
    let mut given = any_parameters::any_parameters(&mut || random.next());
    if random.next() < 0.6
        && !given.iter().any(|(name, _)| ["film_distance", "focus_distance"].contains(name))
    {
        given.push(("film_distance", size(random, 0.0, 2.0).to_string()));
    }
    given
}

/// Returns a transform whose axes may be rotated, mirrored, sheared and of very different sizes.
fn any_transform(random: &mut Random) -> Option<CameraToWorld> {
    let scale = if random.next() < 0.3 { size(random, -14.0, 14.0) } else { 1.0 };
    let uneven = if random.next() < 0.3 { 12.0 } else { 0.2 };
    let mut rows = [0.0_f32; 16];
    for (i, entry) in rows[..12].iter_mut().enumerate() {
        let stretch = if i % 4 == 3 { 1e3 } else { size(random, -uneven, 0.0) };
        *entry = (scale * stretch * random.signed()) as f32;
    }
    rows[15] = 1.0;
    CameraToWorld::from_rows(&rows).ok()
}

/// Checks the promises that a host is given for a ray.
fn assert_sound(ray: &WorldRay, weight: f32, of: &dyn std::fmt::Debug) {
    let length = ray.direction.iter().map(|&part| f64::from(part).powi(2)).sum::<f64>().sqrt();
    assert!((length - 1.0).abs() < 1e-6, "length {length}: {ray:?} {of:?}");
    assert!(ray.origin.iter().all(|part| part.is_finite()) && ray.time.is_finite(), "{ray:?} {of:?}");
    assert!(ray.mint.is_finite() && ray.mint <= ray.maxt, "{ray:?} {of:?}");
    assert!(weight > 0.0 && weight.is_finite(), "weight {weight}: {ray:?} {of:?}");
}

#[test]
fn any_bits_give_any_camera_a_sound_ray_or_none() {
    const CAMERAS: usize = 1500;
    const SAMPLES: usize = 200;
    let mut random = Random::new(11);
    let (mut built, mut passed) = (0, 0);
    for _ in 0..CAMERAS {
        let given = any_parameters(&mut random);
        let mut host = match random.next() {
            listed if listed < 0.3 => host(),
            _ => host_with(&any_lens(&mut random)),
        };
        if random.next() < 0.3
            && let Some(to_world) = any_transform(&mut random)
        {
            host.to_world = to_world.into();
        }
        let mut parameters = Parameters::default();
        for (name, text) in &given {
            parameters.set_from_text(name, text).expect("a parameter");
        }
        let Ok(camera) = Camera::build(&parameters, &host, &mut |_, _| {}) else { continue };
        built += 1;
        let (mut samples, mut rays) = (SampleColumns::new(SAMPLES), RayColumns::new(SAMPLES));
        for i in 0..SAMPLES {
            samples.set(i, &any_sample(&mut random));
        }
        camera.trace(&samples.first(SAMPLES), &mut rays.first(SAMPLES));
        for i in 0..SAMPLES {
            let sample = samples.first(SAMPLES).get(i);
            let of = (&sample, &given, &host.lens_text, &host.to_world);
            let found = camera.ray(&sample);
            // With a tolerance, batches may use another model.
            if !(parameters.tolerance > Some(0.0)) {
                assert_eq!(found, rays.get(i), "one and many {of:?}");
            }
            if let Some((ray, weight)) = found {
                assert_sound(&ray, weight, &of);
                passed += 1;
            }
            // The pbrt-v1 vtable gives this ray a weight, too.
            assert_sound(&camera.substitute(&sample), f32::MIN_POSITIVE, &of);
        }
    }
    assert!(built > CAMERAS / 4 && passed > built * SAMPLES / 10, "{built} cameras, {passed} rays");
}

#[test]
fn far_film_points_give_stock_cameras_sound_rays_or_none() {
    let samples: Vec<Sample> = (0..120)
        .flat_map(|exponent| [1.9, -1.9].map(|far| far * 2_f32.powi(exponent)))
        .flat_map(|far| [[far, 50.0], [70.0, far], [far, far]])
        .map(|image| support::sample(image, [1.0, 0.3]))
        .collect();
    for model in ["perspective", "orthographic", "environment"] {
        let mut passed = 0;
        for radius in ["0", "1e-20", "0.3", "1e6", "1e15"] {
            for focus in ["0.5", "7", "1e5", "1e9", "1e30"] {
                for (hither, scale) in [("1e-3", 1.0), ("0.25", 1e14), ("0.25", 1e-14), ("1e38", 1e14)] {
                    let to_world = CameraToWorld::from_rows(&[
                        scale, 0.0, 0.0, 3.0, 0.0, -scale, 0.0, 4.0, 0.0, 0.0, scale, 5.0, 0.0, 0.0, 0.0, 1.0,
                    ]);
                    let host = Host { to_world: to_world.expect("affine").into(), ..host() };
                    let mut given = vec![("model", model), ("hither", hither), ("yon", "3e38")];
                    if model != "environment" {
                        given.extend([("lens_radius", radius), ("focal_distance", focus)]);
                    }
                    let mut parameters = Parameters::default();
                    for (name, text) in &given {
                        parameters.set_from_text(name, text).expect("a parameter");
                    }
                    // A plane of focus in front of the near plane is refused.
                    let Ok(camera) = Camera::build(&parameters, &host, &mut |_, _| {}) else { continue };
                    for sample in &samples {
                        if let Some((ray, weight)) = camera.ray(sample) {
                            assert_sound(&ray, weight, &(sample, &given, scale));
                            passed += 1;
                        }
                    }
                }
            }
        }
        assert!(passed > 1000, "{model}: {passed}");
    }
}

#[test]
fn what_is_not_representable_is_refused_or_blocked() {
    let refused = |given: &[(&str, &str)]| support::build(&host(), given).expect_err("refused");
    let far = refused(&[("lens_file", "dgauss.50mm@1e150mm"), ("film_diagonal", "1e149")]);
    assert!(far.contains("not representable") && far.contains("mm_per_unit"), "{far}");
    let far =
        refused(&[("lens_file", "dgauss.50mm@1e9mm"), ("film_diagonal", "1e8"), ("mm_per_unit", "1e-15")]);
    assert!(far.contains("units of camera space"), "{far}");
    // An index of 78 gives directions in single precision that are not unit vectors.
    let diamond = host_with("20 5 78 10\n-20 30 1 10");
    let given = [("precision", "f32"), ("film_distance", "30")];
    let (camera, _) = support::build(&diamond, &given).expect("built, with a warning");
    let mut random = Random::new(3);
    let mut passed = 0;
    for _ in 0..20_000 {
        let sample = support::sample(
            [400.0, 300.0].map(|side| (side * random.next()) as f32),
            [random.next() as f32, random.next() as f32],
        );
        if let Some((ray, weight)) = camera.ray(&sample) {
            assert_sound(&ray, weight, &sample);
            passed += 1;
        }
    }
    assert!(passed > 10_000, "{passed}");
    // Film points lie 3e9 pictures away, and look through a plane-parallel front.
    let plate = host_with(
        "-3674.57 1.74089 1.42 19.6531\n0 0.16657 1 8.02708\n0 3.27299 1.552 5.75938\n31.5972 1 1 10.5482",
    );
    let given = [("pupil", "disk"), ("film_distance", "30")];
    let (camera, _) = support::build(&plate, &given).expect("built, with a warning");
    for _ in 0..200_000 {
        let image = [400.0, 300.0].map(|side| (3e9 * side * random.signed()) as f32);
        let sample = support::sample(image, [random.next() as f32, random.next() as f32]);
        if let Some((ray, weight)) = camera.ray(&sample) {
            assert_sound(&ray, weight, &sample);
        }
    }
}

#[test]
fn a_camera_that_no_ray_passes_says_so() {
    // A stop of a micrometre lies in front of a lens of 20 mm, all of which is sampled.
    let dark = host_with("0 30 1 1e-3\n30 5 1.5 20\n-30 30 1 20");
    let given = [("film_distance", "30"), ("pupil", "rear")];
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).expect("a parameter");
    }
    let mut messages = Vec::new();
    Camera::build(&parameters, &dark, &mut |level, text| messages.push((level, text.to_owned())))
        .expect("built");
    let warned = |(level, text): &(Level, String)| {
        *level == Level::Warning && text.contains("no ray gets through") && text.contains("clipped")
    };
    assert!(messages.iter().any(warned), "{messages:?}");
}
