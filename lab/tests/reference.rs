//! The extended-precision reference against closed forms and against tables of exact arithmetic.

use std::path::PathBuf;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use realistic_lab::{
    reference::{DoubleDouble as Exact, ExactRay, Reference, Wide, condition::Conditioned},
    results::statistics::{Spread, quantile},
    stability::{self, closed_form},
    subject::FilmRays,
};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder, refraction::Refraction},
    prescription::{catalogue, read},
    trace::{Direction, Path, Ray, Real},
};
use realistic_trace::kernel::{Kernel, KernelScalar};

type Vector = [Exact; 3];

fn exact(number: f64) -> Exact {
    Exact::from_f64(number)
}

fn length(vector: Vector) -> f64 {
    vector.iter().map(|x| x.to_f64().powi(2)).sum::<f64>().sqrt()
}

/// Returns the length of the difference of two vectors.
fn apart(a: Vector, b: Vector) -> f64 {
    length(std::array::from_fn(|i| a[i] - b[i]))
}

fn path(lens: &Lens, direction: Direction) -> Path<Exact> {
    Path::new(lens, direction, Refraction::Fused)
}

#[test]
fn quotients_and_roots_are_right_to_thirty_digits() {
    let mut number = exact(0.7);
    for _ in 0..2000 {
        number = exact(1.0) / (number * number + exact(0.3)) + exact(1.0) / exact(3.0);
        for other in [exact(3.0).sqrt(), exact(1e-9) / exact(7.0), exact(1e20) / exact(3.0)] {
            let quotient = number / other;
            let relative = ((quotient * other - number) / number).to_f64();
            assert!(relative.abs() < 1e-30, "{number:?} / {other:?}: {relative:e}");
            let root = (number * other).sqrt();
            let relative = ((root * root - number * other) / (number * other)).to_f64();
            assert!(relative.abs() < 1e-30, "root of {number:?} x {other:?}: {relative:e}");
        }
    }
}

#[test]
fn numbers_of_256_bits_are_right_to_74_digits() {
    // The roots to 80 decimals, and the digits of 1/7, which repeat.
    let roots = [
        (2.0, "1.41421356237309504880168872420969807856967187537694807317667973799073247846210704"),
        (3.0, "1.73205080756887729352744634150587236694280525381038062805580697945193301690880004"),
    ];
    for (number, known) in roots {
        let error = Wide::from_f64(number).sqrt() - decimal::<Wide>(known);
        assert!(error.to_f64().abs() < 1e-74, "√{number}: {error:?}");
    }
    let seventh = Wide::ONE / Wide::from_f64(7.0) - decimal::<Wide>(&format!("0.{}", "142857".repeat(14)));
    assert!(seventh.to_f64().abs() < 1e-74, "{seventh:?}");

    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut number = Wide::from_f64(0.7);
    for _ in 0..20_000 {
        let scale = random.random_range(-300.0_f64..300.0).exp2();
        let other =
            Wide::from_f64(random.random_range(-1.0..1.0) * scale) * number + Wide::from_f64(1e-9 * scale);
        // Sums of numbers of any two sizes and signs, taken apart again.
        let size = number.to_f64().abs().max(other.to_f64().abs());
        let apart = (((number + other) - other) - number).to_f64() / size;
        let products = ((number + other) * (number - other) - (number * number - other * other)).to_f64();
        let quotient = ((number / other * other - number) / number).to_f64();
        let square = number * number + other * other;
        let root = ((square.sqrt() * square.sqrt() - square) / square).to_f64();
        for (name, error) in
            [("sum", apart), ("product", products / (size * size)), ("quotient", quotient), ("root", root)]
        {
            assert!(error.abs() < 1e-74, "{name} of {number:?} and {other:?}: {error:e}");
        }
        assert_eq!(number < other, (number - other).to_f64() < 0.0);
        let double = random.random::<f64>() * scale;
        assert_eq!(Wide::from_f64(double).to_f64(), double);
        number = Wide::ONE / (number * number + Wide::from_f64(0.3)) - Wide::from_f64(random.random::<f64>());
    }
    assert!((-Wide::ONE).sqrt().to_f64().is_nan() && (Wide::ONE / Wide::ZERO).to_f64().is_nan());
    assert!(!(Wide::from_f64(f64::NAN) > Wide::ZERO) && Wide::ZERO == -Wide::ZERO);
}

