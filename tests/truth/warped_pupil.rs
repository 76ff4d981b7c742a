//! The warped pupil against brute force: light missed and samples wasted, weights that estimate the true irradiance,
//! and smoothness over the film.

use super::pupil_fit;

use std::f64::consts::TAU;

use ::realistic_camera::{Camera, Host, Outcome, Parameters, Raster, Sample, Value, sampling::DiskMapping};
use pupil_fit::{Case, LENSES, REACH, STOPS, grid, lens_at};
use realistic_optics::{imaging::focus::Focus, lens::Lens, prescription::read, trace::Blocked};

const CORNER: f64 = 17.5;

fn lens(text: &str) -> Lens {
    Lens::at_d_line(&read("test", text.as_bytes()).expect("a valid lens"))
}

/// Returns the irradiance through the whole rear element.
fn brute(case: &Case, point: [f64; 2], n: u32) -> f64 {
    case.irradiance(point, case.cover.seen_from(point), n, 80)
}

#[test]
fn nearly_every_sample_passes_and_nearly_nothing_is_missed() {
    for name in LENSES {
        for stop in STOPS {
            let case = Case::of(name, stop);
            assert_eq!(case.pupil.build_report().covered, 0.0, "{name} {stop:?}");
            let limit = 0.97 * case.lit_radius(CORNER);
            for i in 0..=9 {
                let height = limit * f64::from(i) / 9.0;
                let point = [0.6 * height, -0.8 * height];
                let (acceptance, missed) = case.fit(point, 240);
                let least = if name.starts_with("fisheye") { 0.975 } else { 0.985 };
                assert!(acceptance >= least, "{name} {stop:?} at {height}: {acceptance} pass");
                assert!(missed <= 6e-4, "{name} {stop:?} at {height}: misses {missed:e}");
            }
        }
    }
}

/// Returns a catalogue lens focused at infinity, and its film distance.
fn focused(name: &str, fnumber: Option<f64>) -> (Lens, f64) {
    let lens = lens_at(name, fnumber);
    let distance = Focus::new(&lens).expect("focal").film_distance(f64::INFINITY).expect("reachable");
    (lens, distance)
}

#[test]
fn film_without_width_has_the_pupil_of_the_axis() {
    let (lens, distance) = focused("dgauss.50mm", None);
    let on_axis = |reach: f64| {
        let case = Case::with_reach(&lens, distance, reach);
        case.pupil.sample([0.0; 2], [0.5, 0.0]).expect("lit")
    };
    let expected = on_axis(REACH);
    for reach in [0.0, f64::from_bits(1), 1e-300] {
        let found = on_axis(reach);
        assert!((found.area / expected.area - 1.0).abs() < 2e-3, "{found:?} {expected:?}");
        assert!((found.slopes[0] / expected.slopes[0] - 1.0).abs() < 1e-3, "{found:?} {expected:?}");
    }
}

#[test]
fn a_film_that_ends_just_inside_the_image_is_served_as_well() {
    for name in LENSES {
        for stop in STOPS {
            let (lens, distance) = focused(name, stop);
            let end = Case::with_reach(&lens, distance, 100.0).pupil.image_radius().expect("dark beyond");
            for part in [0.95, 0.99, 0.999] {
                let case = Case::with_reach(&lens, distance, part * end);
                for inner in [0.5, 0.8, 0.9, 0.97] {
                    let height = inner * part * end;
                    let (acceptance, missed) = case.fit([0.6 * height, -0.8 * height], 240);
                    assert!(acceptance >= 0.96, "{name} {stop:?} {part} {inner}: {acceptance} pass");
                    assert!(missed <= 2e-3, "{name} {stop:?} {part} {inner}: misses {missed:e}");
                }
            }
        }
    }
}

#[test]
fn the_image_ends_where_it_does_whatever_the_film() {
    for name in LENSES {
        for stop in [None, Some(22.0), Some(100.0), Some(1e3)] {
            let (lens, distance) = focused(name, stop);
            // The last crescents at the end of a fisheye's image may be lost, with less than a millionth of the light.
            let end = |reach| Case::with_reach(&lens, distance, reach).pupil.image_radius();
            let expected = end(100.0).expect("dark beyond");
            for reach in [1.001 * expected, 150.0, 200.0] {
                let found = end(reach).expect("dark beyond");
                assert!(
                    (found / expected - 1.0).abs() < 2e-5,
                    "{name} {stop:?} {reach}: {found}, {expected}"
                );
            }
        }
    }
}

