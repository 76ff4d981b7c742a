//! Parameters have their documented effects, and wrong ones give errors that say what to give
//! instead.

use super::support;

use std::f64::consts::PI;

use ::realistic_camera::{Camera, CameraToWorld, Host, Outcome, Parameters, Sample, Value};
use realistic_optics::{
    imaging::axial_beam::AxialBeam,
    lens::{Lens, first_order::FirstOrder},
    prescription::catalogue,
    trace::{Path, Ray},
};
use support::{LENSES, RASTER, Random, build, camera, host, host_with, lens, ray, sample};

#[track_caller]
fn refused(given: &[(&str, &str)], words: &[&str]) {
    refused_by(&host(), given, words);
}

#[track_caller]
fn refused_by(host: &Host, given: &[(&str, &str)], words: &[&str]) {
    let message = build(host, given).err().unwrap_or_else(|| panic!("{given:?} builds a camera"));
    for word in words {
        assert!(message.contains(word), "{given:?}: no {word:?} in: {message}");
    }
}

#[test]
fn a_value_out_of_range_is_reported_with_its_parameter_and_range() {
    for (name, unit) in [
        ("film_distance", "mm"),
        ("film_diagonal", "mm"),
        ("aperture_diameter", "mm"),
        ("mm_per_unit", "1e30 mm"),
        ("fnumber", ""),
    ] {
        for value in ["0", "-1", "inf", "-inf"] {
            refused(&[(name, value)], &[&format!("\"{name}\" is {value}"), "must be positive", unit]);
        }
    }
    for name in
        ::realistic_camera::PARAMETERS.iter().filter(|row| row.kind == ::realistic_camera::Kind::Float)
    {
        refused(&[(name.name, "nan")], &[&format!("\"{}\"", name.name), "not a number"]);
        refused(&[(name.name, "wide")], &[&format!("\"{}\" takes a number", name.name), "\"wide\""]);
    }
    refused(&[("tolerance", "-1e-300")], &["\"tolerance\" is -1e-300;"]);
    refused(&[("focus_distance", "0")], &["\"focus_distance\" is 0", "positive, in units of camera space"]);
    refused(&[("focus_distance", "-5")], &["\"focus_distance\" is -5"]);
    refused(&[("hither", "-1")], &["\"hither\" is -1", "0 or more"]);
    refused(&[("hither", "5"), ("yon", "4")], &["\"yon\" is 4", "at least \"hither\", which is 5"]);
    refused(&[("wavelength", "100")], &["\"wavelength\" is 100", "200", "2000 nm"]);
    refused(&[("wavelength", "0.55")], &["\"wavelength\" is 0.55", "nm"]);
    for (name, offered) in [
        ("weighting", ["radiometric", "none"]),
        ("pupil", ["rear", "disk"]),
        ("disk", ["concentric", "polar"]),
        ("refraction", ["fused", "whitted"]),
        ("precision", ["f64", "f32"]),
    ] {
        refused(&[(name, "Odd")], &[&format!("\"{name}\" is \"Odd\""), offered[0], offered[1]]);
    }
    refused(&[("simple_weighting", "yes")], &["\"simple_weighting\" takes true or false", "yes"]);
    let mut odd = Parameters::default();
    let message = odd.set_from_text("model", "Odd").expect_err("no such model").to_string();
    assert!(message.contains("\"model\" is \"Odd\"") && message.contains("\"lens\""), "{message}");
    refused(&[("flimdiag", "35")], &["\"flimdiag\"", "did you mean \"film_diagonal\"?"]);
}

/// Returns the range of the ray through the picture's middle.
fn clip(camera: &Camera) -> [f32; 2] {
    let (ray, _) = ray(camera, [200.0, 150.0], [0.5, 0.5]).expect("on the axis");
    [ray.mint, ray.maxt]
}

