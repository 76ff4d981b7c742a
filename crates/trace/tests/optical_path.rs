//! Optical paths: the kernel against the walk through the whole catalogue, and surfaces that image a point perfectly,
//! for which all paths are equal (Fermat's principle).

use realistic_optics::{
    lens::{Lens, Ray, film_ray},
    prescription::{catalogue, read},
    trace::{Direction, Path},
};
use realistic_trace::kernel::{PathKernel, PlaneRays, RayBuffer};

/// Returns a number in [0, 1) for each step of a low-discrepancy sequence.
fn spread(i: u32, step: f64) -> f64 {
    (0.5 + f64::from(i) * step).fract()
}

#[test]
fn the_kernel_returns_the_walks_optical_path_through_every_lens() {
    for name in catalogue::names() {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
            let path = Path::<f64>::new(&lens, direction, Default::default());
            let kernel = PathKernel::new(&lens, direction);
            let [film, rear] = [lens.rear().vertex - 40.0, lens.rear().semi_diameter];
            let ray = |i: u32| {
                let at = |step: f64| 2.0 * spread(i, step) - 1.0;
                let [x, y] = [10.0 * at(0.856_674_883_854_502_9), 8.0 * at(0.733_891_856_627_126)];
                let [u, v] = [rear * at(0.628_706_721_037_808_7), rear * at(0.538_597_257_225_901_9)];
                film_ray([x, y], film, [(u - x) / 40.0, (v - y) / 40.0])
            };
            // Rays from the scene are those from the film turned back.
            let to_scene = Path::<f64>::film_to_scene(&lens);
            let turned = |ray: Ray| {
                let Ray { origin, direction } = to_scene.trace(ray).ok()?;
                let origin = std::array::from_fn(|i| origin[i] + 300.0 * direction[i]);
                Some(Ray { origin, direction: direction.map(|part| -part) })
            };
            let rays: Vec<Ray> = match direction {
                Direction::FilmToScene => (0..400).map(ray).collect(),
                Direction::SceneToFilm => (0..400).map(ray).filter_map(turned).collect(),
            };
            let (mut buffer, mut paths) = (RayBuffer::new(rays.len()), vec![f64::NAN; rays.len()]);
            for (i, ray) in rays.iter().enumerate() {
                buffer.put(i, ray.origin, ray.direction);
            }
            kernel.trace_in_place(&mut buffer.rays(), &mut paths);
            let mut passed = 0;
            for (i, ray) in rays.iter().enumerate() {
                let walk = path.walk(*ray);
                if walk.blocked.is_some() {
                    continue;
                }
                let own = paths[i];
                let error = (own - walk.optical_path).abs();
                assert!(error < 1e-12 * walk.optical_path.max(1.0), "{name} {direction:?}: {error:e}");
                passed += 1;
            }
            assert!(passed > 10, "{name} {direction:?}: {passed}");
        }
    }
}

#[test]
fn rays_from_a_plane_and_from_points_have_the_same_optical_paths() {
    let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("listed"));
    let kernel = PathKernel::new(&lens, Direction::FilmToScene);
    let film = lens.rear().vertex - 36.0;
    let [x, y, slope_x, slope_y] = [[1.0, -3.0, 90.0], [2.0, 5.0, 0.0], [0.02, 0.1, 0.0], [0.0, -0.1, 0.0]];
    let (mut a, mut paths) = (RayBuffer::new(3), [f64::NAN; 3]);
    let from = PlaneRays { plane: film, x: &x, y: &y, slope_x: &slope_x, slope_y: &slope_y };
    kernel.trace_batch(&from, &mut a.rays(), &mut paths);
    let (mut b, mut others) = (RayBuffer::new(3), [f64::NAN; 3]);
    for i in 0..3 {
        b.put(i, [x[i], y[i], film], [slope_x[i], slope_y[i], 1.0]);
    }
    kernel.trace_in_place(&mut b.rays(), &mut others);
    for i in 0..2 {
        assert!((paths[i] - others[i]).abs() < 2e-13 && paths[i] > 36.0, "{} {}", paths[i], others[i]);
    }
    assert_eq!([paths[2], others[2]], [0.0; 2], "a blocked ray");
}

/// Returns the spread of the optical paths to a point of image space of rays through a lens.
fn spread_to(text: &str, rays: impl Iterator<Item = Ray>, focus: [f64; 3], n: f64) -> f64 {
    let lens = Lens::at_d_line(&read("perfect", text.as_bytes()).expect("a lens"));
    let path = Path::<f64>::scene_to_film(&lens);
    let (mut least, mut most, mut passed) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    for ray in rays {
        let walk = path.walk(ray);
        assert_eq!(walk.blocked, None, "{ray:?}");
        let Ray { origin, direction } = walk.ray;
        let to: [f64; 3] = std::array::from_fn(|i| focus[i] - origin[i]);
        let rest: f64 = (0..3).map(|i| to[i] * direction[i]).sum();
        let whole = walk.optical_path + n * rest;
        (least, most, passed) = (least.min(whole), most.max(whole), passed + 1);
    }
    assert!(passed > 50);
    most - least
}

#[test]
fn perfect_conics_have_equal_optical_paths() {
    let heights = || (0..=60).map(|i| f64::from(i) * 0.3);
    let parallel = |x: f64| Ray { origin: [x, 0.3 * x, 40.0], direction: [0.0, 0.0, -1.0] };
    // An ellipsoid of eccentricity 1/n focuses parallel light in glass, R n/(n - 1) behind its vertex.
    let n = 1.5;
    let focus = [0.0, 0.0, -50.0 * n / (n - 1.0)];
    let ellipsoid = format!("50 0 {n} 60\nasphere 1 conic={}\n", -1.0 / (n * n));
    assert!(spread_to(&ellipsoid, heights().map(parallel), focus, n) < 1e-12);
    // A sphere of the same curvature does not.
    assert!(spread_to("50 0 1.5 60\n", heights().map(parallel), focus, n) > 1e-3);
    // A paraboloid focuses parallel light at half its radius; behind the mirror image space has z reversed.
    let paraboloid = "-200 0 1 60\nmirror 1\nasphere 1 conic=-1\n";
    assert!(spread_to(paraboloid, heights().map(parallel), [0.0, 0.0, -100.0], 1.0) < 1e-12);
}
