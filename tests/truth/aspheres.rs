//! Aspheres against closed forms, spheres and brute force, by the walk and by the kernel in every precision and width.

use ::realistic_camera::Camera;
use realistic_optics::{
    lens::{Lens, cos4, film_ray, first_order::FirstOrder},
    prescription::{Asphere, FIRST_POWER, Interface, Medium, NO_TERMS, Prescription, Shape},
    trace::{Blocked, Direction, Path, Ray},
};

use super::support::{Random, build, by_kernel, host_with, ray};

/// Returns a figure from a radius, a conic constant and terms by power.
pub fn asphere(radius: f64, conic: f64, terms: &[(usize, f64)]) -> Asphere {
    let mut asphere = Asphere { radius, conic, terms: NO_TERMS };
    for &(power, term) in terms {
        asphere.terms[power - FIRST_POWER] = term;
    }
    asphere
}

/// Returns a lens of rows: figure, thickness, index behind (1: air), clear semi-diameter.
pub fn lens(rows: &[(Shape, f64, f64, f64)]) -> Lens {
    let interface = |&(shape, thickness, n, semi_diameter): &(Shape, f64, f64, f64)| {
        let medium = if n == 1.0 { Medium::Air } else { Medium::Glass { n_d: n, abbe: None } };
        Interface::new(shape, thickness, medium, semi_diameter)
    };
    let interfaces = rows.iter().map(interface).collect();
    Lens::at_d_line(&Prescription { name: "aspheres".to_owned(), ..Prescription::new(interfaces) })
}

/// Returns rays from the scene parallel to the axis.
fn parallel(heights: impl Iterator<Item = f64>) -> Vec<Ray> {
    heights.map(|h| Ray { origin: [0.6 * h, -0.8 * h, 40.0], direction: [0.0, 0.0, -1.0] }).collect()
}

/// Returns the distance from the axis at which a ray crosses the plane z.
fn miss(ray: &Ray, z: f64) -> f64 {
    let t = (z - ray.origin[2]) / ray.direction[2];
    (ray.origin[0] + t * ray.direction[0]).hypot(ray.origin[1] + t * ray.direction[1])
}

/// Returns, for each tracer, the largest distance at which parallel light misses the paraxial focus.
fn largest_misses(lens: &Lens, semi: f64, focus: f64) -> [f64; 3] {
    let rays = parallel((0..40).map(|i| 0.99 * semi * f64::from(i) / 39.0));
    let path = Path::<f64>::scene_to_film(lens);
    let walked: Vec<_> = rays.iter().map(|ray| path.trace(*ray).ok()).collect();
    let traced = [
        walked,
        by_kernel::<f64>(lens, Direction::SceneToFilm, &rays),
        by_kernel::<f32>(lens, Direction::SceneToFilm, &rays),
    ];
    traced.map(|rays| rays.iter().map(|ray| miss(ray.as_ref().expect("passes"), focus)).fold(0.0, f64::max))
}

fn focuses(lens: &Lens, semi: f64, focus: f64) {
    let [walk, double, single] = largest_misses(lens, semi, focus);
    assert!(
        walk < 1e-13 * semi && double < 1e-13 * semi && single < 1e-4 * semi,
        "{walk:e} {double:e} {single:e}"
    );
}

fn does_not_focus(lens: &Lens, semi: f64, focus: f64) {
    assert!(largest_misses(lens, semi, focus).iter().all(|miss| *miss > 1e-3 * semi));
}

#[test]
fn a_hyperboloid_behind_glass_focuses_parallel_light() {
    for n in [1.25_f64, 1.5, 1.75, 2.0] {
        let (radius, semi) = (20.0, 18.0);
        let figure = |radius| Shape::Asphere(asphere(radius, -n * n, &[]));
        let plane_first = lens(&[(Shape::Plane, 25.0, n, semi), (figure(-radius), 0.0, 1.0, semi)]);
        focuses(&plane_first, semi, -25.0 - radius / (n - 1.0));
        // The same surface is at the front; light leaves its glass through a sphere about the focus.
        let (focus, semi) = (n * radius / (n - 1.0), 10.0);
        let reversed =
            [(figure(radius), 5.0, n, semi), (Shape::Sphere { radius: focus - 5.0 }, 0.0, 1.0, semi)];
        does_not_focus(&lens(&reversed), semi, -focus);
    }
}