#[test]
fn what_would_put_infinities_into_rays_is_refused() {
    for (name, value) in [("shutter_open", "-inf"), ("shutter_close", "inf"), ("shutter_close", "1e39")] {
        refused(&[(name, value)], &[&format!("\"{name}\" is"), "finite"]);
    }
    refused(&[("hither", "inf")], &["\"hither\" is inf", "finite"]);
    refused(&[("mm_per_unit", "1e-310")], &["\"mm_per_unit\"", "1e30 mm"]);
    // The largest numbers stand for infinity in a scene.
    assert_eq!(clip(&camera(&[("yon", "inf")])), [1e-3, f32::INFINITY]);
    assert_eq!(clip(&camera(&[("yon", "1e300")])), [1e-3, f32::INFINITY]);
    // Rust callers may pass NaN where text cannot.
    for set in [
        |p: &mut Parameters| p.hither = Some(f64::NAN),
        |p: &mut Parameters| p.yon = Some(f64::NAN),
        |p: &mut Parameters| p.shutter_open = Some(f64::NAN),
        |p: &mut Parameters| p.focus_distance = Some(f64::NAN),
        |p: &mut Parameters| p.film_diagonal = Some(f64::NAN),
        |p: &mut Parameters| p.mm_per_unit = Some(f64::NAN),
    ] {
        let mut parameters = Parameters::default();
        set(&mut parameters);
        let built = Camera::build(&parameters, &host(), &mut |_, _| ());
        assert!(built.expect_err("NaN").to_string().contains("is NaN"));
    }
}

#[test]
fn two_names_for_one_thing_are_an_error_that_names_both() {
    for (first, second) in [
        (("weighting", "relative"), ("simple_weighting", "true")),
        (("fnumber", "4"), ("aperture_diameter", "5")),
        (("fnumber", "4"), ("aperturediameter", "5")),
        (("film_distance", "40"), ("focus_distance", "1000")),
        (("lens_file", "dgauss.50mm"), ("lensfile", "dgauss.50mm")),
        (("aperturediameter", "4"), ("aperture_diameter", "4")),
    ] {
        let canonical = |name: &str| Parameters::find(name).expect("known").name;
        for given in [[first, second], [second, first]] {
            refused(&given, &[canonical(first.0), canonical(second.0), "give one of them"]);
        }
    }
    let text = host_with("20 5 1.5 10\n-20 30 1 10\n");
    refused_by(
        &text,
        &[("lens_file", "dgauss.50mm")],
        &["\"lens_file\"", "\"lens_text\"", "give one of them"],
    );
}

#[test]
fn the_same_name_given_again_is_not_called_a_second_name() {
    // On a command line, the last value of a parameter applies, as it does for every parameter without an alias.
    let mut parameters = Parameters::default();
    for text in ["wide.22mm", "fisheye.10mm"] {
        parameters.set("lens_file", Value::Text(text)).expect("the name may be given again");
    }
    assert_eq!(parameters.lens_file.as_deref(), Some("fisheye.10mm"));
}

#[test]
fn a_missing_or_invalid_lens_file_is_reported() {
    refused(&[("lens_file", "nolens")], &["no lens file \"nolens\"", "working directory", "dgauss.50mm"]);
    refused(&[("lens_file", "dgauss.50mm@")], &["positive focal length in mm", "dgauss.50mm@35mm"]);
    refused(&[("lens_file", "dgauss.50mm@-35mm")], &["positive focal length in mm"]);
    refused(&[("lens_file", "dgauss.50mm@35")], &["positive focal length in mm"]);
    refused_by(&host_with("20 5 1.5\n"), &[], &["own.dat:1:1:", "four values"]);
    refused_by(&host_with(""), &[], &["own.dat:1:1:", "at least one interface"]);
    refused_by(&host_with("0 0 1 3\n"), &[], &["afocal", "\"film_distance\""]);
    let no_stop = host_with("20 5 1.5 10\n-20 30 1 10\n");
    refused_by(&no_stop, &[("aperture_diameter", "4")], &["no stop row", "\"fnumber\""]);
    let diverging = host_with("-20 5 1.5 10\n20 0 1 10\n");
    refused_by(&diverging, &[], &["focal length -", "no real image"]);
    let hollow = host_with("25 5 1.6 40\n20 0 1 34\n");
    refused_by(&hollow, &[("film_distance", "3")], &["touch the rear element", "\"film_distance\""]);
    refused(&[("film_diagonal", "1e30")], &["too large", "\"film_diagonal\""]);
}