/// Returns the largest error in point, relative to the point's size, and the largest error in direction.
fn against_closed_form(cases: Vec<stability::Case>) -> (f64, f64) {
    let (mut position, mut direction) = (0.0_f64, 0.0_f64);
    for case in cases {
        let reference = Reference::new(&case.lens, case.direction);
        let known: &[ExactRay] = case.closed_form.as_deref().expect("a closed form");
        assert!(known.len() > 4);
        for (ray, known) in case.rays.iter().zip(known) {
            let got = reference.trace(*ray).unwrap_or_else(|why| panic!("{} {ray:?}: {why}", case.name));
            let start = length(ray.origin.map(exact)).max(length(known.point));
            position = position.max(apart(got.point, known.point) / start);
            direction = direction.max(apart(got.direction, known.direction));
        }
    }
    println!("{position:e} {direction:e}");
    (position, direction)
}

#[test]
fn a_plane_parallel_plate_moves_a_ray_and_keeps_its_direction() {
    let (position, direction) = against_closed_form(closed_form::plates());
    assert!(position < 1e-28 && direction < 1e-28, "{position:e}, {direction:e} rad");
}

#[test]
fn an_aplanatic_sphere_images_its_point_without_error() {
    let (position, direction) = against_closed_form(closed_form::aplanatic_meniscus());
    assert!(position < 1e-29 && direction < 1e-29, "{position:e}, {direction:e} rad");
}

#[test]
fn aspheres_refract_as_their_closed_forms_say() {
    use stability::aspheres;
    let cases = [aspheres::hyperboloids(), aspheres::ellipsoids(), aspheres::paraboloids()];
    let (position, direction) = against_closed_form(cases.concat());
    assert!(position < 1e-28 && direction < 1e-28, "{position:e}, {direction:e} rad");
    let (position, direction) = against_closed_form(aspheres::planes_with_a_term());
    assert!(position < 1e-28 && direction < 1e-28, "{position:e}, {direction:e} rad");
}

#[test]
fn concentric_shells_turn_a_ray_as_bouguer_says() {
    let (position, direction) = against_closed_form(closed_form::shells());
    assert!(position < 1e-29 && direction < 1e-29, "{position:e}, {direction:e} rad");
}

#[test]
fn thin_shells_focus_where_luneburgs_lens_does() {
    // The lens focuses distant rays on its own back, the more closely the thinner its shells: the rays cross the axis
    // at z = -2 R.
    let miss = |count: u32| {
        let radius = 10.0;
        let shell = |i: u32| radius * (1.0 - f64::from(i) / f64::from(count));
        let index = |i: u32| (2.0 - (1.0 - (f64::from(i) + 0.5) / f64::from(count)).powi(2)).sqrt();
        let thickness = radius / f64::from(count);
        let mut text = String::new();
        // The rows are those of the entry into the shells, the ball in the middle, and the exit.
        for i in 0..count {
            let through = if i + 1 == count { 2.0 * thickness } else { thickness };
            text += &format!("{} {through} {} {}\n", shell(i), index(i), 2.0 * shell(i));
        }
        for i in (0..count).rev() {
            let (through, behind) = if i == 0 { (0.0, 1.0) } else { (thickness, index(i - 1)) };
            text += &format!("-{} {through} {behind} {}\n", shell(i), 2.0 * shell(i));
        }
        let lens = Lens::at_d_line(&read("Luneburg", text.as_bytes()).expect("a lens"));
        let ray = Ray { origin: [thickness / 4.0, 0.0, 30.0], direction: [0.0, 0.0, -1.0] };
        let out = Reference::new(&lens, Direction::SceneToFilm).trace(ray).expect("passes");
        (out.point[0] / exact(ray.origin[0])).to_f64().abs()
    };
    let [coarse, fine] = [miss(10), miss(40)];
    assert!(coarse < 0.1 && fine < coarse / 2.0, "{coarse:e}, {fine:e}");
}