#[test]
fn an_ellipsoid_before_glass_focuses_parallel_light() {
    for n in [1.25_f64, 1.5, 2.0] {
        let radius = 20.0;
        let figure = |radius| Shape::Asphere(asphere(radius, -1.0 / (n * n), &[]));
        let focus = n * radius / (n - 1.0);
        let semi = 15.0;
        // The sphere is concentric with the focus and refracts no ray.
        let front = [(figure(radius), 8.0, n, semi), (Shape::Sphere { radius: focus - 8.0 }, 0.0, 1.0, semi)];
        focuses(&lens(&front), semi, -focus);
        let semi = 9.0;
        let back = [(Shape::Plane, 10.0, n, semi), (figure(-radius), 0.0, 1.0, semi)];
        does_not_focus(&lens(&back), semi, -10.0 - radius / (n - 1.0));
    }
}

#[test]
fn terms_that_add_up_to_a_sphere_are_one() {
    // The binomial series of R - √(R² - r²), on a plane and on a paraboloid.
    let radius = 30.0_f64;
    let series = [
        0.5,
        1.0 / 8.0,
        1.0 / 16.0,
        5.0 / 128.0,
        7.0 / 256.0,
        21.0 / 1024.0,
        33.0 / 2048.0,
        429.0 / 32768.0,
        715.0 / 65536.0,
        2431.0 / 262_144.0,
    ];
    let terms = |first: usize| -> Vec<(usize, f64)> {
        let term = |(i, a): (usize, &f64)| (2 * i + 2, a * radius.powi(-(2 * i as i32 + 1)));
        series.iter().enumerate().skip(first).map(term).collect()
    };
    let semi = 6.0;
    let with = |shape| lens(&[(shape, 4.0, 1.6, semi), (Shape::Sphere { radius: -50.0 }, 0.0, 1.0, semi)]);
    let sphere = with(Shape::Sphere { radius });
    let expected = FirstOrder::of(&sphere).expect("focal").focal_length;
    for figure in [asphere(f64::INFINITY, 0.0, &terms(0)), asphere(radius, -1.0, &terms(1))] {
        let own = with(Shape::Asphere(figure));
        let focal_length = FirstOrder::of(&own).expect("focal").focal_length;
        assert!((focal_length / expected - 1.0).abs() < 1e-14, "{focal_length}");
        let mut random = Random::new(3);
        let rays: Vec<Ray> = (0..500)
            .map(|_| Ray {
                origin: [5.0 * random.signed(), 5.0 * random.signed(), -40.0],
                direction: [0.15 * random.signed(), 0.15 * random.signed(), 1.0],
            })
            .collect();
        let [a, b] = [&sphere, &own].map(|lens| by_kernel::<f64>(lens, Direction::FilmToScene, &rays));
        let walks = [&sphere, &own].map(Path::<f64>::film_to_scene);
        let mut passed = 0;
        for (i, ray) in rays.iter().enumerate() {
            let [c, d] = walks.each_ref().map(|path| path.trace(*ray).ok());
            for (a, b) in [(a[i], b[i]), (c, d)] {
                assert_eq!(a.is_some(), b.is_some(), "{ray:?}");
                let (Some(a), Some(b)) = (a, b) else { continue };
                passed += 1;
                for k in 0..3 {
                    assert!((a.origin[k] - b.origin[k]).abs() < 1e-13, "{a:?} {b:?}");
                    assert!((a.direction[k] - b.direction[k]).abs() < 1e-14, "{a:?} {b:?}");
                }
            }
        }
        assert!(passed > 300);
    }
}

