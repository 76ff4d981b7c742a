//! The kernel on lenses that are not round, against the walk: random lenses of every kind, both directions, both
//! precisions, all instruction sets.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use realistic_optics::{
    lens::{Lens, Ray},
    prescription::read,
    trace::{Direction, Path},
};
use realistic_simd::Simd;
use realistic_trace::kernel::{Kernel, KernelScalar, RayBuffer, Traced};

/// Returns the text of a random lens that is not round: glass elements with figures and breaks, and perhaps two mirrors.
fn random_lens(random: &mut Xoshiro256PlusPlus) -> String {
    let mut rows = String::new();
    let mut lines = String::new();
    let elements = random.random_range(1..4);
    let mut row = 0;
    let signed = |low: f64, high: f64, random: &mut Xoshiro256PlusPlus| {
        let size = random.random_range(low..high);
        if random.random_bool(0.5) { size } else { -size }
    };
    for element in 0..elements {
        for behind in ["1.6", "1"] {
            row += 1;
            let radius = signed(25.0, 200.0, random);
            let thickness = if behind == "1" { 3.0 } else { 5.0 };
            rows += &format!("{radius} {thickness} {behind} 16\n");
            let other = signed(25.0, 200.0, random);
            lines += &match random.random_range(0..8) {
                0 => format!("toroid {row} profile={}\n", if random.random_bool(0.5) { "x" } else { "y" }),
                1 => format!("toroid {row} rotation={other} conic=-0.7 A4={}\n", signed(1e-7, 1e-5, random)),
                2 => format!("biconic {row} x={other} conic_x=0.5 conic_y=-1.2\n"),
                3 => format!("toroid {row} profile=x conic=-2\n"),
                4 => format!("asphere {row} conic=-1 A4={}\n", signed(1e-7, 1e-6, random)),
                _ => String::new(),
            };
            if random.random_bool(0.3) {
                let [x, y] = [0.5, 0.7].map(|size| signed(0.0, size, random));
                let [a, b, c] = [3.0, 3.0, 30.0].map(|size| signed(0.0, size, random));
                lines += &format!("break {row} x={x} y={y} tilt_x={a} tilt_y={b} tilt_z={c}\n");
            }
        }
        if element == 0 {
            row += 1;
            rows += "stop 3 1 12\n";
            if random.random_bool(0.3) {
                lines += &format!("break {row} tilt_x={}\n", signed(0.0, 10.0, random));
            }
        }
    }
    if random.random_bool(0.3) {
        // A fold by a tilted mirror, which may be curved.
        let figure = if random.random_bool(0.5) { "inf" } else { "-300" };
        rows += &format!("{figure} -20 1 40\n");
        row += 1;
        lines += &format!("mirror {row}\nbreak {row} z=20 tilt_x=30\nbreak film tilt_x=30\n");
    } else if random.random_bool(0.3) {
        lines += "break film x=0.3 tilt_y=2\n";
    }
    rows + &lines
}

fn rays(lens: &Lens, direction: Direction, random: &mut Xoshiro256PlusPlus) -> Vec<Ray> {
    let (z, sign) = match direction {
        Direction::FilmToScene => (lens.rear().vertex - 30.0, 1.0),
        Direction::SceneToFilm => (25.0, -1.0),
    };
    let mut ray = || {
        let [x, y] = [0, 1].map(|_| random.random_range(-6.0..6.0));
        let [a, b] = [0, 1].map(|_| random.random_range(-8.0..8.0));
        Ray { origin: [x, y, z], direction: [(a - x) / 30.0, (b - y) / 30.0, sign] }
    };
    (0..200).map(|_| ray()).collect()
}