#[test]
fn a_ray_sent_back_returns_to_where_it_came_from_by_the_same_optical_path() {
    for name in ["dgauss.50mm", "fisheye.10mm", "wide.22mm", "telephoto.250mm"] {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("in the catalogue"));
        let (out, back) = (path(&lens, Direction::FilmToScene), path(&lens, Direction::SceneToFilm));
        let entry = exact(lens.rear().vertex);
        let mut passed = 0;
        for i in 0..100 {
            let slope = |n: i32| (f64::from(i * n % 23) / 23.0 - 0.5) * 0.3;
            let ray = Ray {
                origin: [4.0 * slope(5), 9.0 * slope(7), lens.rear().vertex - 30.0],
                direction: [slope(3), slope(11), 1.0],
            };
            let start = ray.origin.map(exact);
            let Ok((point, direction, there)) = out.trace_in_full(start, ray.direction.map(exact)) else {
                continue;
            };
            let (point, direction, back) =
                back.trace_in_full(point, direction.map(|d| -d)).expect("the way it came");
            passed += 1;
            // Both rays lie on the same line: the start is on it, and the direction is the same.
            let to_start: Vector = [start[0] - point[0], start[1] - point[1], (start[2] - entry) - point[2]];
            let moment: Vector = std::array::from_fn(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                to_start[j] * direction[k] - to_start[k] * direction[j]
            });
            assert!(length(moment) < 1e-27, "{name} {ray:?}: {:e} mm", length(moment));
            let between = to_start.iter().fold(exact(0.0), |sum, part| sum + *part * *part).sqrt();
            let whole = back + between;
            assert!((there - whole).to_f64().abs() < 1e-27, "{name} {ray:?}");
        }
        assert!(passed > 20, "{name}: {passed}");
    }
}

#[test]
fn the_chain_with_condition_numbers_gives_the_references_rays() {
    for case in stability::assemblies::film_positions() {
        let reference = Reference::new(&case.lens, case.direction);
        for (ray, trail) in case.rays.iter().zip(case.trails()) {
            match (reference.trace(*ray), trail.exact) {
                (Ok(a), Ok(b)) => {
                    let (p, d) = (apart(a.point, b.point), apart(a.direction, b.direction));
                    assert!(p < 1e-23 && d < 1e-24, "{} {ray:?}: {p:e} mm, {d:e} rad", case.name);
                }
                (a, b) => assert_eq!(a.is_err(), b.is_err(), "{} {ray:?}", case.name),
            }
        }
    }
}

#[test]
fn the_condition_number_predicts_what_a_disturbed_ray_does() {
    // The reference traces a ray through a lens of condition 1e6, and a neighbour turned by 1e-12 rad about the point
    // in the front vertex plane.
    let case = stability::stiff::telescopes().swap_remove(2);
    let (reference, start) = (Reference::new(&case.lens, case.direction), 10.0);
    let turned =
        |angle: f64| Ray { origin: [1e-3 + start * angle, 0.0, start], direction: [-angle, 0.0, -1.0] };
    let condition = Conditioned::new(&case.lens, case.direction).follow::<Exact>(turned(0.0)).own.direction;
    let [a, b] = [0.0, 1e-12].map(|angle| reference.trace(turned(angle)).expect("passes"));
    let growth = apart(a.direction, b.direction) / 1e-12;
    assert!(
        condition > 1e6 && growth > condition / 30.0 && growth < condition,
        "{growth:e} of {condition:e}"
    );
}

/// Parses a decimal number to full precision.
fn decimal<R: Real>(text: &str) -> R {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let mut exponent: i32 = exponent.parse().expect("an exponent");
    let (mut number, mut fraction) = (R::from_f64(0.0), false);
    for character in mantissa.chars() {
        if let Some(digit) = character.to_digit(10) {
            number = number * R::from_f64(10.0) + R::from_f64(f64::from(digit));
            exponent -= i32::from(fraction);
        }
        fraction |= character == '.';
    }
    for _ in 0..exponent.abs() {
        number = if exponent < 0 { number / R::from_f64(10.0) } else { number * R::from_f64(10.0) };
    }
    if mantissa.starts_with('-') { -number } else { number }
}