#[test]
fn densities_are_positive_up_to_the_last_film_point() {
    for stop in STOPS {
        let case = Case::of("fisheye.10mm", stop);
        let end = case.pupil.image_radius().expect("dark beyond");
        assert!(case.pupil.sample([end * (1.0 + 1e-15), 0.0], [0.5, 0.5]).is_none());
        for height in (1..53).map(|bits| end * (1.0 - 0.5_f64.powi(bits))).chain([end.next_down()]) {
            for i in 0..33 {
                let phi = TAU * f64::from(i) / 64.0;
                // Rounding makes the end of the image uncertain.
                let Some(sample) = case.pupil.sample([height, 0.0], [phi.cos(), phi.sin()]) else { continue };
                assert!(sample.area > 0.0 && sample.area.is_finite(), "{stop:?} at {height}: {sample:?}");
            }
        }
    }
}

#[test]
fn a_pupil_that_ends_at_total_reflection_is_found() {
    for (what, text, distance) in [
        ("hemisphere", "10 10 1.5 19.9999999\ninf 0 1 19.9\n", 4.69),
        ("a thick ball of flint", "5 9.9 1.9 9.99\n-5 0 1 9.99\n", 30.0),
        ("very fast", "40 12 1.8 60\n200 0.5 1 60\n22 12 1.8 42\n40 0 1 34\n", 10.66),
    ] {
        let case = Case::with_film(&lens(text), distance);
        assert_eq!(case.pupil.build_report().covered, 0.0, "{what}");
        let limit = case.lit_radius(CORNER);
        for i in 0..9 {
            let height = limit * f64::from(i) / 9.0;
            let (acceptance, missed) = case.fit([0.6 * height, -0.8 * height], 240);
            assert!(acceptance >= 0.97, "{what} at {height}: {acceptance} pass");
            assert!(missed <= 2e-3, "{what} at {height}: misses {missed:e}");
        }
    }
}

#[test]
fn weights_average_to_the_irradiance_found_by_brute_force() {
    for name in LENSES {
        let case = Case::of(name, None);
        let limit = 0.97 * case.lit_radius(CORNER);
        for i in 0..=8 {
            // The heights include tabulated radii and others.
            let height = limit * f64::from(i) / 8.0;
            let point = [-height, 0.0];
            let mean = case.expected_weight(point, 300);
            // The light is integrated over the whole rear element, and more exactly near the map.
            let whole = brute(&case, point, 200);
            let near = case.irradiance(point, case.surroundings(point), 300, 80);
            for (truth, error) in [(whole, 4e-3), (near, 1e-3)] {
                assert!((mean / truth - 1.0).abs() < error, "{name} at {height}: {mean} is not {truth}");
            }
        }
        for stop in [8.0, 22.0] {
            let case = Case::of(name, Some(stop));
            for height in [0.0, 2.2, 7.7, 12.0] {
                let point = [height, 0.0];
                let truth = case.irradiance(point, case.surroundings(point), 300, 80);
                let mean = case.expected_weight(point, 200);
                assert!(
                    (mean / truth - 1.0).abs() < 1e-3,
                    "{name} f/{stop} at {height}: {mean} is not {truth}"
                );
            }
        }
    }
}

#[test]
fn the_variance_of_a_sample_is_that_of_the_exact_pupil() {
    // Minimum shares of the exact pupil that are sampled evenly: on the axis, half way to the corner, and in the
    // corner.
    let floors = [
        ("dgauss.50mm", [0.0011, 0.0040, 0.0048]),
        ("wide.22mm", [0.0003, 0.0088, 0.0090]),
        ("telephoto.250mm", [0.000_01, 0.000_06, 0.0002]),
        ("fisheye.10mm", [0.0001, 0.0023, f64::INFINITY]),
    ];
    for (name, floors) in floors {
        let case = Case::of(name, None);
        for (height, floor) in [0.0, CORNER / 2.0, CORNER].into_iter().zip(floors) {
            if floor.is_finite() {
                let (_, variance) = case.weight([height, 0.0], 100);
                assert!(variance <= floor + 0.006, "{name} at {height}: {variance}, floor {floor}");
            }
        }
    }
}

