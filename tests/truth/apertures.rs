//! Apertures and obstructions of any shape: the light that passes them at every azimuth, by brute force with formulas of
//! this file, and the agreement of all tracers.

use super::support;

use ::realistic_camera::Camera;
use realistic_optics::{
    lens::{Lens, film_ray},
    prescription::{Outline, read},
    trace::{Direction, Path},
};
use realistic_trace::kernel::Kernel;
use std::f64::consts::TAU;
use support::{Random, build, host_with, light};

/// A singlet with a plane in front, a stop, and a plane of glass, whose rows the shapes below stand in.
const TABLE: &str = "flare 1 1 24\n50 6 1.5 22\n-50 4 1 22\nstop 2 1 8\ninf 2 1.5 24\ninf 45 1 24\n";
/// The row of the stop, counted from 1.
const STOP: usize = 4;

/// A heart, in mm: concave, and not symmetric about the x axis.
const HEART: &str = "0 -3.6 2.6 -0.9 3.4 1.2 2.5 2.6 1.1 2.7 0 1.6 -1.1 2.7 -2.5 2.6 -3.4 1.2 -2.6 -0.9";

/// A line of the table, and the same test of a point, in mm, by its textbook formula.
type Case = (&'static str, fn([f64; 2]) -> bool);

fn turned([x, y]: [f64; 2], [cx, cy]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let [x, y] = [x - cx, y - cy];
    [x * cosine + y * sine, y * cosine - x * sine]
}

/// Whether the angles under which a point sees the edges of a polygon sum to a whole turn.
fn winds_around(vertices: &str, point: [f64; 2]) -> bool {
    let numbers: Vec<f64> = vertices.split(' ').map(|word| word.parse().expect("a number")).collect();
    let corners: Vec<[f64; 2]> =
        numbers.chunks(2).map(|pair| [pair[0] - point[0], pair[1] - point[1]]).collect();
    let angles = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = angles.map(|(a, b)| (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])).sum();
    sum.abs() > TAU / 2.0
}

const CASES: [Case; 6] = [
    ("aperture 4 ring 1.5 3.5", |[x, y]| (1.5..=3.5).contains(&x.hypot(y))),
    ("aperture 4 circle 2 x=1.2 y=-0.7", |[x, y]| (x - 1.2).hypot(y + 0.7) <= 2.0),
    ("aperture 4 ellipse 3.5 1.5 rotation=30", |point| {
        let [x, y] = turned(point, [0.0; 2], 30.0);
        (x / 3.5).hypot(y / 1.5) <= 1.0
    }),
    ("aperture 4 rectangle 3 1.2 x=0.4 y=0.3 rotation=-25", |point| {
        let [x, y] = turned(point, [0.4, 0.3], -25.0);
        x.abs() <= 3.0 && y.abs() <= 1.2
    }),
    ("obstruction 4 rectangle 4 0.4 rotation=70", |point| {
        let [x, y] = turned(point, [0.0; 2], 70.0);
        x.abs() > 4.0 || y.abs() > 0.4
    }),
    (
        "aperture 4 polygon 0 -3.6 2.6 -0.9 3.4 1.2 2.5 2.6 1.1 2.7 0 1.6 -1.1 2.7 -2.5 2.6 -3.4 1.2 -2.6 -0.9",
        |point| winds_around(HEART, point),
    ),
];

fn camera(lines: &str, more: &[(&str, &str)]) -> Camera {
    let given = [&[("film_diagonal", "22"), ("film_distance", "48")], more].concat();
    let (camera, warnings) = build(&host_with(&format!("{TABLE}{lines}\n")), &given)
        .unwrap_or_else(|error| panic!("{lines}: {error}"));
    assert!(warnings.iter().all(|text| !text.contains("apert")), "{lines}: {warnings:?}");
    camera
}

fn lens(lines: &str) -> Lens {
    Lens::at_d_line(&read("shaped", format!("{TABLE}{lines}\n").as_bytes()).expect(lines))
}

#[test]
fn no_light_is_lost_or_made_at_any_azimuth() {
    let round = camera("", &[]);
    let semi_diameter = round.facts().expect("a lens").lens.surfaces[STOP - 1].semi_diameter;
    support::on_all_cores(&CASES, |(line, test)| {
        let cameras = ["warped", "rear"].map(|pupil| (pupil, camera(line, &[("pupil", pupil)])));
        for azimuth in 0..12_u8 {
            let (sine, cosine) = (TAU * f64::from(azimuth) / 12.0).sin_cos();
            let image = [200.0 + 110.0 * cosine, 150.0 + 110.0 * sine].map(|part| part as f32);
            let passed = |point: [f64; 2]| f64::from(u8::from(test(point.map(|part| part * semi_diameter))));
            let [expected, error] = light::through_stop(&round, passed, image, 7 + u64::from(azimuth));
            for (pupil, camera) in &cameras {
                let [found, own_error] = light::of_camera(camera, image, 91 + u64::from(azimuth));
                let off = (found - expected) / error.hypot(own_error);
                assert!(
                    expected > 0.0 && off.abs() < 4.5,
                    "{line} {pupil} {azimuth}: {found} {expected} {off}"
                );
            }
        }
    });
}

#[test]
fn relative_weights_have_the_mean_1_on_the_axis() {
    for (line, _) in CASES {
        let shaped = camera(line, &[("weighting", "relative")]);
        let [mean, error] = light::of_camera(&shaped, [200.0, 150.0], 5);
        assert!((mean - 1.0).abs() < 4.5 * error && error < 0.02, "{line}: {mean} {error}");
    }
}

