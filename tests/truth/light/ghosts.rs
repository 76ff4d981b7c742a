//! Paths with two reflections, compared with explicit reflection and a closed form, and traced from both ends.

use super::{
    super::support::{Random, lens},
    FILM, exact_surfaces, near, oracle, rays,
};
use realistic_light::{Ghosts, Lamp, LitPath, Surfaces};
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::{Coating, catalogue},
    trace::{Direction, Path},
};
use realistic_trace::kernel::{Kernel, RayBuffer};

#[test]
fn a_thin_lens_ghost_is_in_focus_where_the_formula_says() {
    for n in [1.5, 1.7] {
        let text = format!("100 1e-6 {n} 10\n-100 0 1 10\n");
        let thin = Lens::at_d_line(&realistic::read("thin", text.as_bytes()).expect("a lens"));
        let ghost = Path::<f64>::reflected(&thin, Direction::SceneToFilm, Refraction::Fused, [0, 1]);
        let height = 1e-3;
        let ray = Ray { origin: [height, 0.0, 5.0], direction: [0.0, 0.0, -1.0] };
        let after = ghost.trace(ray).expect("passes");
        let focus = after.origin[2] - after.origin[0] * after.direction[2] / after.direction[0];
        let f = 50.0 / (n - 1.0);
        near(-focus, f * (n - 1.0) / (3.0 * n - 1.0), 1e-5);
    }
}

#[test]
fn ghosts_are_what_explicit_reflection_makes_of_them() {
    let mut most: f64 = 0.0;
    let mut count = 0;
    for name in ["dgauss.50mm", "wide.22mm"] {
        let lens = lens(name);
        let surfaces = exact_surfaces(&lens, Coating::QuarterWave);
        let all = surfaces.reflecting();
        for (at, near) in all.iter().enumerate() {
            for far in &all[at + 1..] {
                let turns = [*near, *far];
                let path = Path::reflected(&lens, Direction::SceneToFilm, Refraction::Fused, turns);
                let lit = LitPath::new(path, &surfaces);
                // Traced from the film, the surfaces of the same path are numbered from the film side.
                let last = lens.surfaces.len() - 1;
                let back = Path::reflected(
                    &lens,
                    Direction::FilmToScene,
                    Refraction::Fused,
                    [last - far, last - near],
                );
                let back = LitPath::new(back, &surfaces);
                for ray in rays(&lens, 300, 11) {
                    let found = lit.trace(ray).ok().filter(|(ray, _)| ray.direction[2] < 0.0);
                    let other = oracle::trace(&lens, Some(FILM), Some(turns), ray.origin, ray.direction);
                    let (Some((after, power)), Some((expected, origin, direction))) = (found, other) else {
                        continue;
                    };
                    count += 1;
                    let size = lens.front().semi_diameter;
                    for k in 0..3 {
                        assert!((after.origin[k] - origin[k]).abs() < 1e-9 * size, "{name} {turns:?}");
                        assert!((after.direction[k] - direction[k]).abs() < 1e-9, "{name} {turns:?}");
                    }
                    assert!((power / expected - 1.0).abs() < 1e-8, "{name} {turns:?}: {power} {expected}");
                    let turned = Ray {
                        origin: std::array::from_fn(|k| after.origin[k] + after.direction[k]),
                        direction: after.direction.map(|x| -x),
                    };
                    if let Ok((_, again)) = back.trace(turned) {
                        most = most.max((again / power - 1.0).abs());
                    }
                }
            }
        }
    }
    assert!(count > 3000, "{count}");
    assert!(most < 1e-8, "from the film and from the light: {most}");
}