/// Finds, by dense sampling, the first crossing of a ray from behind with a surface's profile. Returns the distance
/// between the ray and the surface at the height of the surface's lowest point, and the crossing; `None` if the ray
/// grazes the surface or its edge too closely to decide.
fn by_brute_force(lens: &Lens, ray: &Ray) -> Option<(f64, Result<[f64; 3], ()>)> {
    const STEPS: u32 = 10_000;
    let front = lens.front();
    let [low, high] = front.sagitta_range();
    let at = |t: f64| -> [f64; 3] { std::array::from_fn(|i| ray.origin[i] + t * ray.direction[i]) };
    let above = |t: f64| {
        let [x, y, z] = at(t);
        z - front.sagitta(x.hypot(y))
    };
    let to = |z: f64| (z - ray.origin[2]) / ray.direction[2];
    let (from, until) = (to(low).max(to(lens.rear().vertex)), to(high) + 1e-9);
    let step = (until - from) / f64::from(STEPS);
    let values: Vec<f64> = (0..=STEPS).map(|i| above(from + step * f64::from(i))).collect();
    // A grazing contact that falls between two samples.
    let grazes = values.windows(3).any(|v| {
        let turn = v[1] - v[0] > 0.0 && v[2] - v[1] <= 0.0 || v[1] - v[0] < 0.0 && v[2] - v[1] >= 0.0;
        turn && v[1].abs() < 1e-5
    });
    if grazes || values[0].abs() < 1e-6 {
        return None;
    }
    let start = values[0].abs();
    if values[0] > 0.0 {
        return Some((start, Err(())));
    }
    let Some(first) = values.iter().position(|value| *value > 0.0) else { return Some((start, Err(()))) };
    let (mut a, mut b) = (from + step * (first as f64 - 1.0), from + step * first as f64);
    for _ in 0..60 {
        let middle = f64::midpoint(a, b);
        if above(middle) > 0.0 { b = middle } else { a = middle }
    }
    let hit = at(b);
    let beyond = hit[0].hypot(hit[1]) / front.semi_diameter - 1.0;
    if beyond.abs() < 1e-4 { None } else { Some((start, if beyond > 0.0 { Err(()) } else { Ok(hit) })) }
}

#[test]
fn the_first_of_several_crossings_is_met_and_no_later_one() {
    // Surfaces with waves, gull wings and steep edges, between equal media.
    let figures = [
        asphere(f64::INFINITY, 0.0, &[(4, -0.05), (6, 0.004), (8, -5e-5)]),
        asphere(4.0, -0.8, &[(4, -0.02), (6, 9e-4), (8, -1e-5)]),
        asphere(-6.0, -4.0, &[(4, 0.01), (6, -6e-4), (8, 1e-5)]),
        asphere(8.0, 0.0, &[(3, 0.1), (5, -0.01), (7, 2e-4)]),
        asphere(-5.0, 0.5, &[(4, 1e-3)]),
        asphere(5.0, 0.9, &[]),
        asphere(-3.0, -9.0, &[]),
        // Half ellipsoids that end at 3.6 and 3.2, whose terms move the edge off the conic's equator.
        asphere(3.6, 0.0, &[(4, 4e-3)]),
        asphere(4.5, 1.0, &[(6, -4e-4), (10, 1e-7)]),
        // Cones, alone, with waves, and on half ellipsoids.
        asphere(f64::INFINITY, 0.0, &[(1, 0.7)]),
        asphere(f64::INFINITY, 0.0, &[(1, 2.0), (3, -0.15)]),
        asphere(6.0, -0.5, &[(1, -0.6), (4, 2e-3)]),
        asphere(3.6, 0.0, &[(1, 0.15)]),
        asphere(4.5, 0.5, &[(1, -0.1), (4, 1e-3)]),
    ];
    let (mut met, mut blocked, mut several) = (0, 0, 0);
    let mut random = Random::new(8);
    for figure in figures {
        for figure in [figure, Asphere { radius: -figure.radius, terms: figure.terms.map(|a| -a), ..figure }]
        {
            let semi = 4.0_f64.min(figure.widest());
            let rows = [(Shape::Asphere(figure), 9.0, 1.5, semi), (Shape::Plane, 0.0, 1.5, 400.0)];
            let mut own = lens(&rows);
            for surface in &mut own.surfaces {
                (surface.n_scene, surface.n_film) = (1.0, 1.0);
            }
            let rays: Vec<Ray> = (0..150)
                .map(|_| {
                    let aim = [semi * random.signed(), semi * random.signed()];
                    let slopes = [4.0 * random.signed().powi(3), 4.0 * random.signed().powi(3)];
                    let origin = [0, 1].map(|i| aim[i] - 9.0 * slopes[i]);
                    Ray {
                        origin: [origin[0], origin[1], -9.0 - 1e-3],
                        direction: [slopes[0], slopes[1], 1.0],
                    }
                })
                .collect();
            let path = Path::<f64>::film_to_scene(&own);
            let double = by_kernel::<f64>(&own, Direction::FilmToScene, &rays);
            let single = by_kernel::<f32>(&own, Direction::FilmToScene, &rays);
            for (i, ray) in rays.iter().enumerate() {
                let Some((start, expected)) = by_brute_force(&own, ray) else { continue };
                // Single precision starts its search slightly before that height, where a steep edge has another
                // radius.
                let is_clear = start > 0.1;
                let walked = path.trace(*ray);
                match expected {
                    Err(()) => {
                        blocked += 1;
                        assert!(walked.is_err() && double[i].is_none(), "{figure:?} {ray:?}: {walked:?}");
                        assert!(single[i].is_none() || !is_clear, "{figure:?} {ray:?}");
                    }
                    Ok(hit) => {
                        met += 1;
                        let got = [walked.ok(), double[i], single[i]];
                        let exact = if is_clear { 3 } else { 2 };
                        for (got, most) in got.into_iter().zip([1e-9, 1e-9, 1e-2]).take(exact) {
                            let got = got.unwrap_or_else(|| panic!("{figure:?} {ray:?}: {walked:?}"));
                            let off = (0..3).map(|k| (got.origin[k] - hit[k]).abs()).fold(0.0, f64::max);
                            assert!(off < most, "{figure:?} {ray:?}: {got:?}, {hit:?}");
                        }
                        // A ray that starts behind the hit and travels back crosses again.
                        let t = 1e-3;
                        let on = |t: f64| {
                            let [x, y, z]: [f64; 3] = std::array::from_fn(|k| hit[k] + t * ray.direction[k]);
                            z - own.front().sagitta(x.hypot(y))
                        };
                        several += i32::from(on(t) > 0.0 && (1..400).any(|k| on(t * f64::from(k)) < 0.0));
                    }
                }
            }
        }
    }
    println!("{met} met, {blocked} blocked, {several} cross again");
    assert!(met > 500 && blocked > 100 && several > 8, "{met} {blocked} {several}");
}

