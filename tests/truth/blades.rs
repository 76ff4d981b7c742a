//! Stops with blades: the rays that they block, the remaining light, and the image of a defocused light.

use super::support;

use ::realistic_camera::Camera;
use realistic_optics::prescription::Blades;
use support::{Random, build, camera, host, host_with, light};

/// Whether a point in a stop of radius 1 lies inside the figure of its blades: on the centre's side of every edge. An
/// edge is an arc through two corners, whose curvature is a fraction of the circle's.
fn is_inside(blades: Blades, point: [f64; 2]) -> bool {
    let corner = |k: u32| {
        let turn =
            blades.rotation.to_radians() + std::f64::consts::TAU * f64::from(k) / f64::from(blades.count);
        [turn.cos(), turn.sin()]
    };
    (0..blades.count).all(|k| {
        let [a, b] = [corner(k), corner(k + 1)];
        let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        let distance = middle[0].hypot(middle[1]);
        let normal = middle.map(|x| x / distance);
        if blades.curvature == 0.0 {
            return point[0] * normal[0] + point[1] * normal[1] <= distance;
        }
        let radius = 1.0 / blades.curvature;
        let half = (a[0] - b[0]).hypot(a[1] - b[1]) / 2.0;
        let center = distance - (radius * radius - half * half).sqrt();
        (point[0] - center * normal[0]).hypot(point[1] - center * normal[1]) <= radius
    })
}

const CASES: [(&str, &str, Blades); 4] = [
    ("dgauss.50mm", "4", Blades { count: 5, rotation: 0.0, curvature: 0.0 }),
    ("dgauss.50mm", "2.2", Blades { count: 7, rotation: 20.0, curvature: 0.3 }),
    ("wide.22mm", "5.6", Blades { count: 3, rotation: -35.0, curvature: 0.0 }),
    ("fisheye.10mm", "8", Blades { count: 6, rotation: 200.0, curvature: 0.8 }),
];