#[test]
fn a_glass_that_no_wavelength_can_have_is_refused() {
    // A V-number of 0.2 would make the index less than that of air in the infrared.
    let host = host_with("20 5 1.5 0.2 10\n-20 30 - - 10\n");
    refused_by(&host, &[("wavelength", "1500")], &["1500 nm", "V-number"]);
    build(&host, &[]).expect("at the d line the V-number does not matter");
}

#[test]
fn clamped_apertures_and_mute_wavelengths_warn_and_go_on() {
    let warnings = |given: &[(&str, &str)]| build(&host(), given).expect("a camera").1;
    let (wide, clamped) = build(&host(), &[("aperture_diameter", "30")]).expect("a camera");
    let [clamped] = &clamped[..] else { panic!("{clamped:?}") };
    assert!(clamped.contains("30 mm") && clamped.contains("17.1 mm is used"), "{clamped}");
    assert_eq!(wide.facts().expect("a lens").fnumber(), camera(&[]).facts().expect("a lens").fnumber());
    let [fast] = &warnings(&[("fnumber", "1")])[..] else { panic!("one warning") };
    assert!(fast.contains("faster than the lens"), "{fast}");
    let [mute] = &warnings(&[("wavelength", "450")])[..] else { panic!("one warning") };
    assert!(mute.contains("V-numbers") && mute.contains("changes nothing"), "{mute}");
    assert_eq!(warnings(&[("wavelength", "450"), ("lens_file", "dgauss.100mm")]), [""; 0]);
    let host = host_with("10 1 1.5 8\n-10 0 1 8\n");
    let warnings = build(&host, &[]).expect("a camera").1;
    assert!(
        warnings.iter().any(|text| text.contains("rows 1 and 2 cross 3.1225 mm from the axis")),
        "{warnings:?}"
    );
}

#[test]
fn fnumber_sets_the_axial_beam() {
    for (name, _) in LENSES {
        for number in ["5.6", "8", "22"] {
            let camera = build(&host(), &[("lens_file", name), ("fnumber", number)]).expect("a camera").0;
            let number: f64 = number.parse().expect("a number");
            let lens = &camera.facts().expect("a lens").lens;
            let f = FirstOrder::of(lens).expect("focal").focal_length;
            let number = number.max(camera_of(name).facts().expect("a lens").fnumber());
            assert!(
                (camera.facts().expect("a lens").fnumber() / number - 1.0).abs() < 1e-12,
                "{name} f/{number}"
            );
            let path = Path::<f64>::scene_to_film(lens);
            let passes = |height: f64| {
                let origin = [0.0, height, 50.0];
                path.trace(Ray { origin, direction: [0.0, 0.0, -1.0] }).is_ok()
            };
            let height = f / number / 2.0;
            assert!(passes((1.0 - 1e-9) * height) && !passes((1.0 + 1e-9) * height), "{name} f/{number}");
        }
    }
    let without_stop =
        build(&host_with("20 5 1.5 10\n-20 30 1 10\n"), &[("fnumber", "8")]).expect("a camera").0;
    assert!((without_stop.facts().expect("a lens").fnumber() - 8.0).abs() < 1e-12);
    let of_diameter = camera(&[("aperture_diameter", "8.55")]);
    assert_eq!(of_diameter.facts().expect("a lens").lens.surfaces[5].semi_diameter, 8.55 / 2.0);
}

