//! The mean of the weights equals the film's irradiance: in a scene of uniform radiance 1, the integral E(x') = ∫
//! cos⁴θ'/Z² dA over the rear element is computed independently, from each ray on a fine grid.

use super::support;

use std::f64::consts::PI;

use ::realistic_camera::{
    Camera, Outcome, Parameters,
    sampling::{DiskMapping, PupilDisk},
};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    trace::{Path, Ray},
};
use support::{LENSES, Random, build, camera, host, host_with, lens, lens_of, sample};

/// The axis, a point half way to the corner, and the corner.
const FIELD: [[f32; 2]; 3] = [[200.0, 150.0], [100.0, 75.0], [0.0, 0.0]];

fn film_z(camera: &Camera) -> f64 {
    camera.facts().expect("a lens").lens.rear().vertex - camera.facts().expect("a lens").film_distance
}

/// Integrates over a square about the rear element in the rear vertex plane: over the whole square, and over the part
/// whose slopes satisfy `inside`.
fn brute_force(camera: &Camera, image: [f32; 2], inside: impl Fn([f64; 2]) -> bool) -> [f64; 2] {
    const N: u32 = 900;
    let (lens, film) = (&camera.facts().expect("a lens").lens, film_z(camera));
    let path = Path::<f64>::film_to_scene(lens);
    let [x, y] = camera.facts().expect("a lens").film.point(image[0].into(), image[1].into());
    let distance = lens.rear().vertex - film;
    let half = 1.6 * lens.rear().semi_diameter;
    let step = 2.0 * half / f64::from(N);
    let at = |i: u32| (f64::from(i) + 0.5) * step - half;
    let mut sums = [0.0, 0.0];
    // Points are random in their cells: midpoints would sample the symmetric edge of a circle identically in eight
    // octants.
    let mut random = Random::new(12);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let [px, py] = [i, j].map(|i| at(i) + step * (random.next() - 0.5));
        let direction = [px - x, py - y, distance];
        if path.trace(Ray { origin: [x, y, film], direction }).is_err() {
            continue;
        }
        assert!(px.hypot(py) < 0.95 * half, "the square is too small");
        let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        let share = (distance / length).powi(4) * (step / distance).powi(2);
        sums[0] += share;
        if inside([direction[0] / distance, direction[1] / distance]) {
            sums[1] += share;
        }
    }
    sums
}

/// Returns the mean weight of stratified lens samples and its standard error, from independent shifts of the strata. A
/// sample for which the result is `Redraw` is replaced by another and does not count.
fn mean_weight(camera: &Camera, image: [f32; 2], seed: u64) -> [f64; 2] {
    const SHIFTS: u32 = 16;
    const STRATA: u32 = 96;
    let mut random = Random::new(seed);
    let means: Vec<f64> = (0..SHIFTS)
        .map(|_| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (i, j) in (0..STRATA).flat_map(|i| (0..STRATA).map(move |j| (i, j))) {
                let mut stratum = |i: u32| ((f64::from(i) + random.next()) / f64::from(STRATA)) as f32;
                match camera.generate(&sample(image, [stratum(i), stratum(j)]), None) {
                    Outcome::Ray(_, weight) => sum += f64::from(weight),
                    Outcome::Blocked(_) | Outcome::Shut | Outcome::Wavelength => {}
                    Outcome::Redraw => continue,
                }
                count += 1.0;
            }
            sum / count
        })
        .collect();
    let n = f64::from(SHIFTS);
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

#[track_caller]
fn agree(what: &str, [mean, error]: [f64; 2], expected: f64) {
    // The bound is five standard errors plus the error of the grid.
    let allowed = 5.0 * error + 5e-4 * expected;
    println!("{what}: {mean:.7} ± {error:.1e}, expected {expected:.7}");
    assert!(
        expected > 0.0 && (mean - expected).abs() < allowed,
        "{what}: {mean} ± {error} is not {expected}"
    );
}