fn given(blades: Blades) -> [(&'static str, String); 3] {
    [
        ("blades", blades.count.to_string()),
        ("blade_rotation", blades.rotation.to_string()),
        ("blade_curvature", blades.curvature.to_string()),
    ]
}

/// Builds a camera with blades. A tolerance may report its choice; otherwise there must be no warning.
fn bladed(blades: Blades, more: &[(&str, &str)]) -> Camera {
    let own = given(blades);
    let own = own.iter().map(|(name, value)| (*name, value.as_str()));
    let all: Vec<_> = own.chain(more.iter().copied()).collect();
    let (camera, warnings) = build(&host(), &all).unwrap_or_else(|error| panic!("{all:?}: {error}"));
    assert!(warnings.iter().all(|text| text.starts_with("tolerance")), "{warnings:?}");
    camera
}

#[test]
fn blades_give_the_right_light_at_every_azimuth() {
    for (lens, fnumber, blades) in CASES {
        let more = [("lens_file", lens), ("fnumber", fnumber), ("film_diagonal", "22")];
        let round = camera(&more);
        let cameras = ["warped", "rear"]
            .map(|pupil| (pupil, bladed(blades, &[more.as_slice(), &[("pupil", pupil)]].concat())));
        // The image points are the axis and four directions half way out.
        for (i, image) in [[200.0, 150.0], [325.0, 150.0], [200.0, 40.0], [90.0, 90.0], [260.0, 240.0]]
            .into_iter()
            .enumerate()
        {
            let [expected, error] = light::through_stop(
                &round,
                |point| f64::from(u8::from(is_inside(blades, point))),
                image,
                7 + i as u64,
            );
            for (pupil, camera) in &cameras {
                let [found, own_error] = light::of_camera(camera, image, 91 + i as u64);
                let off = (found - expected) / error.hypot(own_error);
                assert!(
                    expected > 0.0 && off.abs() < 4.5,
                    "{lens} {pupil} {image:?}: {found} {expected} {off}"
                );
            }
        }
        let camera = bladed(blades, &more);
        let acceptance = light::acceptance(&camera, 40_000, 3);
        // The pupil is the stop's image, apart from the pupil's own aberrations.
        assert!((acceptance / blades.share() - 1.0).abs() < 0.03, "{lens}: {acceptance} {}", blades.share());
    }
}

#[test]
fn with_relative_weights_the_mean_on_the_axis_is_1() {
    for (lens, fnumber, blades) in CASES {
        let more =
            [("lens_file", lens), ("fnumber", fnumber), ("film_diagonal", "22"), ("weighting", "relative")];
        let [mean, error] = light::of_camera(&bladed(blades, &more), [200.0, 150.0], 5);
        assert!((mean - 1.0).abs() < 4.5 * error && error < 0.01, "{lens}: {mean} {error}");
    }
}

/// Returns, for the passing rays of the picture's centre, the intersections with the plane z = `plane`, mm, as angles
/// in degrees and radii.
fn footprint(camera: &Camera, plane: f64) -> Vec<[f64; 2]> {
    let mut random = Random::new(17);
    (0..60_000)
        .filter_map(|_| support::ray(camera, [200.0, 150.0], [random.next() as f32, random.next() as f32]))
        .map(|(ray, _)| {
            let ahead = (plane - f64::from(ray.origin[2])) / f64::from(ray.direction[2]);
            let [x, y] = [0, 1].map(|i| f64::from(ray.origin[i]) + ahead * f64::from(ray.direction[i]));
            [y.atan2(x).to_degrees(), x.hypot(y)]
        })
        .collect()
}

#[test]
fn a_defocused_light_has_the_shape_of_the_blades() {
    let blades = Blades { count: 5, rotation: 31.0, curvature: 0.0 };
    let camera = bladed(blades, &[("fnumber", "4"), ("focus_distance", "2000")]);
    for (plane, turned) in [(1000.0, 0.0), (8000.0, 180.0)] {
        let points = footprint(&camera, plane);
        // Radius of the footprint as a function of the angle from the nearest expected corner.
        let mut edge = [0.0_f64; 36];
        for [degrees, radius] in &points {
            let from_corner = (degrees - 31.0 - turned).rem_euclid(72.0);
            let bin = &mut edge[(from_corner / 2.0) as usize];
            *bin = bin.max(*radius);
        }
        let largest = edge.iter().copied().fold(0.0, f64::max);
        for (i, radius) in edge.into_iter().enumerate() {
            // A straight edge is at cos 36 degrees in its middle and goes from corner to corner; the largest radius of
            // a bin is at its outer side.
            let nearest_corner = (2.0 * i as f64 - 35.0).abs().max((2.0 * i as f64 - 34.0).abs() - 0.0);
            let angle = (36.0 - nearest_corner.min(36.0)).to_radians();
            let expected = 36.0_f64.to_radians().cos() / (36.0_f64.to_radians() - angle).cos();
            assert!(
                (radius / largest - expected).abs() < 0.02,
                "{plane} bin {i}: {} {expected}",
                radius / largest
            );
        }
    }
}

#[test]
fn every_tracer_tests_the_blades() {
    let blades = Blades { count: 7, rotation: 10.0, curvature: 0.2 };
    for (tracer, most) in [
        (&[("precision", "f64")][..], 0),
        (&[("precision", "f32")], 4),
        (&[("refraction", "heckbert")], 2),
        (&[("refraction", "whitted"), ("precision", "f32")], 40),
        (&[("tolerance", "0.5")], 40),
    ] {
        let exact = bladed(blades, &[("fnumber", "8")]);
        let other = bladed(blades, &[&[("fnumber", "8")], tracer].concat());
        let [passed, blocked, differ] = light::fates([&exact, &other], 20_000);
        assert!(passed > 10_000 && blocked > 500, "{passed} {blocked}");
        assert!(differ <= most, "{tracer:?}: {differ}");
    }
}

#[test]
fn a_files_blades_apply_unless_a_parameter_overrides_them() {
    let text = "50 6 1.5 20\n-50 4 1 20\n0 45 1 8\nblades 6 rotation=15\n";
    let acceptance = |given: &[(&str, &str)]| {
        let (camera, _) = build(&host_with(text), given).expect("a camera");
        light::acceptance(&camera, 20_000, 2)
    };
    let share = |count, curvature| Blades { count, rotation: 0.0, curvature }.share();
    assert!((acceptance(&[]) - share(6, 0.0)).abs() < 0.015);
    assert!((acceptance(&[("blade_curvature", "0.9")]) - share(6, 0.9)).abs() < 0.015);
    assert!((acceptance(&[("blades", "3")]) - share(3, 0.0)).abs() < 0.015);
    assert!(acceptance(&[("blades", "0")]) > 0.99);
}

#[test]
fn impossible_blades_are_refused_with_the_valid_values() {
    let no_stop = "50 6 1.5 20\n-50 45 1 20\n";
    for (host, given, words) in [
        (host(), &[("blades", "2")][..], "a whole number from 3 to 32"),
        (host(), &[("blades", "6.5")], "a whole number from 3 to 32"),
        (host(), &[("blades", "33")], "32"),
        (host(), &[("blades", "-1")], "0 (a round stop) or more, up to 32"),
        (host(), &[("blade_rotation", "10")], "there are none; give \"blades\""),
        (host(), &[("blades", "5"), ("blade_curvature", "1.5")], "up to 1"),
        (host_with(no_stop), &[("blades", "5")], "no stop row"),
    ] {
        let error = build(&host, given).expect_err("refused");
        assert!(error.contains(words), "{given:?}: {error}");
    }
}
