//! Planes that only limit rays, at any position relative to the bulges of their neighbours. A stop blocks a ray
//! according to the point where the ray's line between the surrounding surfaces crosses the stop's plane. The oracle is
//! the lens without the plane.

use realistic_optics::trace::{Blocked, Direction, Path, Ray};

use super::support::{Random, build, by_kernel, host_with, lens_of, ray};

/// A lens with a plane that only limits, the number of its row, and the rows without it.
struct Case {
    text: &'static str,
    row: usize,
    without: &'static str,
    /// z of the plane relative to the first vertex of the lens without the plane.
    plane: f64,
    semi_diameter: f64,
}

const CASES: [Case; 8] = [
    // The plane lies between two lenses: in the order of the vertices, inside the first one's bulge, and inside the
    // second one's bulge.
    Case {
        text: "30 4 1.6 20\n-25 1.5 1 20\nstop 1.5 1 12\n28 4 1.6 20\n-40 0 1 20",
        row: 2,
        without: "30 4 1.6 20\n-25 3 1 20\n28 4 1.6 20\n-40 0 1 20",
        plane: -5.5,
        semi_diameter: 6.0,
    },
    Case {
        text: "30 4 1.6 20\n-25 -1 1 20\nstop 4 1 16\n28 4 1.6 20\n-40 0 1 20",
        row: 2,
        without: "30 4 1.6 20\n-25 3 1 20\n28 4 1.6 20\n-40 0 1 20",
        plane: -3.0,
        semi_diameter: 8.0,
    },
    Case {
        text: "30 4 1.6 20\n-25 3.5 1 20\nstop -0.5 1 15\n28 4 1.6 20\n-40 0 1 20",
        row: 2,
        without: "30 4 1.6 20\n-25 3 1 20\n28 4 1.6 20\n-40 0 1 20",
        plane: -7.5,
        semi_diameter: 7.5,
    },
    // The plane lies in front of the first surface and inside that surface's bulge, or behind the last surface and
    // inside that surface's bulge.
    Case {
        text: "stop 2 1 14\n30 4 1.6 20\n-25 0 1 20",
        row: 0,
        without: "30 4 1.6 20\n-25 0 1 20",
        plane: 2.0,
        semi_diameter: 7.0,
    },
    Case {
        text: "stop -0.8 1 14\n30 4 1.6 20\n-25 0 1 20",
        row: 0,
        without: "30 4 1.6 20\n-25 0 1 20",
        plane: -0.8,
        semi_diameter: 7.0,
    },
    // The plane lies inside the bulge of an asphere or of a conic, as in telephone lenses.
    Case {
        text: "asphere 2 A4=-1e-5 A6=1e-8\nstop -0.8 1 14\n30 4 1.6 20\n-25 0 1 20",
        row: 0,
        without: "asphere 1 A4=-1e-5 A6=1e-8\n30 4 1.6 20\n-25 0 1 20",
        plane: -0.8,
        semi_diameter: 7.0,
    },
    Case {
        text: "asphere 2 conic=-1.5\nstop -0.8 1 14\n30 4 1.6 20\n-25 0 1 20",
        row: 0,
        without: "asphere 1 conic=-1.5\n30 4 1.6 20\n-25 0 1 20",
        plane: -0.8,
        semi_diameter: 7.0,
    },
    Case {
        text: "30 4 1.6 20\n-25 -0.8 1 20\nstop 0 1 14",
        row: 2,
        without: "30 4 1.6 20\n-25 0 1 20",
        plane: -3.2,
        semi_diameter: 7.0,
    },
];

/// Returns the distance from the axis at which the line through a point along a direction crosses the plane z.
fn distance_at(z: f64, point: [f64; 3], direction: [f64; 3]) -> f64 {
    let t = (z - point[2]) / direction[2];
    (point[0] + t * direction[0]).hypot(point[1] + t * direction[1])
}

/// Traces a ray through the lens without the plane, in that lens's space. Returns the distance from the axis at which
/// the ray crosses the plane, and the ray behind the lens; `None` if the ray is blocked.
fn oracle(case: &Case, direction: Direction, ray: Ray) -> Option<(f64, Ray)> {
    let lens = lens_of(case.without);
    let path = match direction {
        Direction::FilmToScene => Path::<f64>::film_to_scene(&lens),
        Direction::SceneToFilm => Path::<f64>::scene_to_film(&lens),
    };
    let mut points = vec![ray.origin];
    let walk = path.walk_by(ray, |_, point| points.push(point));
    if walk.blocked.is_some() {
        return None;
    }
    let before = match direction {
        Direction::SceneToFilm => case.row,
        Direction::FilmToScene => lens.surfaces.len() - case.row,
    };
    let from = points[before];
    let onward = match points.get(before + 1) {
        Some(next) => [0, 1, 2].map(|i| next[i] - from[i]),
        None => walk.ray.direction,
    };
    Some((distance_at(case.plane, from, onward), walk.ray))
}