#[test]
fn rear_gives_the_whole_irradiance_and_disk_its_part() {
    for (name, diagonal) in LENSES {
        let of = |pupil| {
            let given = [("lens_file", name), ("film_diagonal", diagonal), ("pupil", pupil)];
            build(&host(), &given).unwrap_or_else(|error| panic!("{error}")).0
        };
        let (rear, disk) = (of("rear"), of("disk"));
        let film = film_z(&rear);
        let exit = PupilDisk::exit(&rear.facts().expect("a lens").lens, film);
        for (number, image) in FIELD.into_iter().enumerate() {
            let [x, y] = rear.facts().expect("a lens").film.point(image[0].into(), image[1].into());
            let seen = exit.seen_from([x, y]);
            let inside = |[sx, sy]: [f64; 2]| (sx - seen.center[0]).hypot(sy - seen.center[1]) <= seen.radius;
            let [whole, part] = brute_force(&rear, image, inside);
            agree(&format!("{name}, rear, field {number}"), mean_weight(&rear, image, 1), whole);
            agree(&format!("{name}, disk, field {number}"), mean_weight(&disk, image, 2), part);
        }
    }
}

#[test]
fn a_rear_element_that_bulges_away_is_sampled_to_its_edge() {
    // The edge lies behind the vertex and appears outside the clear diameter from the far side of the film.
    let text = "22 5 1.6 40\n20 0 1 34\n";
    let host = host_with(text);
    let given = [("film_distance", "25"), ("film_diagonal", "30")];
    let (camera, warnings) = build(&host, &given).expect("a camera");
    assert_eq!(warnings, [""; 0]);
    for (number, image) in FIELD.into_iter().enumerate() {
        let whole = over_the_sphere(&camera, image);
        agree(&format!("field {number}"), mean_weight(&camera, image, 3), whole);
    }
}

/// Integrates over the rear surface itself, without a plane or a disk: ∫ cosθ' cosη/d² dA over points of the sphere,
/// where η is the angle at the surface.
fn over_the_sphere(camera: &Camera, image: [f32; 2]) -> f64 {
    const N: u32 = 600;
    let (lens, film) = (&camera.facts().expect("a lens").lens, film_z(camera));
    let path = Path::<f64>::film_to_scene(lens);
    let rear = lens.rear();
    let [x, y] = camera.facts().expect("a lens").film.point(image[0].into(), image[1].into());
    let step = 2.0 * rear.semi_diameter / f64::from(N);
    let at = |i: u32| (f64::from(i) + 0.5) * step - rear.semi_diameter;
    let mut sum = 0.0;
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let (px, py) = (at(i), at(j));
        let height = px.hypot(py);
        if height > rear.semi_diameter {
            continue;
        }
        let direction = [px - x, py - y, rear.vertex + rear.sagitta(height) - film];
        if path.trace(Ray { origin: [x, y, film], direction }).is_err() {
            continue;
        }
        // N dA = (-∂z/∂x, -∂z/∂y, 1) dx dy, and ∂z/∂r = -c r/sqrt(1 - c² r²).
        let slope = -rear.curvature / (1.0 - (rear.curvature * height).powi(2)).sqrt();
        let area = direction[2] - slope * (px * direction[0] + py * direction[1]);
        let square = direction.iter().map(|d| d * d).sum::<f64>();
        sum += direction[2] * area / (square * square) * step * step;
    }
    sum
}