#[test]
fn the_map_s_density_is_its_jacobian() {
    let case = Case::of("wide.22mm", None);
    let point = [5.0, -9.3];
    let step = 1e-6;
    for (u, v) in grid(23) {
        let d = DiskMapping::Concentric.map(u, v).expect("never rejects");
        let at = |dx: f64, dy: f64| case.pupil.sample(point, [d[0] + dx, d[1] + dy]).expect("lit");
        let slope = |a: [f64; 2], b: [f64; 2]| [(a[0] - b[0]) / (2.0 * step), (a[1] - b[1]) / (2.0 * step)];
        let x = slope(at(step, 0.0).slopes, at(-step, 0.0).slopes);
        let y = slope(at(0.0, step).slopes, at(0.0, -step).slopes);
        let jacobian = (x[0] * y[1] - x[1] * y[0]) * TAU / 2.0;
        let got = at(0.0, 0.0).area;
        // At a knot, the difference quotient includes both sides.
        assert!((got / jacobian - 1.0).abs() < 1e-6 || on_knot(point, d), "{d:?}: {got} for {jacobian}");
    }
}

/// Whether a point of the disk lies within the difference quotient's reach of a radial slice's knot.
fn on_knot(point: [f64; 2], d: [f64; 2]) -> bool {
    let t = (d[1] * point[0] - d[0] * point[1]).abs() / point[0].hypot(point[1]);
    let position = 32.0 * (1.0 - (1.0 - t).max(0.0).sqrt());
    (position - position.round()).abs() < 1e-3
}

#[test]
fn the_pupil_s_area_changes_smoothly_with_film_radius() {
    for name in LENSES {
        let case = Case::of(name, None);
        let limit = case.lit_radius(REACH) * 0.99;
        let steps = 1500;
        let areas: Vec<f64> = (0..=steps)
            .map(|i| {
                let height = limit * f64::from(i) / f64::from(steps);
                let edge = (0..=360).map(|i| {
                    let phi = TAU * f64::from(i) / 360.0;
                    case.pupil.sample([height, 0.0], [phi.cos(), phi.sin()]).expect("lit").slopes
                });
                let edge: Vec<_> = edge.collect();
                edge.windows(2).map(|p| p[0][0] * p[1][1] - p[0][1] * p[1][0]).sum::<f64>() / 2.0
            })
            .collect();
        for (i, three) in areas.windows(3).enumerate() {
            let bend = (three[0] - 2.0 * three[1] + three[2]).abs() / areas[0];
            assert!(bend < 2e-3, "{name} step {i}: {bend:e}");
        }
    }
}

#[test]
fn for_fixed_lens_numbers_the_slope_is_continuous_over_the_film() {
    // Near the apex of the slices, slopes change faster with the azimuth than elsewhere.
    let numbers = [[0.0, 0.0], [1.0, 0.0], [-0.3, 0.6], [0.1, -0.9], [-0.7, -0.7], [0.0, 0.5]];
    for name in LENSES {
        let case = Case::of(name, None);
        let end = case.pupil.image_radius().unwrap_or(REACH);
        // Lines go through the axis, close to it, and far from it; every table radius lies on them.
        for offset in [0.0, 1e-9, 1e-3, 0.3, 5.0] {
            for [dx, dy] in [[1.0, 0.0], [0.6, 0.8], [-0.28, 0.96]] {
                for disk in numbers {
                    let at = |t: f64| {
                        let point = [t * dx - offset * dy, t * dy + offset * dx];
                        case.pupil.sample(point, disk).expect("lit").slopes
                    };
                    let half = 0.9 * (end * end - offset * offset).sqrt();
                    // The steepest change over a step, per mm, is the same for steps of a hundredth of the size: a jump
                    // would make it a hundred times as large.
                    let steepest = |step: f64, start: &dyn Fn(i32) -> f64| {
                        (-600..=600)
                            .map(|i| {
                                let t = start(i);
                                let ([ax, ay], [bx, by]) = (at(t), at(t + step));
                                (bx - ax).hypot(by - ay) / step
                            })
                            .fold(0.0, f64::max)
                    };
                    let coarse = half / 600.0;
                    let over_all = steepest(coarse, &|i| coarse * f64::from(i.min(599)));
                    let close = steepest(coarse / 100.0, &|i| coarse * (f64::from(i.min(599)) - 0.003));
                    let at_axis = steepest(1e-7, &|i| 1e-8 * f64::from(i));
                    let bound = 4.0 * over_all + 1e-4;
                    assert!(close <= bound, "{name} offset {offset} {disk:?}: {close} after {over_all}");
                    assert!(at_axis <= bound, "{name} offset {offset} {disk:?}: {at_axis} after {over_all}");
                }
            }
        }
    }
}