#[test]
fn an_axicon_turns_parallel_light_by_one_angle() {
    // A cone of the half angle 90 - α behind glass: n sin α = sin(α + δ).
    let (n, slope, semi) = (1.5_f64, 0.3_f64, 10.0);
    let tilt = slope.atan();
    let turned = (n * tilt.sin()).asin() - tilt;
    for sign in [1.0, -1.0] {
        let cone = Shape::Asphere(asphere(f64::INFINITY, 0.0, &[(1, sign * slope)]));
        let axicon = lens(&[(Shape::Plane, 8.0, n, semi), (cone, 0.0, 1.0, semi)]);
        let rays = parallel((1..40).map(|i| 0.99 * semi * f64::from(i) / 39.0));
        let path = Path::<f64>::scene_to_film(&axicon);
        let walked: Vec<_> = rays.iter().map(|ray| path.trace(*ray).ok()).collect();
        let double = by_kernel::<f64>(&axicon, Direction::SceneToFilm, &rays);
        let single = by_kernel::<f32>(&axicon, Direction::SceneToFilm, &rays);
        for (traced, most) in [(walked, 1e-13), (double, 1e-13), (single, 1e-5)] {
            for (ray, left) in rays.iter().zip(traced) {
                let left = left.expect("passes");
                let [x, y, z] = left.direction;
                let outward = (x * ray.origin[0] + y * ray.origin[1]) / ray.origin[0].hypot(ray.origin[1]);
                assert!((outward.atan2(-z) - sign * turned).abs() < most, "{outward} {turned}");
                let [x, y, z] = left.origin;
                assert!((z + 8.0 + sign * slope * x.hypot(y)).abs() < 1e2 * most, "{left:?}");
            }
        }
        // Nothing turns the ray through the tip.
        let axis = path.trace(Ray { origin: [0.0, 0.0, 40.0], direction: [0.0, 0.0, -1.0] }).expect("passes");
        assert_eq!(axis.direction, [0.0, 0.0, -1.0]);
    }
}