#[test]
fn the_tables_of_exact_arithmetic_agree_to_their_last_digits() {
    let golden = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/golden");
    for name in
        ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm", "dgauss.100mm", "planar", "crossed"]
    {
        let prescription = catalogue::find(name).unwrap_or_else(|| {
            let text = std::fs::read(golden.join(format!("{name}.dat"))).expect("a golden lens");
            read(name, &text).expect("a valid lens")
        });
        let lens = Lens::at_d_line(&prescription);
        // The tables' vertices are exact sums; a lens keeps them rounded to doubles.
        let rear = lens.surfaces.iter().fold(exact(0.0), |z, surface| z - exact(surface.thickness));
        for (prefix, direction) in
            [("truth_", Direction::FilmToScene), ("truth_scene_", Direction::SceneToFilm)]
        {
            let path = path(&lens, direction);
            let (entry, exit) = match direction {
                Direction::FilmToScene => (exact(lens.rear().vertex) - rear, exact(0.0)),
                Direction::SceneToFilm => (exact(0.0), rear),
            };
            let text = std::fs::read_to_string(golden.join(format!("{prefix}{name}.csv"))).expect("a table");
            let (mut position, mut angle, mut passed) = (0.0_f64, 0.0_f64, 0);
            for row in text.lines().filter(|line| !line.starts_with('#')).skip(1) {
                let fields: Vec<&str> = row.split(',').collect();
                let given = |i: usize| exact(fields[i].parse().expect("a number"));
                let origin = [given(0), given(1), given(2) + entry];
                let traced = path.trace_in_full(origin, [given(3), given(4), given(5)]);
                assert_eq!(traced.is_ok(), fields[12] == "ok", "{prefix}{name}: {row}");
                let Ok(([x, y, z], direction, _)) = traced else {
                    assert_eq!(
                        traced.map_err(|why| why.to_string()).err().as_deref(),
                        Some(fields[12]),
                        "{row}"
                    );
                    continue;
                };
                passed += 1;
                let known = |from: usize| std::array::from_fn(|i| decimal(fields[from + i]));
                position = position.max(apart([x, y, z + exit], known(6)));
                angle = angle.max(apart(direction, known(9)));
            }
            println!("{prefix}{name}: {position:.1e} mm, {angle:.1e} rad, {passed} rays");
            assert!(
                passed > 20 && position < 1e-22 && angle < 1e-24,
                "{prefix}{name}: {position:e}, {angle:e}"
            );
        }
    }
}

/// Returns the direction errors (rad) of a kernel on rays from the whole film through the whole rear element, and the
/// number of rays that only one of the kernel and the reference passes.
fn errors<S: KernelScalar + Real>(lens: &Lens, count: usize) -> (Vec<f64>, usize) {
    let kernel = Kernel::<S>::new(lens, Direction::FilmToScene);
    let reference = Reference::new(lens, Direction::FilmToScene);
    let distance = FirstOrder::of(lens).expect("focal").back_focal_distance();
    let (plane, semi_diameter) = (lens.rear().vertex - distance, lens.rear().semi_diameter);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut disk = |radius: f64| {
        let r = radius * random.random::<f64>().sqrt();
        let turn = std::f64::consts::TAU * random.random::<f64>();
        [r * turn.cos(), r * turn.sin()]
    };
    let mut ray = || {
        let ([x, y], aim) = (disk(17.5), disk(semi_diameter));
        Ray { origin: [x, y, plane], direction: [aim[0] - x, aim[1] - y, distance] }
    };
    let mut rays = FilmRays::<S>::new(plane, &(0..count).map(|_| ray()).collect::<Vec<_>>());
    rays.trace(count, |from, to| kernel.trace_batch(from, to));
    let (mut directions, mut positions, mut disagreements) = (Vec::new(), Vec::new(), 0);
    for i in 0..count {
        let (point, slopes) = rays.at_film(i);
        let ([x, y], [sx, sy]) = (point.map(Real::to_f64), slopes.map(Real::to_f64));
        let exact = reference.trace(Ray { origin: [x, y, plane], direction: [sx, sy, 1.0] });
        match (exact, rays.traced(i)) {
            (Ok(exact), Some(got)) => {
                directions.push(exact.direction_error(&got));
                positions.push(exact.position_error(&got, lens.front().vertex));
            }
            (Err(_), None) => {}
            _ => disagreements += 1,
        }
    }
    println!(
        "{} rays of {count} pass; direction {:?} rad, position {:?} mm, {disagreements} disagree",
        directions.len(),
        Spread::of(&directions),
        Spread::of(&positions),
    );
    (directions, disagreements)
}

fn kernels_keep_their_errors(rays: usize) {
    let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("in the catalogue"));
    let (errors_f64, disagreements) = errors::<f64>(&lens, rays);
    let most = quantile(&errors_f64, 1.0);
    assert!(errors_f64.len() > rays / 2 && most < 4e-15 && disagreements == 0, "{most:e}");
    let (errors_f32, disagreements) = errors::<f32>(&lens, rays);
    let [median, most] = [0.5, 1.0].map(|q| quantile(&errors_f32, q));
    assert!(errors_f32.len() > rays / 2 && median < 1e-7 && most < 1e-6, "{median:e}, {most:e}");
    assert!(disagreements <= 2 + rays / 100_000, "{disagreements}");
}

#[test]
fn the_kernels_errors_on_a_double_gauss_are_a_few_roundings() {
    kernels_keep_their_errors(20_000);
}

#[test]
#[ignore = "the record's own count of rays: a minute"]
fn the_kernels_errors_on_a_million_rays_are_a_few_roundings() {
    kernels_keep_their_errors(2_000_000);
}