#[test]
fn an_even_skys_ghosts_have_one_flux_from_both_sides() {
    // Étendue, cos⁴ dA d(slope)², is conserved along a ray, and the radiance of the sky is 1.
    let lens = lens("dgauss.50mm");
    let surfaces = Surfaces::new(&lens, Coating::Bare);
    let (film, spot) = (lens.rear().vertex - 36.0, 8.0);
    let (front, rear) = (lens.front().semi_diameter, lens.rear().semi_diameter);
    let last = lens.surfaces.len() - 1;
    for [near, far] in [[6, 8], [3, 7], [9, 10]] {
        let path = |direction, turns| {
            LitPath::new(Path::reflected(&lens, direction, Refraction::Fused, turns), &surfaces)
        };
        let from_light = path(Direction::SceneToFilm, [near, far]);
        let from_film = path(Direction::FilmToScene, [last - far, last - near]);
        let mut random = Random::new(5);
        let mut disk = |radius: f64| loop {
            let [x, y] = [random.signed(), random.signed()];
            if x * x + y * y <= 1.0 {
                return [radius * x, radius * y];
            }
        };
        let area = |radius: f64| std::f64::consts::PI * radius * radius;
        let cos4 = |[x, y]: [f64; 2]| (1.0 + x * x + y * y).powi(-2);
        let estimate = |count: u32, whole: f64, one: &mut dyn FnMut() -> f64| {
            let (sum, squares) = (0..count).fold((0.0, 0.0), |(sum, squares), _| {
                let value = one();
                (sum + value, squares + value * value)
            });
            let mean = sum / f64::from(count);
            [whole * mean, whole * ((squares / f64::from(count) - mean * mean) / f64::from(count)).sqrt()]
        };
        // Rays that cross a disk in front of the lens at up to 31 degrees.
        let (reach, steepest) = (1.2 * front, 0.6);
        let light = estimate(400_000, area(reach) * area(steepest), &mut || {
            let (at, slopes) = (disk(reach), disk(steepest));
            let direction = [slopes[0], slopes[1], -1.0];
            let Ok((ray, left)) = from_light.trace(Ray { origin: [at[0], at[1], 0.0], direction }) else {
                return 0.0;
            };
            let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
            let along = (film - z) / dz;
            let lands = dz < 0.0 && (x + along * dx).hypot(y + along * dy) <= spot;
            if lands { cos4(slopes) * left } else { 0.0 }
        });
        // The part of the rear vertex plane that contains all rays from the spot.
        let wide = 1.2 * rear;
        let sky = estimate(400_000, area(spot) * area(wide) / 36.0_f64.powi(2), &mut || {
            let (at, to) = (disk(spot), disk(wide));
            let slopes = [0, 1].map(|axis| (to[axis] - at[axis]) / 36.0);
            let found =
                from_film.trace(Ray { origin: [at[0], at[1], film], direction: [slopes[0], slopes[1], 1.0] });
            let arrives = |(ray, left): (Ray, f64)| {
                let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
                let crosses = (x - z * dx / dz).hypot(y - z * dy / dz) <= reach;
                (dz > 0.0 && dx.hypot(dy) <= steepest * dz && crosses).then_some(left)
            };
            found.ok().and_then(arrives).map_or(0.0, |left| cos4(slopes) * left)
        });
        let error = light[1].hypot(sky[1]);
        assert!((light[0] - sky[0]).abs() < 4.0 * error, "{near} {far}: {light:?} {sky:?}");
        assert!(error < 0.05 * sky[0], "{near} {far}: {light:?} {sky:?}");
    }
}