#[test]
fn an_asphere_passes_light_up_to_its_equator() {
    // A dome is concave toward the film; a diameter of 60 is wider than the sphere, which is then used whole.
    for diameter in [20.0, 38.8, 39.9, 40.0, 60.0] {
        let text = format!("20 25 1.5 {diameter}\ninf 2 1 26\n0 0 1 20\nasphere 1 A10=1.953125e-13\n");
        let given = [("film_distance", "14"), ("film_diagonal", "12")];
        let (camera, _) = build(&host_with(&text), &given).unwrap_or_else(|error| panic!("{error}"));
        for image in [[200.0, 150.0], [300.0, 150.0], [390.0, 290.0]] {
            let [_, passed] = light(&camera, image);
            println!("{diameter} {image:?}: {passed}");
            assert!(passed > 0.99, "{diameter} {image:?}: {passed}");
        }
    }
}

#[test]
fn rays_that_miss_are_blocked_with_the_reason() {
    let plane = (Shape::Plane, 0.0, 1.0, 30.0);
    let trace = |front: Asphere, semi: f64, origin: [f64; 3], direction: [f64; 3]| {
        let own = lens(&[(Shape::Asphere(front), 5.0, 1.5, semi), plane]);
        let ray = Ray { origin, direction };
        let walked = Path::<f64>::scene_to_film(&own).walk(ray);
        assert_eq!(
            by_kernel::<f64>(&own, Direction::SceneToFilm, &[ray])[0].is_some(),
            walked.blocked.is_none()
        );
        (walked.surfaces_met, walked.blocked)
    };
    let down = [0.0, 0.0, -1.0];
    // An oblate ellipsoid, half as wide as it is high, ends at R/√(1 + k) = 5.
    let oblate = asphere(10.0, 3.0, &[]);
    assert_eq!(trace(oblate, 5.0, [4.9, 0.0, 9.0], down), (2, None));
    assert!(trace(oblate, 5.0, [5.1, 0.0, 9.0], down).1.is_some());
    // The edge of a paraboloid lies at its clear diameter.
    let paraboloid = asphere(10.0, -1.0, &[]);
    assert_eq!(trace(paraboloid, 5.0, [5.1, 0.0, 9.0], down).1, Some(Blocked::Clipped));
    assert_eq!(trace(paraboloid, 5.0, [4.9, 0.0, 9.0], down), (2, None));
    // The second sheet of a hyperboloid lies 2 R/|1 + k| = 10 before the vertex and is open toward the scene. Rays
    // cross it without refraction, and a ray that starts beyond the first sheet has already passed that sheet.
    let hyperboloid = asphere(10.0, -3.0, &[]);
    assert_eq!(trace(hyperboloid, 8.0, [3.0, 0.0, 30.0], down), (2, None));
    assert_eq!(trace(hyperboloid, 8.0, [0.0, 0.0, -1.0], down).1, Some(Blocked::TurnedBack));
    let bent = trace(asphere(f64::INFINITY, 0.0, &[(4, 1e-3)]), 8.0, [9.0, 0.0, 9.0], down);
    assert_eq!(bent.1, Some(Blocked::Clipped));
}