fn camera_of(name: &str) -> Camera {
    camera(&[("lens_file", name)])
}

#[test]
fn a_diverging_lens_has_a_positive_f_number() {
    let host = host_with("-20 3 1.5 10\n20 0 1 10\n");
    let given = [("film_distance", "30"), ("fnumber", "8")];
    let camera = build(&host, &given).expect("a camera with its film where it is put").0;
    assert!(camera.facts().expect("a lens").focal_length() < 0.0);
    assert!(
        (camera.facts().expect("a lens").fnumber() - 8.0).abs() < 1e-12,
        "{}",
        camera.facts().expect("a lens").fnumber()
    );
    assert_eq!(camera.facts().expect("a lens").focus_distance_mm, None);
}

#[test]
fn a_lens_scales_to_exactly_the_requested_focal_length() {
    for name in catalogue::round() {
        for focal_length in [35.0, 0.1, 1234.5] {
            let scaled = format!("{name}@{focal_length}mm");
            if name.starts_with("zoom") {
                let refused = build(&host(), &[("lens_file", &scaled)]).expect_err("no one focal length");
                assert!(refused.contains("zoom lens"), "{refused}");
                continue;
            }
            let camera = build(&host(), &[("lens_file", &scaled)]).expect("a camera").0;
            assert!(
                (camera.facts().expect("a lens").focal_length() / focal_length - 1.0).abs() < 1e-14,
                "{name}@{focal_length}"
            );
        }
    }
    let scaled = camera(&[("lens_file", "dgauss.100mm@35mm")]);
    let own = camera(&[("lens_file", "dgauss.100mm")]);
    let ratio = scaled.facts().expect("a lens").film_distance / own.facts().expect("a lens").film_distance;
    assert!(
        (ratio - 35.0 / own.facts().expect("a lens").focal_length()).abs() < 1e-14,
        "the nominal film distance scales, too"
    );
}

#[test]
fn the_nominal_film_distance_serves_where_none_is_given() {
    assert_eq!(camera(&[("lens_file", "dgauss.100mm")]).facts().expect("a lens").film_distance, 72.228);
    let off = camera(&[("lens_file", "dgauss.100mm"), ("film_distance", "80")]);
    assert!((off.facts().expect("a lens").film_distance - 80.0).abs() < 1e-12);
    let focused = camera(&[("lens_file", "dgauss.100mm"), ("focus_distance", "inf")]);
    assert!((focused.facts().expect("a lens").film_distance - 72.228).abs() > 1e-6);
    assert_eq!(focused.facts().expect("a lens").focus_distance_mm, Some(f64::INFINITY));
    // A camera without a given focus is focused at infinity.
    assert_eq!(camera(&[]).facts().expect("a lens").focus_distance_mm, Some(f64::INFINITY));
    assert_eq!(
        camera(&[]).facts().expect("a lens").film_distance,
        camera(&[("focus_distance", "inf")]).facts().expect("a lens").film_distance
    );
}

/// Returns the heights at the film and the slopes of the bundle that passes the entrance pupil from an axial point
/// `distance` mm from the film (or at infinity), uniform over the pupil.
fn bundle(camera: &Camera, distance: f64) -> Vec<(f64, f64)> {
    const RAYS: u32 = 4000;
    let lens = &camera.facts().expect("a lens").lens;
    let path = Path::<f64>::scene_to_film(lens);
    let film = lens.rear().vertex - camera.facts().expect("a lens").film_distance;
    let pupil = AxialBeam::of(lens).entrance;
    let (plane, radius) = (pupil.position().expect("finite"), pupil.diameter() / 2.0);
    let aimed = |height: f64| {
        let ray = if distance.is_infinite() {
            Ray { origin: [0.0, height, 100.0], direction: [0.0, 0.0, -1.0] }
        } else {
            let object = film + distance;
            Ray { origin: [0.0, 0.0, object], direction: [0.0, height, plane - object] }
        };
        let got = path.trace(ray).ok()?;
        let slope = got.direction[1] / -got.direction[2];
        Some((got.origin[1] + slope * (got.origin[2] - film), slope))
    };
    // These are all rays that pass, up to the edge of the exact pupil, in equal areas.
    let edge = (0..2000).map(|i| radius * (1.3 - 0.0005 * f64::from(i))).find(|&h| aimed(h).is_some());
    let edge = edge.expect("some ray passes");
    (0..RAYS).filter_map(|i| aimed(edge * ((f64::from(i) + 0.5) / f64::from(RAYS)).sqrt())).collect()
}