#[test]
fn there_are_no_jumps_where_film_radii_are_tabulated() {
    for name in LENSES {
        let case = Case::of(name, None);
        let end = case.pupil.image_radius();
        for cell in 1..508 {
            let s = f64::from(cell) / 512.0;
            let height = end.map_or(REACH * s, |end| end * s * (2.0 - s));
            for disk in [[0.5, 0.5], [-0.9, 0.1], [0.2, -0.95]] {
                let sample = |h: f64| case.pupil.sample([0.0, h], disk).expect("lit");
                let (below, above) = (sample(height * (1.0 - 1e-12)), sample(height * (1.0 + 1e-12)));
                let jump = (0..2).map(|i| (below.slopes[i] - above.slopes[i]).abs()).fold(0.0, f64::max);
                assert!(jump < 1e-9, "{name} at {height}: {jump:e}");
                assert!((below.area / above.area - 1.0).abs() < 1e-7, "{name} at {height}");
            }
        }
    }
}

#[test]
fn turning_film_point_and_lens_point_turns_the_slope() {
    let case = Case::of("dgauss.50mm", None);
    for (u, v) in grid(9) {
        let disk = DiskMapping::Concentric.map(u, v).expect("never rejects");
        let expected = case.pupil.sample([11.3, 0.0], disk).expect("lit");
        for angle in [0.4_f64, 2.0, -3.0] {
            let (sin, cos) = angle.sin_cos();
            let turn = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
            let got = case.pupil.sample(turn([11.3, 0.0]), turn(disk)).expect("lit");
            let [x, y] = turn(expected.slopes);
            assert!((got.slopes[0] - x).abs() < 1e-12 && (got.slopes[1] - y).abs() < 1e-12);
        }
    }
}

#[test]
fn nothing_is_sampled_beyond_the_image_circle() {
    let case = Case::of("fisheye.10mm", None);
    let end = case.pupil.image_radius().expect("an image circle");
    for height in [1.0001 * end, 1.05 * end, CORNER] {
        assert_eq!(case.pupil.sample([height, 0.0], [0.1, 0.2]), None);
        assert_eq!(brute(&case, [height, 0.0], 400), 0.0);
    }
    let mut before = f64::INFINITY;
    for height in [0.9, 0.96, 0.99, 0.999, 0.9999].map(|part| part * end) {
        // Lines run across the narrow side of the vignetted pupil.
        let point = [height, 0.0];
        let mean = case.expected_weight(point, 2000);
        let truth = case.irradiance(point, case.surroundings(point), 400, 1000);
        let axis = case.expected_weight([0.0; 2], 100);
        assert!((mean - truth).abs() < 1e-2 * truth + 5e-4 * axis, "{height}: {mean} is not {truth}");
        assert!(mean < before);
        before = mean;
    }
}