/// US 2016/0341934 A1, example 11: six plastic elements of a telephone, f = 4.1 mm, f/1.8.
const PHONE: &str = "\
0 0 1 - 2.2802
1.942 0.7603 1.545 55.9 2.31
-43.409 0.0555 1 - 2.18
7.984 0.2494 1.651 21.5 2.17
2.979 0.5868 1 - 2.15
-9.473 0.4081 1.651 21.5 2.13
-28.062 0.235 1 - 2.56
-8.682 0.9771 1.545 55.9 3.35
-1.508 0.1 1 - 3.74
1.681 0.328 1.545 55.9 4.47
1.128 0.7 1 - 4.88
-22.861 0.3 1.661 20.4 5.01
3.522 0.45 1 - 5.58
0 0.15 1.516 64.1 6.09
0 0 1 - 6.17
asphere 2 conic=-0.49853396 A4=0.00282308 A6=0.0206461 A8=-0.0325751 A10=0.0256978 A12=-0.0094397
asphere 3 A4=-0.0516994 A6=0.121884 A8=-0.131873 A10=0.0576987 A12=-0.0096745
asphere 4 A4=-0.112242 A6=0.188446 A8=-0.172552 A10=0.0602977 A12=0.00460642 A14=-0.00414886
asphere 5 conic=-7.58419032 A4=-0.0626311 A6=0.114977 A8=-0.143652 A10=0.0814989 A12=-0.0232324 A14=-0.000908662
asphere 6 A4=-0.15542 A6=0.00564168 A8=-0.045701 A10=0.0161679 A12=-0.0115846 A14=0.00782347
asphere 7 A4=-0.127643 A6=0.0122788 A8=0.0104252 A10=-0.00908795 A12=0.00590465 A14=0.000112693
asphere 8 A4=-0.00974211 A6=-0.0357423 A8=0.0550779 A10=-0.0262557 A12=0.00542419 A14=-0.000353494 A16=-2.05792e-05
asphere 9 conic=-0.96894194 A4=0.0393878 A6=-0.0199585 A8=0.0140677 A10=-0.00337607 A12=0.00034783 A14=-2.92323e-05 \
A16=1.64755e-06
asphere 10 conic=-0.8307806 A4=-0.174274 A6=0.0474876 A8=-0.00897572 A10=0.000661592 A12=2.91223e-05 A14=-4.36144e-06
asphere 11 conic=-2.85391957 A4=-0.0835047 A6=0.0227336 A8=-0.00497627 A10=0.000507058 A12=-1.04243e-05 A14=-1.86859e-06
asphere 12 A4=-0.0581719 A6=0.0167041 A8=-0.00188551 A10=6.12528e-05
asphere 13 conic=0.30802964 A4=-0.0977084 A6=0.0215146 A8=-0.00229345 A10=9.1816e-05 A12=-9.45631e-07
";

/// Returns the telephone's camera.
fn phone(given: &[(&str, &str)]) -> Camera {
    let given = [&[("film_diagonal", "5.6")], given].concat();
    build(&host_with(PHONE), &given).unwrap_or_else(|error| panic!("{error}")).0
}

/// Returns the mean weight of the samples of an image point, and the share of them that passes.
fn light(camera: &Camera, image: [f32; 2]) -> [f64; 2] {
    const SIDE: u32 = 60;
    let (mut sum, mut passed) = (0.0, 0);
    for i in 0..SIDE * SIDE {
        let lens_sample = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
        if let Some((_, weight)) = ray(camera, image, lens_sample) {
            (sum, passed) = (sum + f64::from(weight), passed + 1);
        }
    }
    [sum, f64::from(passed)].map(|x| x / f64::from(SIDE * SIDE))
}

/// Returns the same light up to a constant factor, from a fine grid of slopes traced by the walk: cos⁴ per slope area.
fn light_of_grid(camera: &Camera, height: f64) -> f64 {
    const SIDE: i32 = 300;
    let facts = camera.facts().expect("a lens");
    let path = Path::<f64>::film_to_scene(&facts.lens);
    let mut sum = 0.0;
    for i in 0..SIDE * SIDE {
        let slopes = [i % SIDE, i / SIDE].map(|k| 1.2 * (2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0));
        let passes = path.trace(film_ray([height, 0.0], facts.film_z(), slopes)).is_ok();
        sum += if passes { cos4(slopes) } else { 0.0 };
    }
    sum
}

#[test]
fn the_phones_warped_pupil_gives_the_light_of_its_slopes() {
    for given in [&[][..], &[("precision", "f32")]] {
        let camera = phone(given);
        let [axis, _] = light(&camera, [200.0, 150.0]);
        let grid = light_of_grid(&camera, 0.0);
        // The film's diagonal of 5.6 mm is 500 pixels of the image.
        for pixels in [100.0_f32, 180.0] {
            let [light, passed] = light(&camera, [200.0 + pixels, 150.0]);
            let expected = light_of_grid(&camera, f64::from(pixels) * 5.6 / 500.0) / grid;
            println!("{given:?} {pixels}: {} of {expected}, {passed} pass", light / axis);
            assert!((light / axis / expected - 1.0).abs() < 0.02, "{pixels}: {} of {expected}", light / axis);
            assert!(passed > 0.95, "{pixels}: {passed}");
        }
    }
}