/// Returns the RMS height of a bundle in a plane `shift` mm behind the film.
fn rms(bundle: &[(f64, f64)], shift: f64) -> f64 {
    let sum: f64 = bundle.iter().map(|(height, slope)| (height + shift * slope).powi(2)).sum();
    (sum / bundle.len() as f64).sqrt()
}

#[test]
fn a_bundle_from_the_plane_in_focus_is_sharpest_on_the_film() {
    for (name, _) in LENSES {
        for distance in ["1200", "2500", "1e7", "inf"] {
            for fnumber in ["8", "16"] {
                let camera =
                    camera(&[("lens_file", name), ("focus_distance", distance), ("fnumber", fnumber)]);
                let distance: f64 = distance.parse().expect("a number");
                assert_eq!(camera.facts().expect("a lens").focus_distance_mm, Some(distance));
                let bundle = bundle(&camera, distance);
                let here = rms(&bundle, 0.0);
                // The depth of focus is about N times the spot's diameter.
                let f = camera.facts().expect("a lens").focal_length();
                for shift in [-2e-4 * f, -4e-5 * f, 4e-5 * f, 2e-4 * f] {
                    let there = rms(&bundle, shift);
                    assert!(here < there, "{name} {distance} f/{fnumber}: {here} and {shift} mm off {there}");
                }
                // The minimum lies at -Σ h s/Σ s².
                let sums = bundle.iter().fold((0.0, 0.0), |(a, b), (h, s)| (a + h * s, b + s * s));
                let off = -sums.0 / sums.1;
                assert!(off.abs() < 1e-5 * f, "{name} {distance} f/{fnumber}: best {off:e} mm off");
            }
        }
    }
}

#[test]
fn ten_kilometres_and_infinity_are_as_exact_as_a_metre() {
    // Newton's equation gives the shift from infinity, f²/(z - F): the aberrations are the same there.
    for (name, _) in LENSES {
        let at =
            |distance: &str| camera(&[("lens_file", name), ("focus_distance", distance), ("fnumber", "16")]);
        let (infinity, far) = (at("inf"), at("1e7"));
        let first_order = FirstOrder::of(&far.facts().expect("a lens").lens).expect("focal");
        let shift =
            far.facts().expect("a lens").film_distance - infinity.facts().expect("a lens").film_distance;
        let expected = first_order.focal_length.powi(2) / 1e7;
        assert!((shift / expected - 1.0).abs() < 1e-2, "{name}: {shift:e}, {expected:e}");
        let near = at("1e15").facts().expect("a lens").film_distance
            - infinity.facts().expect("a lens").film_distance;
        assert!(near.abs() < 1e-9 && near >= 0.0, "{name}: {near:e}");
    }
}

#[test]
fn too_near_names_the_nearest_and_the_nearest_works() {
    for (name, _) in LENSES {
        let message = build(&host(), &[("lens_file", name), ("focus_distance", "10")]).expect_err("too near");
        assert!(message.contains("cannot focus at 10 mm"), "{message}");
        let (_, rest) = message.split_once("the nearest it reaches is ").expect("names it");
        let (distance, _) = rest.split_once(' ').expect("a number and its unit");
        assert!(distance.len() <= "123.456".len(), "{message}");
        let nearest: f64 = distance.parse().expect("a number");
        build(&host(), &[("lens_file", name), ("focus_distance", distance)]).expect("it reaches that");
        let with = |factor: f64| (factor * nearest).to_string();
        refused(&[("lens_file", name), ("focus_distance", &with(0.9999))], &["cannot focus"]);
    }
}