#[test]
fn kernels_and_walk_agree_in_both_directions_on_every_surface() {
    let shapes = [
        "ring 1.5 3.5",
        "circle 2 x=1 y=-0.7",
        "ellipse 3 1.5 rotation=30",
        "rectangle 3 1.2 y=1 rotation=-25",
    ];
    let polygon = format!("polygon {HEART} x=0.5 rotation=200");
    for row in 1..=6 {
        for shape in shapes.into_iter().chain([polygon.as_str()]) {
            for keyword in ["aperture", "obstruction"] {
                if keyword == "obstruction" && shape.starts_with("ring") {
                    continue;
                }
                let lens = lens(&format!("{keyword} {row} {shape}"));
                for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
                    agrees(&lens, direction, &format!("{keyword} {row} {shape}"));
                }
            }
        }
    }
}

/// Traces rays by the walk and by kernels of both precisions.
fn agrees(lens: &Lens, direction: Direction, what: &str) {
    let path = Path::<f64>::new(lens, direction, Default::default()).with_apertures(lens);
    let (double, single) = (Kernel::<f64>::along(&path), Kernel::<f32>::along(&path));
    let plane = if direction == Direction::FilmToScene { lens.rear().vertex - 45.0 } else { 60.0 };
    let mut random = Random::new(3);
    let (mut passed, mut blocked, mut differ) = (0, 0, 0);
    for _ in 0..3_000 {
        let [x, y] = [0, 1].map(|_| 8.0 * (random.next() - 0.5));
        let slopes = [x, y].map(|part| -part / 50.0 + 0.4 * (random.next() - 0.5));
        let mut ray = film_ray([x, y], plane, slopes);
        if direction == Direction::SceneToFilm {
            ray.direction = ray.direction.map(|part| -part);
        }
        let walked = path.trace(ray).ok();
        let traced = double.trace_one(plane, [x, y], slopes);
        assert_eq!(walked.is_some(), traced.is_some(), "{what} {direction:?}: {ray:?}");
        *(if walked.is_some() { &mut passed } else { &mut blocked }) += 1;
        let [x, y, sx, sy] = [x, y, slopes[0], slopes[1]].map(|part| part as f32);
        differ += u32::from(single.trace_one(plane, [x, y], [sx, sy]).is_some() != walked.is_some());
    }
    assert!(passed > 50 && blocked > 50 && differ <= 4, "{what} {direction:?}: {passed} {blocked} {differ}");
}

#[test]
fn every_tracer_tests_the_shapes() {
    for (line, _) in CASES {
        for (tracer, most) in [
            (&[("precision", "f64")][..], 0),
            (&[("precision", "f32")], 4),
            (&[("refraction", "heckbert")], 2),
            (&[("tolerance", "0.5")], 60),
        ] {
            let [exact, other] = [camera(line, &[]), camera(line, tracer)];
            let [_, _, differ] = light::fates([&exact, &other], 10_000);
            assert!(differ <= most, "{line} {tracer:?}: {differ}");
        }
    }
}

#[test]
fn shapes_follow_a_stop_that_is_narrowed_and_blades_keep_company() {
    let acceptance =
        |lines: &str, given: &[(&str, &str)]| light::acceptance(&camera(lines, given), 20_000, 2);
    let half = [("aperture_diameter", "4")];
    for given in [&[][..], &half] {
        assert!((acceptance("obstruction 4 circle 2", given) - 0.75).abs() < 0.015, "{given:?}");
    }
    let both = acceptance("obstruction 4 circle 2\nblades 6", &[]);
    // The obstruction lies inside the hexagon.
    let hexagon = 27.0_f64.sqrt() / 2.0 / (TAU / 2.0);
    assert!((both - (hexagon - 0.25)).abs() < 0.015, "{both} {hexagon}");
    assert!((acceptance("obstruction 4 circle 2\nblades 6", &[("blades", "0")]) - 0.75).abs() < 0.015);
}

#[test]
fn samples_lie_in_the_circle_around_a_shape() {
    let cases = [
        ("aperture 4 ring 1.5 3.5", 1.0 - (1.5_f64 / 3.5).powi(2)),
        ("aperture 4 rectangle 1.5 1.5 rotation=20", 4.0 / TAU),
        ("aperture 4 circle 1 x=1", 0.25),
    ];
    for (line, expected) in cases {
        for given in [&[][..], &[("aperture_diameter", "4")]] {
            let found = light::acceptance(&camera(line, given), 20_000, 2);
            assert!((found - expected).abs() < 0.015, "{line} {given:?}: {found} {expected}");
        }
    }
}

#[test]
fn apertures_of_a_table_are_what_it_says() {
    let own = read("t", format!("{TABLE}aperture 2 ring 2 5 y=1\nobstruction 5 circle 0.5\n").as_bytes())
        .expect("read");
    let [outer, inner] = &own.interfaces[1].apertures[..] else { panic!("{:?}", own.interfaces[1]) };
    assert_eq!((&outer.outline, outer.is_obstruction), (&Outline::Ellipse([5.0; 2]), false));
    assert_eq!((&inner.outline, inner.is_obstruction), (&Outline::Ellipse([2.0; 2]), true));
    assert!(outer.center == [0.0, 1.0] && inner.center == [0.0, 1.0]);
    assert!(own.interfaces[4].apertures[0].is_obstruction);
    assert_eq!(own.scaled(2.0).interfaces[4].apertures[0].outline, Outline::Ellipse([1.0; 2]));
}
