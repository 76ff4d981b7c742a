//! The tracer and first-order optics against independent tables, made by exact arithmetic (70 digits) and by the
//! programs optiland and rayoptics. `golden/README.md` describes how the tables were made.

use super::tables;

use realistic_optics::{
    lens::{Lens, first_order::FirstOrder, pupil},
    prescription::catalogue,
    trace::{Direction, Path, Ray, Real},
};
use tables::{LENSES, difference, lens, numbers, outcome, ray, table};

/// Returns the largest position (mm) and direction (rad) errors of the passing rays of one table.
fn against_truth<R: Real>(file: &str, path: &Path<R>, least_margin: f64) -> (f64, f64) {
    let (mut position, mut direction) = (0.0_f64, 0.0_f64);
    for (number, row) in table(file).iter().enumerate() {
        if row[13].parse::<f64>().expect("a margin") < least_margin {
            continue;
        }
        let expected = outcome(&row[12]);
        let walk = path.walk(ray(numbers(&row[..6])));
        assert_eq!(walk.blocked, expected, "{file}, ray {number}: {row:?}");
        if expected.is_none() {
            let (p, d) = difference(walk.ray, ray(numbers(&row[6..12])));
            position = position.max(p);
            direction = direction.max(d);
        }
    }
    (position, direction)
}

#[test]
fn double_precision_is_within_1e_14_of_the_exact_rays_both_ways() {
    for name in LENSES {
        let lens = lens(name, 587.56);
        for (prefix, direction) in
            [("truth_", Direction::FilmToScene), ("truth_scene_", Direction::SceneToFilm)]
        {
            for (method, refraction) in realistic_optics::lens::refraction::Refraction::NAMES {
                let path = Path::<f64>::new(&lens, direction, refraction);
                let (p, d) = against_truth(&format!("{prefix}{name}.csv"), &path, 0.0);
                println!("{prefix}{name} {method}: {p:.1e} mm, {d:.1e} rad");
                assert!(p < 1e-12 && d < 1e-14, "{prefix}{name} {method}: {p:e} mm, {d:e} rad");
            }
        }
    }
}

#[test]
fn single_precision_is_within_1e_6_of_the_exact_rays() {
    for name in LENSES {
        let path = Path::<f32>::film_to_scene(&lens(name, 587.56));
        let (p, d) = against_truth(&format!("truth_{name}.csv"), &path, 1e-4);
        println!("{name}: {p:.1e} mm, {d:.1e} rad");
        assert!(p < 2e-4 && d < 5e-6, "{name}: {p:e} mm, {d:e} rad");
    }
}

#[test]
fn real_rays_agree_with_optiland_and_rayoptics() {
    for file in ["rays_optiland.csv", "rays_rayoptics.csv"] {
        let rows = table(file);
        assert!(rows.len() > 500);
        for row in rows {
            let lens = lens(&row[0], row[1].parse().expect("a wavelength"));
            let got = Path::<f64>::scene_to_film(&lens).trace(ray(numbers(&row[2..8])));
            let expected = ray(numbers(&row[8..14]));
            let (p, d) = difference(got.unwrap_or_else(|why| panic!("{row:?}: {why}")), expected);
            assert!(p < 1e-12 && d < 1e-13, "{file} {row:?}: {p:e} mm, {d:e} rad");
        }
    }
}

#[test]
fn first_order_data_agree_with_optiland_and_rayoptics() {
    let rows = table("first_order.csv");
    assert!(rows.len() > 100);
    for row in rows {
        let [name, wavelength, program, _, quantity, value] = row.as_slice() else {
            panic!("{row:?} has not six fields");
        };
        let lens = lens(name, wavelength.parse().expect("a wavelength"));
        let own = FirstOrder::of(&lens).expect("focal");
        let stop = lens.stop_index().expect("every lens of the table has a stop");
        let entrance = pupil::EntrancePupil::of_surface(&lens, stop);
        let exit = pupil::ExitPupil::of_surface(&lens, stop);
        let from_rear = |z: f64| own.rear_vertex - z;
        let got = match quantity.as_str() {
            "focal_length" => own.focal_length,
            "back_focal_distance" => own.back_focal_distance(),
            "front_focal_distance" => -own.front_focal_point,
            "front_principal_plane" => -own.front_principal_plane,
            "rear_principal_plane" => from_rear(own.rear_principal_plane),
            "entrance_pupil_position" => -entrance.position().expect("finite"),
            "entrance_pupil_diameter" => entrance.diameter(),
            "exit_pupil_position" => from_rear(exit.position().expect("finite")),
            "exit_pupil_diameter" => exit.diameter(),
            "f_number" => own.focal_length / entrance.diameter(),
            other => panic!("unknown quantity {other}"),
        };
        let expected: f64 = value.parse().expect("a number");
        let error = (got - expected).abs() / own.focal_length;
        assert!(error < 1e-12, "{name} {wavelength} {program} {quantity}: {got} is not {expected}");
    }
}