#[test]
fn metres_are_millimetres_seen_from_afar() {
    let metres = camera(&[("mm_per_unit", "1000"), ("focus_distance", "2")]);
    let millimetres = camera(&[("focus_distance", "2000")]);
    assert_eq!(
        metres.facts().expect("a lens").film_distance,
        millimetres.facts().expect("a lens").film_distance
    );
    let mut random = Random::new(1);
    for _ in 0..2000 {
        let image = [400.0 * random.next() as f32, 300.0 * random.next() as f32];
        let lens = [random.next() as f32, random.next() as f32];
        let (a, b) = (ray(&metres, image, lens), ray(&millimetres, image, lens));
        assert_eq!(a.is_some(), b.is_some());
        if let (Some((a, weight)), Some((b, other))) = (a, b) {
            assert_eq!((a.direction, weight), (b.direction, other));
            for (a, b) in a.origin.iter().zip(b.origin) {
                assert!((a - b / 1000.0).abs() <= 2e-7 * a.abs());
            }
        }
    }
}

fn placed(rows: [f32; 16]) -> Camera {
    let to_world = CameraToWorld::from_rows(&rows).expect("affine");
    build(&Host { to_world: to_world.into(), ..host() }, &[]).expect("a camera").0
}

#[test]
fn mirrored_and_scaled_transforms_carry_the_rays() {
    let plain = camera(&[]);
    // The cases are a mirror in x, a rotation with a translation, and scales that differ along the axes.
    let cases: [[f32; 16]; 3] = [
        [-1., 0., 0., 5., 0., 1., 0., 6., 0., 0., 1., 7., 0., 0., 0., 1.],
        [0., -1., 0., 1., 1., 0., 0., 2., 0., 0., 1., 3., 0., 0., 0., 1.],
        [2., 0., 0., 0., 0., 0.5, 0., 0., 0., 0., 3., 0., 0., 0., 0., 1.],
    ];
    for rows in cases {
        let placed = placed(rows);
        let linear = |v: [f32; 3]| -> [f64; 3] {
            std::array::from_fn(|row| (0..3).map(|i| f64::from(rows[4 * row + i]) * f64::from(v[i])).sum())
        };
        let mut random = Random::new(2);
        let mut passed = 0;
        for _ in 0..1000 {
            let image = [400.0 * random.next() as f32, 300.0 * random.next() as f32];
            let lens = [random.next() as f32, random.next() as f32];
            let (a, b) = (ray(&plain, image, lens), ray(&placed, image, lens));
            assert_eq!(a.is_some(), b.is_some());
            let (Some((a, weight)), Some((b, other))) = (a, b) else { continue };
            passed += 1;
            assert_eq!(weight, other, "the weight is of the film and the lens");
            let d = linear(a.direction);
            let norm = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            let unit: f64 = b.direction.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>();
            assert!((unit - 1.0).abs() < 3e-7, "{b:?}");
            for i in 0..3 {
                assert!((f64::from(b.direction[i]) - d[i] / norm).abs() < 2e-7);
                let o = linear(a.origin)[i] + f64::from(rows[4 * i + 3]);
                assert!((f64::from(b.origin[i]) - o).abs() < 1e-5);
            }
        }
        assert!(passed > 300);
    }
}