#[test]
fn a_pupil_in_two_pieces_is_named_and_unbiased() {
    // A ball focuses rays near its edge so much more closely than rays near the axis that the outer rays cross the axis
    // before the stop: the pupil is a disk with an annulus around it.
    let case = Case::with_film(&lens("0 60 0 6\n10 20 1.5 19\n-10 0 1 19\n"), 5.0);
    let edge = |from: f64, to: f64| {
        (0..400)
            .map(|i| from + (to - from) * f64::from(i) / 400.0)
            .filter(|&s| case.passes([0.0; 2], [s, 0.0]))
            .count()
    };
    let ring = edge(0.3, 2.0);
    assert!(case.passes([0.0; 2], [0.0; 2]) && ring > 0 && edge(0.0, 2.0) < 399, "no ring");
    assert!(!case.pupil.given_up().is_empty());
    for height in [0.0, 1.0, 2.6] {
        let point = [height, 0.0];
        let truth = case.irradiance(point, case.cover.seen_from(point), 300, 600);
        let (mean, _) = case.weight([height, 0.0], 500);
        assert!((mean / truth - 1.0).abs() < 0.01, "{height}: {mean} is not {truth}");
    }
}

#[test]
fn odd_lenses_and_films_keep_their_irradiance() {
    let planar = String::from_utf8_lossy(include_bytes!("../golden/planar.dat"));
    let cases = [
        ("planar", planar.as_ref(), 40.0),
        ("one surface", "0 0 1 20\n", 60.0),
        ("singlet", "40 6 1.6 24\n-60 0 1 24\n", 45.0),
        ("film near", "40 6 1.6 24\n-60 0 1 24\n", 8.0),
        ("film far", "40 6 1.6 24\n-60 0 1 24\n", 4000.0),
    ];
    for (what, text, distance) in cases {
        let case = Case::with_film(&lens(text), distance);
        for height in [0.0, 4.0, 9.5, 16.0] {
            let point = [0.0, height];
            let truth = brute(&case, point, 400);
            // A pupil with several components has no single edge along a half-line; a finer grid is used instead.
            let whole = case.pupil.given_up().is_empty();
            let got = if whole { case.expected_weight(point, 200) } else { case.weight(point, 300).0 };
            let bound = if whole { 1e-3 } else { 5e-3 };
            assert!((got - truth).abs() <= bound * truth, "{what} at {height}: {got} is not {truth}");
        }
        println!("{what}: {:?}", case.pupil.build_report());
    }
}

fn camera(lens: &str, pupil: &str, weighting: &str) -> Camera {
    let mut given = Parameters::default();
    for (name, value) in [("lens_file", lens), ("pupil", pupil), ("weighting", weighting)] {
        given.set(name, Value::Text(value)).expect("a parameter");
    }
    let host = Host::new(Raster { xres: 300, yres: 200 }, None);
    Camera::build(&given, &host, &mut |_, _| {}).expect("built")
}

/// Returns evenly distributed numbers in [0, 1).
fn random_numbers() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn single_precision_samples_and_weighs_as_double_precision_does() {
    for name in LENSES {
        let [single, double] = ["f32", "f64"].map(|precision| {
            let mut given = Parameters::default();
            given.set("lens_file", Value::Text(name)).expect("a parameter");
            given.set("precision", Value::Text(precision)).expect("a parameter");
            let host = Host::new(Raster { xres: 300, yres: 200 }, None);
            Camera::build(&given, &host, &mut |_, _| {}).expect("built")
        });
        let mut random = random_numbers();
        let (mut rays, mut odd, mut direction, mut sums) = (0, 0, 0.0_f64, [0.0; 2]);
        let mut weights = Vec::new();
        for _ in 0..40_000 {
            let [x, y, lens_u, lens_v] = std::array::from_fn(|_| random() as f32);
            let sample = Sample { image_x: 300.0 * x, image_y: 200.0 * y, lens_u, lens_v, time: 0.0 };
            let (Some((a, wa)), Some((b, wb))) = (single.ray(&sample), double.ray(&sample)) else {
                odd += i32::from(single.ray(&sample).is_some() != double.ray(&sample).is_some());
                continue;
            };
            rays += 1;
            for (a, b) in a.direction.iter().zip(b.direction) {
                direction = direction.max(f64::from(a - b).abs());
            }
            weights.push(f64::from(wa - wb).abs());
            sums = [sums[0] + f64::from(wa), sums[1] + f64::from(wb)];
        }
        // Densities differ between cells, and some samples lie in one cell in one precision and in a neighbouring cell
        // in the other precision.
        weights.sort_by(f64::total_cmp);
        let weight = weights[weights.len() * 999 / 1000];
        // The errors are relative to the mean weight: near the edge of the image circle the pupil vanishes like a
        // square root.
        let (weight, bias) = (weight * f64::from(rays) / sums[1], (sums[0] / sums[1] - 1.0).abs());
        println!(
            "{name}: {rays} rays, {odd} odd, direction {direction:.1e}, weight {weight:.1e}, mean {bias:.1e}"
        );
        assert!(odd <= 4, "{name}: {odd} pass in one precision only");
        assert!(direction < 1e-5 && weight < 1e-4 && bias < 1e-6, "{name}");
    }
}