#[test]
fn the_edges_of_a_spray_are_round() {
    // A window with a stop behind it transmits a disk of light from a lamp on the axis; the disk's watts are
    // proportional to its area.
    let radius = 4.0;
    let text = format!("inf 2 1.5 - 20\ninf 1 - - 20\nstop 0 - - {}\n", 2.0 * radius);
    let window = Lens::at_d_line(&realistic::read("window", text.as_bytes()).expect("a lens"));
    let ghosts = Ghosts::new(&window, &Surfaces::new(&window, Coating::Bare), window.rear().vertex - 10.0);
    let lamp = Lamp::Distant([0.0, 0.0, 1.0]);
    let left = 0.96 * 0.96;
    for side in [16, 33] {
        let spray = ghosts.spray(ghosts.direct(), lamp, side);
        let area = 1e-6 * std::f64::consts::PI * radius * radius;
        near(spray.watts() / (left * area), 1.0, 8e-3);
        // For each row of the grid, the light has the length of the disk's chord to within a third of a cell: whole
        // cells with a jagged edge would be off by up to one cell. Light that passes the stop lands at the same height.
        let rows: Vec<(f64, f64)> = spray
            .cells
            .chunks(side)
            .filter_map(|row| {
                let whole = row.iter().flatten().max_by(|a, b| a.watts.total_cmp(&b.watts))?;
                Some((whole.point[1], row.iter().flatten().map(|landing| landing.watts).sum()))
            })
            .collect();
        let size = (rows[side / 2].0 - rows[side / 2 - 1].0).abs();
        let mut looked = 0;
        for (y, watts) in rows.iter().filter(|(y, _)| y.abs() < 0.8 * radius) {
            let chord = 2.0 * (radius * radius - y * y).sqrt();
            let off = watts / (left * 1e-6 * size * size) - chord / size;
            assert!(off.abs() < 0.35, "{side}, at {y} mm: {off} cells");
            looked += 1;
        }
        assert!(looked > side / 2, "{looked}");
    }
}

#[test]
fn the_kernel_takes_rays_along_ghosts_as_the_walk_does() {
    let (mut passed, mut differ, mut most, mut aspheric) = (0, 0, 0.0_f64, 0);
    for name in catalogue::round() {
        let lens = lens(name);
        let all = Surfaces::new(&lens, Coating::Bare).reflecting();
        let size = lens.front().semi_diameter;
        let from_scene = rays(&lens, 60, 3);
        for (at, near) in all.iter().enumerate() {
            for far in &all[at + 1..] {
                let last = lens.surfaces.len() - 1;
                let path = |direction, turns| Path::reflected(&lens, direction, Refraction::Fused, turns);
                let forth = path(Direction::SceneToFilm, [*near, *far]);
                let back = path(Direction::FilmToScene, [last - far, last - near]);
                // The rays that pass are traced again from behind.
                let from_film: Vec<Ray> = from_scene
                    .iter()
                    .filter_map(|ray| forth.trace(*ray).ok())
                    .map(|after| Ray {
                        origin: std::array::from_fn(|k| after.origin[k] + 5.0 * after.direction[k]),
                        direction: after.direction.map(|x| -x),
                    })
                    .collect();
                for (path, rays) in [(forth, &from_scene), (back, &from_film)] {
                    let kernel = Kernel::<f64>::along(&path);
                    let mut buffer = RayBuffer::new(rays.len());
                    for (i, ray) in rays.iter().enumerate() {
                        buffer.put(i, ray.origin, ray.direction);
                    }
                    kernel.trace_in_place(&mut buffer.rays());
                    let traced = buffer.rays();
                    for (i, ray) in rays.iter().enumerate() {
                        let (expected, found) = (path.trace(*ray).ok(), traced.weight[i] > 0.0);
                        differ += usize::from(expected.is_some() != found);
                        let Some(expected) = expected.filter(|_| found) else { continue };
                        passed += 1;
                        aspheric += usize::from(lens.surfaces[*near].figure.is_some());
                        for k in 0..3 {
                            let moved = (traced.origin[k][i] - expected.origin[k]).abs() / size;
                            let turned = (traced.direction[k][i] - expected.direction[k]).abs();
                            most = most.max(moved).max(turned);
                        }
                    }
                }
            }
        }
    }
    // The paths include reflections at aspheres.
    assert!(passed > 20_000 && aspheric > 1000, "{passed} {aspheric}");
    assert!(differ == 0 && most < 1e-10, "{differ} of {passed}, {most}");
}