#[test]
fn samples_off_the_film_and_lens_samples_0_and_1_have_answers() {
    for pupil in ["rear", "disk"] {
        for disk in ["concentric", "polar"] {
            let camera = build(&host(), &[("pupil", pupil), ("disk", disk)]).expect("a camera").0;
            let mut passed = 0;
            let edges = [0.0, 0.5, 1.0, f32::from_bits(1), 1.0 - f32::EPSILON / 2.0];
            for (u, v) in edges.into_iter().flat_map(|u| edges.map(|v| (u, v))) {
                for image in [[-2.0, -2.0], [403.0, 303.0], [-2.0, 150.0], [200.0, 150.0], [400.0, 0.0]] {
                    for time in [0.0, 1.0] {
                        let requested =
                            Sample { image_x: image[0], image_y: image[1], lens_u: u, lens_v: v, time };
                        let substitute = camera.substitute(&requested);
                        assert!(substitute.origin.iter().all(|x| x.is_finite()));
                        let Outcome::Ray(ray, weight) = camera.generate(&requested, None) else { continue };
                        passed += 1;
                        assert!(weight > 0.0 && weight.is_finite());
                        assert_eq!(ray.time, time, "the shutter is open from 0 to 1");
                        assert!(ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite()));
                    }
                }
            }
            assert!(passed > 2, "{pupil} {disk}: {passed}");
        }
    }
    // A pixel outside the film continues it, without a jump at the film's edge.
    let camera = camera(&[]);
    let middle =
        |x: f32| ray(&camera, [x, 150.0], [0.5, 0.5]).expect("the middle of the pupil").0.direction[0];
    let steps: Vec<f32> = (-3..3).map(|x| middle(x as f32) - middle(x as f32 + 1.0)).collect();
    assert!(steps.windows(2).all(|pair| (pair[0] / pair[1] - 1.0).abs() < 0.02), "{steps:?}");
}

fn rays_of(camera: &Camera) -> Vec<Outcome> {
    let mut random = Random::new(3);
    let mut next = || random.next() as f32;
    (0..500)
        .map(|_| camera.generate(&sample([400.0 * next(), 300.0 * next()], [next(), next()]), None))
        .collect()
}

#[test]
fn every_ray_carries_hither_yon_and_the_shutter_time() {
    let camera = camera(&[("hither", "0.25"), ("yon", "50"), ("shutter_open", "2"), ("shutter_close", "6")]);
    for (number, expected) in [(0.0, 2.0), (0.25, 3.0), (1.0, 6.0)] {
        let sample = Sample { time: number, ..sample([200.0, 150.0], [0.5, 0.5]) };
        let Outcome::Ray(ray, _) = camera.generate(&sample, None) else { panic!("on the axis") };
        assert_eq!((ray.mint, ray.maxt, ray.time), (0.25, 50.0, expected));
    }
    // The interpolation is that of pbrt's stock cameras: backward if the shutter closes before it opens.
    let backward = self::camera(&[("shutter_open", "6"), ("shutter_close", "2")]);
    for (number, expected) in [(0.0, 6.0), (0.25, 5.0), (1.0, 2.0)] {
        let sample = Sample { time: number, ..sample([200.0, 150.0], [0.5, 0.5]) };
        let Outcome::Ray(ray, _) = backward.generate(&sample, None) else { panic!("on the axis") };
        assert_eq!(ray.time, expected);
    }
    let stock = camera_of("dgauss.50mm");
    assert_eq!(clip(&stock), [1e-3, 1e30]);
    for time in [0.0, 1.0] {
        let sample = Sample { time, ..sample([200.0, 150.0], [0.5, 0.5]) };
        let Outcome::Ray(ray, _) = stock.generate(&sample, None) else { panic!("on the axis") };
        assert_eq!(ray.time, time);
    }
}