#[test]
fn files_are_read_as_optiland_and_rayoptics_read_them() {
    use realistic_optics::prescription::read;
    let mut rays = 0;
    let by_rayoptics = table("files_rayoptics.csv");
    for table_file in ["files_optiland.csv", "files_rayoptics.csv"] {
        for row in table(table_file) {
            // The two programs disagree where optiland's own iteration ends early.
            let same = by_rayoptics.iter().find(|other| other[..8] == row[..8] && row[1] == "ray");
            let of = |row: &[String]| ray(numbers(&row[8..14]));
            if same.is_some_and(|same| difference(of(same), of(&row)).0 > 5e-11) {
                continue;
            }
            let path = format!("{}/tests/golden/files/{}", env!("CARGO_MANIFEST_DIR"), row[0]);
            let prescription = read(&row[0], &std::fs::read(&path).expect("a file")).expect("a lens");
            let mut lens = Lens::at_d_line(&prescription);
            // The programs do not clip rays.
            lens.surfaces.iter_mut().for_each(|surface| surface.semi_diameter *= 1.5);
            let own = FirstOrder::of(&lens).expect("focal");
            let value = match row[1].as_str() {
                "focal_length" => own.focal_length,
                "back_focal_distance" => own.back_focal_distance(),
                _ => {
                    let expected = ray(numbers(&row[8..14]));
                    let got = Path::<f64>::scene_to_film(&lens).trace(ray(numbers(&row[2..8])));
                    let (p, d) = difference(got.unwrap_or_else(|why| panic!("{row:?}: {why}")), expected);
                    assert!(p < 1e-10 && d < 1e-12, "{table_file} {row:?}: {p:e} mm, {d:e} rad");
                    rays += 1;
                    continue;
                }
            };
            let expected: f64 = row[2].parse().expect("a number");
            assert!((value / expected - 1.0).abs() < 1e-9, "{table_file} {row:?}: {value}");
        }
    }
    assert_eq!(rays, 146);
}

/// Returns focal length and focal points by the lecture's recipe, from one ray on each side. An exact ray is parallel
/// to the axis, at a distance of a ten-thousandth of the smallest clear aperture. It crosses the axis at the focal
/// point, and its continuation meets it in the principal plane. The remaining error is the third-order aberration at
/// that height, about 1e-7 of the focal length.
fn by_paraxial_rays(lens: &Lens) -> (f64, f64, f64) {
    let height =
        1e-4 * lens.surfaces.iter().map(|surface| surface.semi_diameter).fold(f64::INFINITY, f64::min);
    let crossing = |path: Path, start: f64, heading: f64| {
        let ray = Ray { origin: [0.0, height, start], direction: [0.0, 0.0, heading] };
        let ray = path.trace(ray).expect("gets through");
        let slope = ray.direction[1] / ray.direction[2];
        (-heading * height / slope, ray.origin[2] - ray.origin[1] / slope)
    };
    // The rays start in front of the first surface or behind the last, including the bulges of these surfaces.
    let (focal_length, rear) = crossing(Path::scene_to_film(lens), 1.0, -1.0);
    let (_, front) = crossing(Path::film_to_scene(lens), lens.rear().vertex - 1.0, 1.0);
    (focal_length, front, rear)
}

#[test]
fn the_two_computations_of_first_order_data_agree() {
    for name in catalogue::round() {
        let lens = lens(name, 587.56);
        let matrix = FirstOrder::of(&lens).expect("focal");
        let (focal_length, front, rear) = by_paraxial_rays(&lens);
        for (a, b) in [
            (matrix.focal_length, focal_length),
            (matrix.front_focal_point, front),
            (matrix.rear_focal_point, rear),
            (matrix.front_principal_plane, front - focal_length),
            (matrix.rear_principal_plane, rear + focal_length),
        ] {
            assert!((a - b).abs() < 1e-7 * matrix.focal_length, "{name}: {a} by matrix, {b} by rays");
        }
    }
}