/// Returns the mean weight at a raster point and its standard error, from independent samples.
fn mean_weight(camera: &Camera, [x, y]: [f32; 2], n: u32) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    let mut random = random_numbers();
    for _ in 0..n * n {
        let (u, v) = (random(), random());
        let sample = Sample { image_x: x, image_y: y, lens_u: u as f32, lens_v: v as f32, time: 0.0 };
        if let Outcome::Ray(_, weight) = camera.generate(&sample, None) {
            sum += f64::from(weight);
            squares += f64::from(weight).powi(2);
        }
    }
    let count = f64::from(n * n);
    let mean = sum / count;
    (mean, ((squares / count - mean * mean) / count).sqrt())
}

#[test]
fn rear_and_warped_cameras_estimate_the_same() {
    for name in LENSES {
        for weighting in ["radiometric", "relative"] {
            let (rear, warped) = (camera(name, "rear", weighting), camera(name, "warped", weighting));
            for point in [[150.0, 100.0], [80.0, 60.0], [1.0, 1.0]] {
                let ((a, error_a), (b, error_b)) =
                    (mean_weight(&rear, point, 120), mean_weight(&warped, point, 60));
                let bound = 3.0 * error_a.hypot(error_b);
                assert!((a - b).abs() <= bound, "{name} {weighting} at {point:?}: rear {a}, warped {b}");
            }
        }
    }
}

/// Returns lenses with extreme rear surfaces: a hemisphere toward the film; an annulus of light with a spot of light in
/// it; and random ones.
fn extreme_lenses() -> Vec<(String, f64, f64)> {
    let hemisphere = "-9.9737422869413361 2.0812484981620099 N-SF6 - 8.6950018138273037\n\
                      -3.9679327615756974 13.329931531600767 - - 7.9358655231513948\n";
    let ring = "10.615589008892888 2.7078542907167704 1.4617308618820566 70.62 6.9734879586013738\n\
                45346.66759562245 2.4451186804880893 - - 7.7098693845099326\n\
                -17.297829051283266 0 1.6152926048168308 28.02 6.1785529246425037\n\
                -15.792749203288844 0 - - 8.1968489055971698\n\
                asphere 4 conic=-1.85374 A2=-0.000563074976 A6=4.23157434e-05 A20=3.1017374e-15\n";
    let mut all = vec![(hemisphere.to_owned(), 3.447, 14.0), (ring.to_owned(), 12.0, 10.0)];
    let mut random = random_numbers();
    for _ in 0..10 {
        let rear = 4.0 + 6.0 * random();
        let front = 6.0 + 30.0 * random();
        let index = 1.45 + 0.4 * random();
        let aperture = 2.0 * rear * (0.9 + 0.099 * random());
        let thickness = 1.0 + 4.0 * random();
        let text = format!("{front} {thickness} {index} {}\n-{rear} 0 1 {aperture}\n", 1.2 * rear);
        all.push((text, rear * (1.05 + random()), 12.0));
    }
    all
}