#[test]
fn what_lies_right_and_up_is_seen_right_and_up() {
    for (name, diagonal) in LENSES {
        let camera = camera(&[("lens_file", name), ("film_diagonal", diagonal), ("focus_distance", "5000")]);
        // Raster (0, 0) is the top left.
        for (image, right, up) in
            [([300.0, 100.0], 1.0, 1.0), ([300.0, 200.0], 1.0, -1.0), ([100.0, 90.0], -1.0, 1.0)]
        {
            let mut random = Random::new(4);
            let mut seen = 0;
            for _ in 0..500 {
                let Some((ray, _)) = ray(&camera, image, [random.next() as f32, random.next() as f32]) else {
                    continue;
                };
                let to_plane = (4000.0 - ray.origin[2]) / ray.direction[2];
                let [x, y] = [0, 1].map(|i| ray.origin[i] + to_plane * ray.direction[i]);
                assert!(x * right > 0.0 && y * up > 0.0, "{name}: {image:?} sees {x}, {y}");
                seen += 1;
            }
            assert!(seen > 20, "{name}: {seen}");
        }
    }
}

#[test]
fn the_film_diagonal_spans_the_raster_and_the_lens_its_angle() {
    // With a focal length of 50 mm, a diagonal of 35 mm and no distortion, the slope of the direction at a corner is
    // 17.5/50 at infinity.
    let camera = camera(&[("fnumber", "16"), ("film_diagonal", "35")]);
    assert_eq!(camera.facts().expect("a lens").film.diagonal(), 35.0);
    let [x, y] = camera.facts().expect("a lens").film.point(0.0, 0.0);
    assert!((x.hypot(y) - 17.5).abs() < 1e-12);
    assert!(
        (camera.facts().expect("a lens").film.pixel() * f64::from(RASTER.xres).hypot(RASTER.yres.into())
            - 35.0)
            .abs()
            < 1e-12
    );
    let mut random = Random::new(5);
    let slopes: Vec<f64> = (0..20_000)
        .filter_map(|_| ray(&camera, [0.0, 0.0], [random.next() as f32, random.next() as f32]))
        .map(|(ray, _)| f64::from(ray.direction[0].hypot(ray.direction[1]) / ray.direction[2]))
        .collect();
    assert!(slopes.len() > 20, "{}", slopes.len());
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    assert!((mean / (17.5 / camera.facts().expect("a lens").focal_length()) - 1.0).abs() < 0.03, "{mean}");
    assert!((mean.atan() * 180.0 / PI - 19.3).abs() < 0.6);
}

#[test]
fn refractions_agree_and_single_precision_is_near() {
    let of = |given: (&str, &str)| rays_of(&camera(&[given]));
    let exact = of(("refraction", "fused"));
    for (given, tolerance) in [
        (("refraction", "heckbert"), 1.3e-7),
        (("refraction", "whitted"), 1.3e-7),
        (("refraction", "other"), 1.3e-7),
        (("precision", "f64"), 0.0),
        (("precision", "f32"), 4e-6),
    ] {
        for (a, b) in exact.iter().zip(of(given)) {
            let (Outcome::Ray(a, _), Outcome::Ray(b, _)) = (a, b) else { continue };
            for (a, b) in a.direction.iter().zip(b.direction) {
                assert!((a - b).abs() <= tolerance, "{given:?}: {a} {b}");
            }
        }
    }
    // A wavelength moves the focus of a lens with V-numbers.
    let red = Lens::new(&catalogue::find("dgauss.100mm").expect("listed"), 656.27);
    let focal_length = |lens: &Lens| FirstOrder::of(lens).expect("focal").focal_length;
    let of_camera = camera(&[("lens_file", "dgauss.100mm"), ("wavelength", "656.27")])
        .facts()
        .expect("a lens")
        .focal_length();
    assert_eq!(of_camera, focal_length(&red));
    assert_ne!(of_camera, focal_length(&lens("dgauss.100mm")));
}

#[test]
fn film_too_far_off_for_relative_weights_is_refused() {
    let far =
        [("weighting", "relative"), ("film_distance", "1e18"), ("fnumber", "660"), ("precision", "f32")];
    refused(&far, &["too far", "\"film_distance\""]);
}