#[test]
fn the_weightings_have_their_documented_ratios() {
    for pupil in ["rear", "disk"] {
        let of = |weighting| {
            let given = [("pupil", pupil), ("weighting", weighting), ("film_distance", "40")];
            build(&host(), &given).expect("a camera").0
        };
        let [radiometric, assignment, relative, none] =
            ["radiometric", "assignment", "relative", "none"].map(of);
        let (lens, film) = (lens("dgauss.50mm"), film_z(&radiometric));
        let disk = match pupil {
            "rear" => PupilDisk::rear(&lens, film, radiometric.facts().expect("a lens").film.reach())
                .expect("film behind the lens"),
            _ => PupilDisk::exit(&lens, film),
        };
        let z = match pupil {
            "rear" => 40.0,
            _ => -disk.seen_from([1.0, 0.0]).center[0].recip(),
        };
        // The literal formula divides by the area of the disk in the lens table.
        let divisor = match pupil {
            "rear" => PI * lens.rear().semi_diameter.powi(2),
            _ => disk.area().expect("finite"),
        };
        let enlarged = disk.area().expect("finite") / divisor;
        let on_axis = mean_weight(&radiometric, FIELD[0], 4)[0];
        let mut random = Random::new(5);
        let mut passed = 0;
        for _ in 0..2000 {
            let image = [400.0 * random.next() as f32, 300.0 * random.next() as f32];
            let lens_sample = [random.next() as f32, random.next() as f32];
            let weight = |camera: &Camera| match camera.generate(&sample(image, lens_sample), None) {
                Outcome::Ray(_, weight) => Some(f64::from(weight)),
                _ => None,
            };
            let Some(full) = weight(&radiometric) else {
                for other in [&assignment, &relative, &none] {
                    assert_eq!(weight(other), None);
                }
                continue;
            };
            passed += 1;
            let seen = disk
                .seen_from(radiometric.facts().expect("a lens").film.point(image[0].into(), image[1].into()));
            let [u, v] = DiskMapping::Concentric
                .map(lens_sample[0].into(), lens_sample[1].into())
                .expect("never redraws");
            let [sx, sy] = [seen.center[0] + seen.radius * u, seen.center[1] + seen.radius * v];
            let literal = enlarged * (1.0 + sx * sx + sy * sy).powi(-2) / (z * z);
            let [literally, relatively] = [&assignment, &relative].map(|c| weight(c).expect("it passes"));
            assert!((literally / literal - 1.0).abs() < 1e-6, "{pupil}: {literally} is not {literal}");
            assert!((full / literally / divisor - 1.0).abs() < 1e-6);
            assert!((full / relatively / on_axis - 1.0).abs() < 1e-3);
            assert_eq!(weight(&none), Some(1.0));
        }
        assert!(passed > 500);
    }
}

#[test]
fn the_films_size_is_not_in_the_assignments_exposure() {
    let settings = |diagonal| {
        let given = [("lens_file", "wide.22mm"), ("pupil", "rear"), ("weighting", "assignment")];
        [&given[..], &[("film_diagonal", diagonal), ("film_distance", "14.4")]].concat()
    };
    let cameras = ["12", "35"].map(|diagonal| {
        let mut messages = Vec::new();
        let mut parameters = Parameters::default();
        for (name, text) in settings(diagonal) {
            parameters.set_from_text(name, text).expect("a parameter");
        }
        let camera = Camera::build(&parameters, &host(), &mut |_, text| messages.push(text.to_owned()));
        (camera.expect("a camera"), messages)
    });
    let [(small, small_messages), (large, large_messages)] = &cameras;
    let semi_diameter = small.facts().expect("a lens").lens.rear().semi_diameter;

    // The film points are the same on both films: on the axis, and 4 mm from it.
    for height in [0.0, 4.0] {
        let at = |camera: &Camera| {
            let pixel = camera.facts().expect("a lens").film.diagonal() / 500.0;
            let image = [(200.0 - height / pixel) as f32, 150.0];
            let [x, y] = camera.facts().expect("a lens").film.point(image[0].into(), image[1].into());
            assert!((x - height).abs() < 1e-5 && y.abs() < 1e-5);
            mean_weight(camera, image, 12)
        };
        let (found, expected) = (at(large), at(small));
        agree(&format!("assignment, {height} mm from the axis"), found, expected[0]);
    }

    // Small film receives light through the whole clear aperture within the table's disk, so there is no warning; large
    // film does not, and there is one.
    assert!(!small_messages.iter().any(|text| text.contains("pupil \"rear\"")), "{small_messages:?}");
    let ratio = (PupilDisk::rear(
        &large.facts().expect("a lens").lens,
        film_z(large),
        large.facts().expect("a lens").film.reach(),
    )
    .and_then(|disk| disk.area())
    .expect("finite"))
        / (PI * semi_diameter.powi(2));
    assert!(ratio > 1.4, "{ratio}");
    let factor = format!("divide by {ratio:.4} for the formula itself");
    assert!(large_messages.iter().any(|text| text.contains(&factor)), "{large_messages:?}");

    // Each ray has the weight cos⁴/Z², up to rounding: on small film directly, and on large film after the division.
    let mut random = Random::new(8);
    for (camera, radius, divisor) in
        [(small, semi_diameter, 1.0), (large, semi_diameter * ratio.sqrt(), ratio)]
    {
        let mut passed = 0;
        for _ in 0..6000 {
            let image = [400.0 * random.next() as f32, 300.0 * random.next() as f32];
            let lens_sample = [random.next() as f32, random.next() as f32];
            let Outcome::Ray(_, weight) = camera.generate(&sample(image, lens_sample), None) else {
                continue;
            };
            let [x, y] = camera.facts().expect("a lens").film.point(image[0].into(), image[1].into());
            let [u, v] = DiskMapping::Concentric
                .map(lens_sample[0].into(), lens_sample[1].into())
                .expect("never redraws");
            let z = 14.4;
            let [sx, sy] = [(radius * u - x) / z, (radius * v - y) / z];
            let formula = (1.0 + sx * sx + sy * sy).powi(-2) / (z * z);
            assert!((f64::from(weight) / divisor / formula - 1.0).abs() < 2e-6, "{weight} {formula}");
            passed += 1;
        }
        assert!(passed > 100, "{passed}");
    }
}

