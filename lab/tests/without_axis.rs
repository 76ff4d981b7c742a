//! Lenses without an axis, and optical paths, in the walk and in the kernels against the reference of 77 digits.

use realistic_lab::{
    reference::{DoubleDouble, ExactRay, Wide, condition::Conditioned},
    stability::random::Kind,
    subject::kernel_rays::KernelRays,
};
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    prescription::{catalogue, read},
    trace::{
        Direction::{self, FilmToScene, SceneToFilm},
        Path, Ray, Real,
    },
};
use realistic_simd::Simd;
use realistic_trace::kernel::{PathKernel, RayBuffer};

/// A biconvex element in front of a stop and a weak doublet.
const ROWS: &str =
    "60 6 1.6 24\n-90 4 1 24\nstop 4 1 12\n-70 3 1.7 18\n200 1 1 18\n120 5 1.6 20\n-40 0 1 20\n";

fn lens(text: &str) -> Lens {
    Lens::at_d_line(&read("test", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// Returns a lens of every kind that has no axis, with its name.
fn lenses() -> Vec<(&'static str, Lens)> {
    let with = |lines: &str| format!("{ROWS}{lines}");
    let anamorphic = "-100 2 1.5 46\ninf 50 1 46\n150 4 1.5 46\ninf 10 1 46\n80 5 1.5 24\n-80 4 1 24\nstop 0 1 14\n\
                      toroid 1 profile=x\ntoroid 3 profile=x conic=-0.7\ntoroid 5 conic=0.4\n";
    let terms = "toroid 1 rotation=45 conic=-0.5 A2=1e-4 A4=1e-6 A6=-2e-8 A14=1e-16\ntoroid 6 profile=x rotation=-80 A4=-1e-6\n";
    let cassegrain = "-300 -100 1 100\n-142.857142857142857 150 1 40\nmirror 1\nmirror 2\nasphere 1 conic=-1\n\
                      asphere 2 conic=-3.4489795918367347\nbreak 2 x=0.4 tilt_y=0.3\n";
    let fold = "60 6 1.6 24\n-90 4 1 24\nstop 20 1 12\ninf -50 1 26\nmirror 4\nbreak 4 tilt_x=45\nbreak film tilt_x=45\n";
    let all = [
        ("cylinders", anamorphic.to_owned()),
        ("toroids", with(terms)),
        (
            "biconics",
            with("biconic 1 x=75 conic_x=0.3 conic_y=-0.8\nbiconic 7 x=-35 conic_x=-2\nbiconic 4 x=inf\n"),
        ),
        ("decentred", with("break 4 x=1.5 y=-0.8\nbreak 6 x=-1.5 y=0.8\nbiconic 6 x=80\n")),
        (
            "tilted",
            with(
                "break 1 tilt_x=4 tilt_y=-3\nbreak 3 first=tilt tilt_x=-4 tilt_y=3\nbreak film tilt_x=3 x=0.5\n",
            ),
        ),
        ("mirrors", cassegrain.to_owned()),
        ("fold", fold.to_owned()),
    ];
    all.map(|(name, text)| (name, lens(&text))).into()
}

/// Returns rays from the film's side toward the rear surface, or the ways back of those that pass.
fn rays(lens: &Lens, direction: Direction, count: i32) -> Vec<Ray> {
    let rear = lens.rear();
    let at = |i: i32, n: i32| f64::from(i * n % 101) / 50.0 - 1.0;
    let from_film = (0..count).map(|i| {
        let point = [9.0 * at(i, 13), 7.0 * at(i, 37)];
        let target = [29, 53].map(|n| 0.9 * rear.semi_diameter * at(i, n));
        let direction = [target[0] - point[0], target[1] - point[1], 60.0];
        Ray { origin: [point[0], point[1], rear.vertex - 60.0], direction }
    });
    if direction == FilmToScene {
        return from_film.collect();
    }
    let path = Path::<f64>::film_to_scene(lens);
    let back = |ray: Ray| Ray {
        origin: std::array::from_fn(|i| ray.origin[i] + 40.0 * ray.direction[i]),
        direction: ray.direction.map(|part| -part),
    };
    from_film.filter_map(|ray| Some(back(path.trace(ray).ok()?))).collect()
}

/// The largest errors of a tracer against the reference.
#[derive(Debug, Default)]
struct Errors {
    passed: u32,
    position: f64,
    direction: f64,
    path: f64,
}

impl Errors {
    fn add(&mut self, exact: &ExactRay<Wide>, got: &Ray, exit: f64) {
        self.passed += 1;
        self.position = self.position.max(exact.position_error(got, exit));
        self.direction = self.direction.max(exact.direction_error(got));
    }
}

/// Traces rays through a lens by the walk and the kernel in double precision, and compares them with the reference.
fn errors(lens: &Lens, direction: Direction, rays: &[Ray]) -> [Errors; 2] {
    let exit = if direction == FilmToScene { lens.front().vertex } else { lens.rear().vertex };
    let reference = Conditioned::new(lens, direction);
    let path = Path::<f64>::new(lens, direction, Refraction::Fused);
    let kernel = KernelRays::<f64>::new(lens, direction, Simd::best()).expect("the best is available");
    let with_path = PathKernel::new(lens, direction);
    let mut errors = [Errors::default(), Errors::default()];
    for (ray, by_kernel) in rays.iter().zip(kernel.batch(rays)) {
        let trail = reference.follow::<Wide>(*ray);
        let walk = path.walk(*ray);
        // A decision that no double can make is not tested.
        if trail.surface.margin < 1e-13 {
            continue;
        }
        assert_eq!(walk.blocked.is_some(), trail.exact.is_err(), "{ray:?}: {walk:?} {trail:?}");
        assert_eq!(by_kernel.is_none(), trail.exact.is_err(), "{ray:?}: {trail:?}");
        assert_eq!(kernel.one(*ray), by_kernel);
        let (Ok(exact), Some(by_kernel)) = (&trail.exact, by_kernel) else { continue };
        let (mut columns, mut own) = (RayBuffer::new(1), [0.0]);
        columns.put(0, ray.origin, ray.direction);
        with_path.trace_in_place(&mut columns.rays(), &mut own);
        let results = [(walk.ray, walk.optical_path), (by_kernel, own[0])];
        for (errors, (ray, path)) in errors.iter_mut().zip(results) {
            errors.add(exact, &ray, exit);
            errors.path = errors.path.max((trail.optical_path - Wide::from_f64(path)).to_f64().abs());
        }
    }
    errors
}

fn hold(name: &str, lens: &Lens, least: u32) {
    for direction in [FilmToScene, SceneToFilm] {
        for (tracer, found) in
            ["walk", "kernel"].iter().zip(errors(lens, direction, &rays(lens, direction, 200)))
        {
            println!("{name}, {direction:?}, {tracer}: {found:?}");
            assert!(found.passed >= least, "{name}, {direction:?}: {found:?}");
            assert!(
                found.position < 1e-12 && found.path < 1e-12 && found.direction < 1e-13,
                "{name}: {found:?}"
            );
        }
    }
}

#[test]
fn rays_and_optical_paths_of_lenses_without_an_axis_agree_with_77_digits() {
    for (name, lens) in lenses() {
        hold(name, &lens, 20);
    }
}

#[test]
fn rays_and_optical_paths_of_round_lenses_agree_with_77_digits() {
    for name in ["dgauss.50mm", "fisheye.10mm", "wide.22mm", "telephoto.250mm", "phone.4mm"] {
        hold(name, &Lens::at_d_line(&catalogue::find(name).expect("in the catalogue")), 5);
    }
}

/// Returns the reference's ray in 77 digits.
fn exact(lens: &Lens, direction: Direction, ray: Ray) -> Option<[[Wide; 3]; 2]> {
    let exact = Conditioned::new(lens, direction).follow::<Wide>(ray).exact.ok()?;
    Some([exact.point, exact.direction])
}

fn apart<R: Real>(a: [[R; 3]; 2], b: [[R; 3]; 2]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (*a - *b).to_f64().abs()).fold(0.0, f64::max)
}

#[test]
fn figures_that_are_surfaces_of_revolution_have_their_rays() {
    let round = "50 6 1.5 30\n-70 3 1.7 30\n-200 0 1 30\nasphere 2 conic=-0.75\n";
    let forms = [
        "50 6 1.5 30\n-70 3 1.7 30\n-200 0 1 30\ntoroid 1 rotation=50\nbiconic 2 x=-70 conic_x=-0.75 conic_y=-0.75\n",
        "50 6 1.5 30\n-70 3 1.7 30\n-200 0 1 30\nbiconic 1 x=50\nasphere 2 conic=-0.75\ntoroid 3 rotation=-200 profile=x\n",
    ];
    let round = lens(round);
    for form in forms {
        let own = lens(form);
        for direction in [FilmToScene, SceneToFilm] {
            let mut passed = 0;
            for ray in rays(&round, direction, 100) {
                let (Some(a), Some(b)) = (exact(&round, direction, ray), exact(&own, direction, ray)) else {
                    continue;
                };
                passed += 1;
                assert!(apart(a, b) < 1e-70, "{form} {ray:?}: {:e}", apart(a, b));
            }
            assert!(passed > 40, "{passed}");
        }
    }
}

#[test]
fn a_turn_of_the_whole_lens_turns_its_rays() {
    // Frames that are turned by 90 degrees about the axis have matrices without rounding, but for cos 90°.
    for (name, lens) in lenses() {
        let turned = lens.turned();
        let turn = |[x, y, z]: [f64; 3]| [-y, x, z];
        for ray in rays(&lens, SceneToFilm, 60) {
            let other = Ray { origin: turn(ray.origin), direction: turn(ray.direction) };
            let Some([point, direction]) = exact(&lens, SceneToFilm, ray) else { continue };
            let own = exact(&turned, SceneToFilm, other);
            let turn = |[x, y, z]: [Wide; 3]| [-y, x, z];
            let own = own.unwrap_or_else(|| panic!("{name} {ray:?} is blocked in the turned lens"));
            let error = apart(own, [turn(point), turn(direction)]);
            assert!(error < 1e-12, "{name} {ray:?}: {error:e}");
        }
    }
}

/// Returns a double-double number as one of 256 bits.
fn widened(v: [DoubleDouble; 3]) -> [Wide; 3] {
    v.map(|x| {
        let high = x.to_f64();
        Wide::from_f64(high) + Wide::from_f64((x - DoubleDouble::from_f64(high)).to_f64())
    })
}

#[test]
fn random_lenses_have_the_same_rays_in_both_precisions_of_the_reference_and_in_the_walk() {
    let (mut passed, mut worst, mut worst_walk) = ([0; 3], 0.0_f64, [0.0_f64; 3]);
    for (kind, (passed, worst_walk)) in Kind::ALL.into_iter().zip(passed.iter_mut().zip(&mut worst_walk)) {
        for number in 0..40 {
            let case = kind.case(number);
            let reference = Conditioned::new(&case.lens, case.direction);
            let path = Path::<DoubleDouble>::new(&case.lens, case.direction, Refraction::Fused);
            for ray in case.rays.iter().step_by(5) {
                let (short, long) = (reference.follow::<DoubleDouble>(*ray), reference.follow::<Wide>(*ray));
                // A decision that the constants of the walk, which are doubles, cannot make is not tested.
                if short.surface.margin < 1e-13 {
                    continue;
                }
                let exact = |v: [f64; 3]| v.map(DoubleDouble::from_f64);
                let walk = path.trace_in_full(exact(ray.origin), exact(ray.direction));
                let fates = [short.exact.is_ok(), walk.is_ok()];
                assert_eq!(fates, [long.exact.is_ok(); 2], "{} {ray:?}", case.name);
                let (Ok(a), Ok(b), Ok(walk)) = (short.exact, long.exact, walk) else { continue };
                *passed += 1;
                let condition = short.surface.position.max(short.surface.direction).max(1.0);
                let error = |point, direction| {
                    apart([widened(point), widened(direction)], [b.point, b.direction]) / condition
                };
                worst = worst.max(error(a.point, a.direction));
                *worst_walk = worst_walk.max(error(walk.0, walk.1));
            }
        }
    }
    println!("{passed:?} rays, {worst:.1e}, the walk {worst_walk:?}");
    assert!(passed.iter().all(|passed| *passed > 100) && worst < 1e-29, "{passed:?} {worst:e}");
    // Reciprocal radii and frames of surfaces without symmetry are doubles in the walk.
    let [spheres, aspheres, without_axis] = worst_walk;
    assert!(spheres < 1e-27 && aspheres < 1e-27 && without_axis < 1e-15, "{worst_walk:?}");
}

/// Half the Chebyshev polynomial T6 of y/10, plus a half: waves, 1 mm high, inside a semi-diameter of 10 mm.
const WAVES: [(i32, f64); 3] = [(2, 9.0 / 1e2), (4, -24.0 / 1e4), (6, 16.0 / 1e6)];

#[test]
fn the_crossing_is_the_first_where_a_ray_crosses_a_surface_again_and_again() {
    let [a2, a4, a6] = WAVES.map(|(_, term)| term);
    for (profile, along, rotation) in
        [("y", 1, f64::INFINITY), ("x", 0, f64::INFINITY), ("y", 1, 60.0), ("x", 0, -60.0)]
    {
        let waves = format!("profile={profile} rotation={rotation} A2={a2:e} A4={a4:e} A6={a6:e}");
        let lens = lens(&format!("inf 0 1.5 20\ntoroid 1 {waves}\n"));
        // z toward the film.
        let height = |point: [f64; 3]| {
            let f: f64 = WAVES.iter().map(|(power, term)| term * point[along].powi(*power)).sum();
            let (x, q) = (point[1 - along], rotation - f);
            if rotation.is_infinite() { f } else { rotation - rotation.signum() * (q * q - x * x).sqrt() }
        };
        let ray = |i: i32| {
            let at = |n: i32| f64::from(i * n % 101) / 50.0 - 1.0;
            let mut origin = [3.0 * at(13), 3.0 * at(13), 0.0];
            let mut direction = [0.2 * at(53), 0.2 * at(53), -0.1 - 0.09 * at(37)];
            (origin[along], direction[along]) = (-8.5, 1.0);
            origin[2] = 0.02 + 0.3 * at(29).abs() - height(origin);
            Ray { origin, direction }
        };
        let rays: Vec<Ray> = (0..400).map(ray).collect();
        let reference = Conditioned::new(&lens, SceneToFilm);
        let path = Path::<f64>::new(&lens, SceneToFilm, Refraction::Fused);
        let kernel = KernelRays::<f64>::new(&lens, SceneToFilm, Simd::best()).expect("the best is available");
        let (mut met, mut again, mut passed) = (0, 0, 0);
        for (ray, by_kernel) in rays.iter().zip(kernel.in_place(&rays)) {
            // The ray in small steps: where it gets behind the surface, inside the clear aperture.
            const STEP: f64 = 1e-3;
            let at = |t: f64| -> [f64; 3] { std::array::from_fn(|i| ray.origin[i] + t * ray.direction[i]) };
            let behind = |t: f64| -at(t)[2] > height(at(t));
            let crossings: Vec<f64> = (0..20_000)
                .map(|i| STEP * f64::from(i))
                .take_while(|&t| at(t)[0].hypot(at(t)[1]) < 9.99)
                .filter(|&t| !behind(t) && behind(t + STEP))
                .collect();
            let Some(&first) = crossings.first() else { continue };
            let trail = reference.follow::<Wide>(*ray);
            // Where a ray nearly touches a crest, the steps miss what lies between them.
            if trail.surface.margin < 1e-6 {
                continue;
            }
            met += 1;
            again += u32::from(crossings.len() > 1);
            let own = path.first_point(*ray).unwrap_or_else(|| panic!("{ray:?} crosses at {first}"));
            let t = own[along] - ray.origin[along];
            assert!(t > first - 1e-9 && t < first + STEP + 1e-9, "{ray:?}: {t} for {first}");
            let walk = path.trace(*ray);
            assert_eq!(walk.is_ok(), trail.exact.is_ok(), "{ray:?}: {walk:?}");
            assert_eq!(by_kernel.is_some(), trail.exact.is_ok(), "{ray:?}: {by_kernel:?}");
            let (Ok(exact), Ok(walk), Some(by_kernel)) = (trail.exact, walk, by_kernel) else { continue };
            passed += 1;
            for ray in [walk, by_kernel] {
                assert!(exact.position_error(&ray, lens.rear().vertex) < 1e-12, "{ray:?}");
            }
        }
        println!("{waves}: {met} rays, {passed} pass, {again} cross again");
        assert!(met > 150 && again > 50 && passed > 50, "{waves}: {met} {again} {passed}");
    }
}