#[test]
fn a_plane_limits_rays_at_any_position_among_its_neighbours() {
    let mut random = Random::new(7);
    for (number, case) in CASES.iter().enumerate() {
        let lens = lens_of(case.text);
        // The origin of lens space is the first row's vertex.
        let shift = lens.surfaces.iter().find(|surface| !surface.only_limits()).expect("glass").vertex;
        for direction in [Direction::SceneToFilm, Direction::FilmToScene] {
            let rays: Vec<Ray> = (0..4000)
                .map(|_| {
                    let (from, to) =
                        if direction == Direction::SceneToFilm { (60.0, 0.0) } else { (-70.0, -4.0) };
                    let start = [8.0 * random.signed(), 8.0 * random.signed(), from];
                    let aim = [10.0 * random.signed(), 10.0 * random.signed(), to];
                    Ray { origin: start, direction: [0, 1, 2].map(|i| aim[i] - start[i]) }
                })
                .collect();
            let moved = |ray: &Ray| {
                let [x, y, z] = ray.origin;
                Ray { origin: [x, y, z + shift], direction: ray.direction }
            };
            let placed: Vec<Ray> = rays.iter().map(moved).collect();
            let path = match direction {
                Direction::FilmToScene => Path::<f64>::film_to_scene(&lens),
                Direction::SceneToFilm => Path::<f64>::scene_to_film(&lens),
            };
            let kernel = by_kernel::<f64>(&lens, direction, &placed);
            let single = by_kernel::<f32>(&lens, direction, &placed);
            let (mut passed, mut stopped) = (0, 0);
            for (i, ray) in rays.iter().enumerate() {
                let expected = oracle(case, direction, *ray);
                let Some((distance, onward)) = expected else {
                    assert!(path.trace(placed[i]).is_err() && kernel[i].is_none(), "{number} {ray:?}");
                    continue;
                };
                if (distance - case.semi_diameter).abs() < 1e-4 {
                    continue;
                }
                let passes = distance < case.semi_diameter;
                *(if passes { &mut passed } else { &mut stopped }) += 1;
                let walked = path.trace(placed[i]).ok();
                assert_eq!(walked.is_some(), passes, "{number} {direction:?} {ray:?} {distance}");
                assert_eq!(kernel[i].is_some(), passes, "{number} {direction:?} {ray:?} {distance}");
                assert_eq!(single[i].is_some(), passes, "{number} {direction:?} {ray:?} {distance}");
                for found in [walked, kernel[i]].into_iter().flatten() {
                    for axis in 0..3 {
                        assert!(
                            (found.direction[axis] - onward.direction[axis]).abs() < 1e-13,
                            "{number} {ray:?}"
                        );
                    }
                    let back = Ray { origin: found.origin, direction: found.direction };
                    let off = distance_at(shift + onward.origin[2], back.origin, back.direction)
                        - onward.origin[0].hypot(onward.origin[1]);
                    assert!(off.abs() < 1e-11, "{number} {ray:?} {off}");
                }
            }
            assert!(passed > 300 && stopped > 100, "{number} {direction:?}: {passed} {stopped}");
        }
    }
}

#[test]
fn behind_a_leading_plane_surfaces_count_from_where_a_ray_began() {
    // The cases are a ball far behind the stop, and a stop inside the bulge of a sphere, an asphere or a conic.
    let ball = "stop 30 1 6\n5 3 1.6 8\n-5 0 1 8";
    let inside = CASES[4..7].iter().map(|case| case.text);
    let mut random = Random::new(11);
    for text in inside.chain([ball]) {
        let lens = lens_of(text);
        let path = Path::<f64>::scene_to_film(&lens);
        let first = lens.surfaces.iter().find(|surface| !surface.only_limits()).expect("glass").vertex;
        // Rays travel from in front of the stop to behind the first glass.
        let rays: Vec<Ray> = (0..4000)
            .map(|_| {
                let start =
                    [3.0 * random.signed(), 3.0 * random.signed(), first + 20.0 + 24.0 * random.signed()];
                let direction = [0.1 * random.signed(), 0.1 * random.signed(), -1.0];
                Ray { origin: start, direction }
            })
            .collect();
        let kernel = by_kernel::<f64>(&lens, Direction::SceneToFilm, &rays);
        let (mut passed, mut turned) = (0, 0);
        for (ray, found) in rays.iter().zip(kernel) {
            let walked = path.trace(*ray);
            assert_eq!(walked.is_ok(), found.is_some(), "{text:?} {ray:?} {walked:?}");
            passed += usize::from(walked.is_ok());
            turned += usize::from(walked == Err(Blocked::TurnedBack));
        }
        assert!(passed > 300 && turned > 100, "{text:?}: {passed} {turned}");
    }
}

#[test]
fn cameras_sample_pupils_of_stops_inside_a_bulge() {
    for case in &CASES {
        let host = host_with(case.text);
        let given = [("film_diagonal", "8"), ("focus_distance", "1000")];
        let (camera, warnings) =
            build(&host, &given).unwrap_or_else(|error| panic!("{}: {error}", case.text));
        assert_eq!(warnings, [""; 0], "{}", case.text);
        let mut random = Random::new(3);
        let mut passed = 0;
        for _ in 0..2000 {
            let image = [200.0 + 150.0 * random.signed(), 150.0 + 100.0 * random.signed()];
            let lens = [random.next(), random.next()];
            passed += usize::from(ray(&camera, image.map(|x| x as f32), lens.map(|x| x as f32)).is_some());
        }
        assert!(passed > 1900, "{}: {passed} of 2000", case.text);
    }
}