#[test]
fn relative_is_one_on_the_axis_with_either_pupil() {
    for (name, diagonal) in LENSES {
        for pupil in ["rear", "disk"] {
            let given = [
                ("lens_file", name),
                ("film_diagonal", diagonal),
                ("pupil", pupil),
                ("weighting", "relative"),
            ];
            let camera = build(&host(), &given).expect("a camera").0;
            agree(&format!("{name}, {pupil}"), mean_weight(&camera, FIELD[0], 6), 1.0);
        }
    }
}

#[test]
fn the_maps_to_the_disk_agree_in_the_mean() {
    for image in FIELD {
        let [concentric, polar, rejection] = ["concentric", "polar", "rejection"]
            .map(|disk| mean_weight(&camera(&[("disk", disk)]), image, 7));
        for other in [polar, rejection] {
            agree("map", [other[0], other[1].hypot(concentric[1])], concentric[0]);
        }
    }
}

/// Returns a plano-convex lens of 50 mm with a stop before it, `beyond` mm farther than the front focal point.
fn with_stop_at_the_front_focus(beyond: f64) -> String {
    let glass = "25.84 4 1.5168 30\n0 0 1 30\n";
    let focus = FirstOrder::of(&lens_of(glass)).expect("focal").front_focal_point;
    format!("0 {} 0 4\n{glass}", focus + beyond)
}

#[test]
fn a_pupil_at_infinity_or_behind_the_film_is_sampled_in_slopes() {
    for (beyond, position) in [(0.0, "at infinity"), (20.0, "behind the film"), (-20.0, "before the film")] {
        let text = with_stop_at_the_front_focus(beyond);
        let host = host_with(&text);
        let of = |pupil| build(&host, &[("pupil", pupil), ("film_diagonal", "8")]).expect("a camera").0;
        let (rear, disk) = (of("rear"), of("disk"));
        let film = film_z(&rear);
        let vergence =
            -PupilDisk::exit(&rear.facts().expect("a lens").lens, film).seen_from([1.0, 0.0]).center[0];
        match position {
            "at infinity" => assert!(vergence.abs() < 1e-12, "{vergence}"),
            "behind the film" => assert!(vergence < -1e-3, "{vergence}"),
            _ => assert!(vergence > 1e-3, "{vergence}"),
        }
        for (number, image) in FIELD.into_iter().enumerate() {
            let [x, y] = rear.facts().expect("a lens").film.point(image[0].into(), image[1].into());
            let seen = PupilDisk::exit(&rear.facts().expect("a lens").lens, film).seen_from([x, y]);
            let inside = |[sx, sy]: [f64; 2]| (sx - seen.center[0]).hypot(sy - seen.center[1]) <= seen.radius;
            let grid = fine_grid(
                &rear.facts().expect("a lens").lens,
                film,
                [x, y],
                seen.center,
                1.3 * seen.radius,
                inside,
            );
            let whole = mean_weight(&rear, image, 8);
            agree(&format!("{position}, disk, field {number}"), mean_weight(&disk, image, 9), grid[1]);
            assert!((whole[0] - grid[0]).abs() < 5.0 * whole[1] + 1e-3 * grid[0], "{whole:?} {grid:?}");
            // For a slow stop, the thick lens is nearly right on the axis.
            assert!(number > 0 || grid[1] > 0.97 * grid[0], "{position}: {grid:?}");
        }
        let literal = build(&host, &[("pupil", "disk"), ("weighting", "assignment"), ("film_diagonal", "8")]);
        if position == "at infinity" {
            let refusal = literal.expect_err("no Z").to_string();
            assert!(refusal.contains("at infinity") && refusal.contains("\"rear\""), "{refusal}");
        } else {
            literal.expect("a camera");
        }
    }
}