#[test]
fn whatever_the_rear_surface_the_mean_is_that_of_the_rear_disk() {
    let mut compared = 0;
    for (text, distance, reach) in extreme_lenses() {
        let lens = lens(&text);
        let Some(case) = Case::try_reach(&lens, distance, reach) else { continue };
        let axis = brute(&case, [0.0; 2], 300);
        for part in [0.0, 0.2, 0.39, 0.44, 0.5, 0.555, 0.7, 0.88, 0.94] {
            let point = [part * reach, 0.0];
            let (truth, (mean, _)) = (brute(&case, point, 400), case.weight(point, 250));
            let mean = if mean.is_nan() { 0.0 } else { mean };
            assert!(
                (mean - truth).abs() <= 0.02 * truth + 1e-3 * axis,
                "{text}film {distance} mm, {point:?}: {mean} is not {truth}; {:?}",
                case.pupil.given_up()
            );
            compared += u32::from(truth > 0.0);
        }
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn dark_film_is_blocked_with_a_complete_substitute_ray() {
    let camera = camera("fisheye.10mm", "warped", "radiometric");
    let sample = Sample { image_x: 1.0, image_y: 1.0, lens_u: 0.3, lens_v: 0.6, time: 0.0 };
    assert_eq!(camera.generate(&sample, None), Outcome::Blocked(Blocked::Clipped));
    let ray = camera.substitute(&sample);
    let length: f32 = ray.direction.iter().map(|x| x * x).sum();
    assert!((length - 1.0).abs() < 1e-5);
}

#[test]
fn weighting_assignment_is_the_literal_formula_of_the_disk() {
    let (warped, disk) =
        (camera("telephoto.250mm", "warped", "assignment"), camera("telephoto.250mm", "disk", "assignment"));
    // On the axis of this lens the thick lens's pupil is nearly the true one.
    let ((a, _), (b, _)) = (mean_weight(&warped, [150.0, 100.0], 60), mean_weight(&disk, [150.0, 100.0], 60));
    assert!((a / b - 1.0).abs() < 0.03, "{a} is not {b}");
}

#[test]
fn weighting_assignment_of_another_pupil_is_another_exposure() {
    // As docs/parameters.md states, the rear element's clear aperture is smaller than the exit pupil by this factor.
    let [rear, warped] = ["rear", "warped"].map(|pupil| {
        let camera = camera("dgauss.50mm", pupil, "assignment");
        mean_weight(&camera, [150.0, 100.0], 300).0
    });
    assert!((rear / warped - 4.79).abs() < 0.02, "{}", rear / warped);
}

/// Returns the RMS over many half-planes of (share of the points - share of the pupil).
fn discrepancy(points: &[[f64; 2]], reference: &[[f64; 2]]) -> f64 {
    let share = |set: &[[f64; 2]], n: [f64; 2], c: f64| {
        set.iter().filter(|p| p[0] * n[0] + p[1] * n[1] < c).count() as f64 / set.len() as f64
    };
    let mut sum = 0.0;
    for i in 0..40 {
        let angle = TAU * f64::from(i) * 0.618_034;
        let n = [angle.cos(), angle.sin()];
        let through = reference[(i as usize * 7919) % reference.len()];
        let c = through[0] * n[0] + through[1] * n[1];
        sum += (share(points, n, c) - share(reference, n, c)).powi(2);
    }
    (sum / 40.0).sqrt()
}

#[test]
fn stratified_lens_numbers_stay_stratified_in_the_pupil() {
    println!(
        "RMS half-plane discrepancy of 256 points: stratified through the warped pupil, independent, ratio"
    );
    for name in LENSES {
        let case = Case::of(name, None);
        for height in [0.0, 6.0, 12.0] {
            let map = |u: f64, v: f64| {
                let disk = DiskMapping::Concentric.map(u, v).expect("never rejects");
                case.pupil.sample([height, 0.0], disk).expect("lit").slopes
            };
            let reference: Vec<_> = grid(200).map(|(u, v)| map(u, v)).collect();
            let mut random = random_numbers();
            let (mut stratified, mut independent) = (0.0, 0.0);
            for _ in 0..8 {
                let jittered: Vec<_> = grid(16)
                    .map(|(u, v)| map(u + (random() - 0.5) / 16.0, v + (random() - 0.5) / 16.0))
                    .collect();
                let free: Vec<_> = (0..256).map(|_| map(random(), random())).collect();
                stratified += discrepancy(&jittered, &reference).powi(2);
                independent += discrepancy(&free, &reference).powi(2);
            }
            let (stratified, independent) = ((stratified / 8.0_f64).sqrt(), (independent / 8.0_f64).sqrt());
            println!("{name} {height}: {stratified:.4} {independent:.4} {:.2}", stratified / independent);
            assert!(stratified < 0.5 * independent, "{name} at {height}: {stratified} of {independent}");
        }
    }
}