/// Returns the number of rays that pass, and the largest deviation from the walk.
fn compare<S: KernelScalar + std::fmt::Debug>(
    lens: &Lens,
    direction: Direction,
    rays: &[Ray],
    error: f64,
) -> usize {
    let path = Path::<f64>::new(lens, direction, Default::default());
    let expected: Vec<_> = rays.iter().map(|ray| path.trace(*ray)).collect();
    let mut passed = 0;
    let mut bits: Option<Vec<Option<Traced<S>>>> = None;
    for simd in [Simd::Portable, Simd::Avx2, Simd::Avx512] {
        let Some(kernel) = Kernel::<S>::with_simd(lens, direction, simd) else { continue };
        let mut buffer = RayBuffer::<S>::new(rays.len());
        for (i, ray) in rays.iter().enumerate() {
            buffer.put(i, ray.origin, ray.direction);
        }
        kernel.trace_in_place(&mut buffer.rays());
        let own: Vec<_> = (0..rays.len()).map(|i| buffer.get(i)).collect();
        let mut differ = 0;
        for (own, expected) in own.iter().zip(&expected) {
            match (own, expected) {
                (Some(own), Ok(expected)) => {
                    let own = own.ray();
                    // Points along the ray are equally good.
                    let t = (expected.origin[2] - own.origin[2]) / own.direction[2];
                    for i in 0..3 {
                        let off = own.origin[i] + t * own.direction[i] - expected.origin[i];
                        let turned = own.direction[i] - expected.direction[i];
                        assert!(off.abs() < 20.0 * error && turned.abs() < error, "{own:?} {expected:?}");
                    }
                    passed += 1;
                }
                (None, Err(_)) => {}
                _ => differ += 1,
            }
        }
        // Rays within rounding of an edge may differ.
        assert!(differ <= usize::from(S::EPSILON > 1e-10), "{differ} rays differ");
        match &bits {
            Some(bits) => assert!(bits == &own, "every width gives the same bits"),
            None => bits = Some(own),
        }
    }
    passed
}

#[test]
fn the_kernel_agrees_with_the_walk_on_random_lenses_that_are_not_round() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(62);
    let (mut passed, mut lenses) = (0, 0);
    for _ in 0..200 {
        let text = random_lens(&mut random);
        let lens = match read("random", text.as_bytes()) {
            Ok(lens) => Lens::at_d_line(&lens),
            Err(error) => panic!("{error}\n{text}"),
        };
        for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
            let rays = rays(&lens, direction, &mut random);
            let context = format!("{direction:?}\n{text}");
            let run = || {
                let passed = compare::<f64>(&lens, direction, &rays, 1e-12);
                compare::<f32>(&lens, direction, &rays, 3e-5);
                passed
            };
            match std::panic::catch_unwind(run) {
                Ok(own) => passed += own,
                Err(_) => panic!("{context}"),
            }
        }
        lenses += 1;
    }
    println!("{passed} rays through {lenses} lenses");
    assert!(passed > 45_000, "{passed}");
}

#[test]
fn lenses_that_begin_and_end_with_mirrors_agree_with_the_walk() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    for text in [
        // A paraboloid and a hyperboloid, two spheres, and a single tilted sphere.
        "-300 -100 1 100\n-142.8 150 1 40\nmirror 1\nmirror 2\nasphere 1 conic=-1\nasphere 2 conic=-3.4\n",
        "-300 -100 1 100\n-142.8 150 1 40\nmirror 1\nmirror 2\n",
        "-300 -100 1 60\nmirror 1\nbreak 1 tilt_x=10\nbreak film tilt_x=10\n",
    ] {
        let lens = Lens::at_d_line(&read("mirrors", text.as_bytes()).expect("a lens"));
        let to_film: Vec<Ray> = (0..400)
            .map(|_| {
                let [x, y] = [0, 1].map(|_| random.random_range(-25.0..25.0));
                let [a, b] = [0, 1].map(|_| random.random_range(-0.01..0.01));
                Ray { origin: [x, y, 150.0], direction: [a, b, -1.0] }
            })
            .collect();
        let path = Path::<f64>::scene_to_film(&lens);
        // Rays that arrive are turned back, from a point behind the last surface.
        let to_scene: Vec<Ray> = (to_film.iter())
            .filter_map(|ray| {
                let Ray { origin, direction } = path.trace(*ray).ok()?;
                let origin = [0, 1, 2].map(|axis| origin[axis] + 20.0 * direction[axis]);
                Some(Ray { origin, direction: direction.map(|part| -part) })
            })
            .collect();
        assert!(compare::<f64>(&lens, Direction::SceneToFilm, &to_film, 1e-12) > 500, "{text}");
        assert!(compare::<f64>(&lens, Direction::FilmToScene, &to_scene, 1e-12) > 500, "{text}");
        compare::<f32>(&lens, Direction::FilmToScene, &to_scene, 3e-5);
    }
}