/// Integrates over a small square of slopes: over the whole square, and over the part inside.
fn fine_grid(
    lens: &Lens,
    film: f64,
    [x, y]: [f64; 2],
    center: [f64; 2],
    half: f64,
    inside: impl Fn([f64; 2]) -> bool,
) -> [f64; 2] {
    const N: u32 = 500;
    let path = Path::<f64>::film_to_scene(lens);
    let step = 2.0 * half / f64::from(N);
    let at = |i: u32| (f64::from(i) + 0.5) * step - half;
    let mut sums = [0.0, 0.0];
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let slopes = [center[0] + at(i), center[1] + at(j)];
        let ray = Ray { origin: [x, y, film], direction: [slopes[0], slopes[1], 1.0] };
        if path.trace(ray).is_ok() {
            let share = step * step / (1.0 + slopes[0].powi(2) + slopes[1].powi(2)).powi(2);
            sums[0] += share;
            sums[1] += if inside(slopes) { share } else { 0.0 };
        }
    }
    sums
}

#[test]
fn the_warning_says_what_the_disk_misses_of_a_fisheye() {
    let of = |pupil| build(&host(), &[("lens_file", "fisheye.16mm"), ("pupil", pupil)]).expect("a camera");
    let (disk, warnings) = of("disk");
    let [warning] = warnings.as_slice() else { panic!("{warnings:?}") };
    let percentage = |phrase: &str| -> f64 {
        let (before, _) = warning.split_once(phrase).expect("it speaks of the place");
        before.rsplit(' ').next().and_then(|word| word.parse().ok()).expect("a number")
    };
    assert_eq!(percentage(" % of the light on the axis"), 0.0, "{warning}");
    assert!(percentage(" % in the corner") > 0.3 && warning.contains("misses none"), "{warning}");
    // The reported loss equals the measured one.
    let [[part, part_error], [whole, whole_error]] =
        [&disk, &of("rear").0].map(|camera| mean_weight(camera, FIELD[2], 10));
    let (missed, noise) = (100.0 * (1.0 - part / whole), 100.0 * (part_error + whole_error) / whole);
    assert!(
        (missed - percentage(" % in the corner")).abs() < 0.1 + 5.0 * noise,
        "{missed} % against: {warning}"
    );
    // Stopped down, the disk contains the whole pupil.
    let (_, warnings) =
        build(&host(), &[("pupil", "disk"), ("fnumber", "16"), ("film_diagonal", "4")]).expect("a camera");
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn irradiance_falls_as_the_square_of_the_f_number() {
    // On the axis E = π sin²θ', and sin θ' = 1/(2 N) for a lens without coma focused at infinity.
    for number in [4.0, 5.6, 8.0, 16.0] {
        let camera = camera(&[("fnumber", &f64::to_string(&number))]);
        let [mean, error] = mean_weight(&camera, FIELD[0], 11);
        let expected = PI / (4.0 * number * number);
        println!("f/{number}: {mean:.6} ± {error:.1e}, {expected:.6}");
        assert!((mean / expected - 1.0).abs() < 0.01, "f/{number}: {mean} ± {error}, {expected}");
    }
}
