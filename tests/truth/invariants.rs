//! Properties of every ray through any lens: reversibility, invariants, symmetries, and surfaces whose imaging is known
//! in closed form.

use super::support;

use std::f64::consts::TAU;

use ::realistic_camera::Outcome;
use proptest::prelude::*;
use realistic_optics::{
    lens::{
        Lens, Surface,
        first_order::{Abcd, FirstOrder},
        pupil::ExitPupil,
        refraction::Refraction,
    },
    prescription::{Meridian, catalogue},
    trace::{Direction, Path, Ray},
};
use support::{Random, build, host_with, lens, lens_of, sample};

/// Returns film rays of a lens, from a film slightly behind the focal plane. They lead to points of the rear element,
/// or of the exit pupil if the rear element is wider than its distance from the film.
fn film_rays(lens: &Lens, seed: u64, count: usize) -> impl Iterator<Item = Ray> {
    let rear = lens.rear();
    let focal = FirstOrder::of(lens).expect("focal");
    let film = rear.vertex - 1.01 * focal.back_focal_distance();
    let (vertex, radius) = if rear.semi_diameter < rear.vertex - film {
        (rear.vertex, rear.semi_diameter)
    } else {
        let pupil = ExitPupil::paraxial(lens, film);
        (pupil.position().expect("finite"), pupil.diameter() / 2.0)
    };
    let half = 0.4 * focal.focal_length.min(45.0);
    let mut random = Random::new(seed);
    (0..count).map(move |_| {
        let point = [half * random.signed(), half * random.signed(), film];
        let aim = [radius * random.signed(), radius * random.signed(), vertex];
        Ray { origin: point, direction: std::array::from_fn(|i| aim[i] - point[i]) }
    })
}

/// Returns the rays of [`film_rays`] that pass, with the rays behind the lens.
fn passing(lens: &Lens, seed: u64, count: usize) -> Vec<(Ray, Ray)> {
    let path = Path::<f64>::film_to_scene(lens);
    let rays: Vec<_> =
        film_rays(lens, seed, count).filter_map(|ray| Some((ray, path.trace(ray).ok()?))).collect();
    assert!(rays.len() > count / 40, "{}: only {} of {count} rays pass", lens.name, rays.len());
    rays
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    v.map(|x| x / length(v))
}

fn at_plane(ray: Ray, z: f64) -> [f64; 3] {
    let t = (z - ray.origin[2]) / ray.direction[2];
    std::array::from_fn(|i| ray.origin[i] + t * ray.direction[i])
}

/// Returns the lens with slightly wider apertures, so that a ray through the very edge passes on its way back.
fn widened(lens: &Lens) -> Lens {
    let mut wide = lens.clone();
    wide.surfaces.iter_mut().for_each(|surface| surface.semi_diameter *= 1.0 + 1e-10);
    wide
}

#[test]
fn a_passing_ray_keeps_its_skewness_and_finds_its_way_back() {
    for name in catalogue::round() {
        let lens = lens(name);
        let back = Path::<f64>::scene_to_film(&widened(&lens));
        for (film, scene) in passing(&lens, 1, 4000) {
            let skew = |ray: Ray, d: [f64; 3]| ray.origin[0] * d[1] - ray.origin[1] * d[0];
            let (before, after) = (skew(film, unit(film.direction)), skew(scene, scene.direction));
            let size = length(film.origin).max(length(scene.origin));
            assert!((before - after).abs() < 1e-15 * 20.0 * size, "{name}: {film:?}: {before} then {after}");
            let turned = Ray { origin: scene.origin, direction: scene.direction.map(|d| -d) };
            let got = back.trace(turned).unwrap_or_else(|why| panic!("{name}: {film:?}: {why}"));
            let error = length(minus(at_plane(got, film.origin[2]), film.origin));
            let turn = length(minus(got.direction, unit(film.direction).map(|d| -d)));
            assert!(error < 1e-11 && turn < 1e-13, "{name}: {film:?} is off by {error:e} mm, {turn:e} rad");
        }
    }
}

#[test]
fn a_ray_that_starts_on_the_first_surface_meets_it() {
    // This ray leaves the lens 1e-13 mm beyond the steep first surface.
    let lens = lens_of("-9.8 14.4 1 17.9\n184 3 1 18.4\n189.4 1.26 2.05 18.9\n-144.4 0 1 14.4\n");
    let wide = widened(&lens);
    let (out, back) = (Path::<f64>::film_to_scene(&lens), Path::<f64>::scene_to_film(&wide));
    let mut random = Random::new(13);
    let mut count = 0;
    while count < 20_000 {
        let point = [10.0 * random.signed(), 10.0 * random.signed(), -50.0];
        let direction = [0.3 * random.signed(), 0.3 * random.signed(), 1.0];
        let Ok(scene) = out.trace(Ray { origin: point, direction }) else { continue };
        let turned = Ray { origin: scene.origin, direction: scene.direction.map(|d| -d) };
        let got = back.walk(turned);
        assert_eq!(got.blocked, None, "{turned:?} meets {} surfaces", got.surfaces_met);
        count += 1;
    }
}

#[test]
fn the_lagrange_invariant_of_paraxial_rays_is_conserved() {
    for name in catalogue::round() {
        let lens = lens(name);
        let matrix = Abcd::of_lens(&lens, Meridian::Y);
        assert!((matrix.a * matrix.d - matrix.b * matrix.c - 1.0).abs() < 1e-13, "{name}: {matrix:?}");
        // For exact rays very near the axis, u₁ y₂ - u₂ y₁ is the same in any two planes in air.
        let path = Path::<f64>::film_to_scene(&lens);
        let film = lens.rear().vertex - 10.0;
        let [(y1, u1), (y2, u2)] = [(2e-5, 4e-6), (-1e-5, 6e-6)];
        let [(z1, v1), (z2, v2)] = [(y1, u1), (y2, u2)].map(|(y, u)| {
            let ray = Ray { origin: [0.0, y, film], direction: [0.0, u, 1.0] };
            let got = path.trace(ray).expect("near the axis");
            (at_plane(got, 0.0)[1], got.direction[1] / got.direction[2])
        });
        let (before, after) = (u1 * y2 - u2 * y1, v1 * z2 - v2 * z1);
        assert!((after / before - 1.0).abs() < 1e-7, "{name}: {before:e} then {after:e}");
    }
}

/// Maps (x, y, dx, dy) on the film to (x, y, dx, dy) in the plane z = 20 mm. Both planes are in air, so the map is
/// symplectic in these coordinates.
fn phase_space(path: &Path, film: f64, q: [f64; 4]) -> Option<[f64; 4]> {
    let dz = (1.0 - q[2] * q[2] - q[3] * q[3]).sqrt();
    let ray = Ray { origin: [q[0], q[1], film], direction: [q[2], q[3], dz] };
    let got = path.trace(ray).ok()?;
    let [x, y, _] = at_plane(got, 20.0);
    Some([x, y, got.direction[0], got.direction[1]])
}

fn determinant(mut m: [[f64; 4]; 4]) -> f64 {
    let mut product = 1.0;
    for column in 0..4 {
        let pivot = (column..4)
            .max_by(|&a, &b| m[a][column].abs().total_cmp(&m[b][column].abs()))
            .expect("a row is left");
        if pivot != column {
            m.swap(pivot, column);
            product = -product;
        }
        product *= m[column][column];
        for row in column + 1..4 {
            let factor = m[row][column] / m[column][column];
            let above = m[column];
            (0..4).for_each(|i| m[row][i] -= factor * above[i]);
        }
    }
    product
}

#[test]
fn etendue_is_conserved_for_rays_on_and_off_the_axis() {
    for name in catalogue::round() {
        let lens = lens(name);
        let path = Path::<f64>::film_to_scene(&lens);
        let mut checked = 0;
        for (film, scene) in passing(&lens, 3, 2000) {
            // Beyond 75 degrees, the plane in front is too far away for accurate differences.
            if scene.direction[2] < 0.25 {
                continue;
            }
            let d = unit(film.direction);
            let q = [film.origin[0], film.origin[1], d[0], d[1]];
            // The columns are differences of fourth order, in units of 1e-3 mm and 1e-5 rad.
            let column = |axis: usize| {
                let step = if axis < 2 { 1e-3 } else { 1e-5 };
                let at = |k: f64| {
                    let mut moved = q;
                    moved[axis] += k * step;
                    phase_space(&path, film.origin[2], moved)
                };
                let [a, b, c, e] = [at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?];
                Some(std::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - e[i]) / (12.0 * step)))
            };
            let Some(columns) = (0..4).map(column).collect::<Option<Vec<[f64; 4]>>>() else {
                continue;
            };
            let det = determinant([columns[0], columns[1], columns[2], columns[3]]);
            assert!((det - 1.0).abs() < 1e-6, "{name}: {film:?}: {det}");
            checked += 1;
        }
        assert!(checked > 80, "{name}: {checked}");
    }
}

fn scaled(ray: Ray, factor: f64) -> Ray {
    Ray { origin: ray.origin.map(|x| x * factor), direction: ray.direction }
}

#[test]
fn scaling_by_a_power_of_two_scales_the_rays_bit_for_bit() {
    for (name, factor) in
        catalogue::round().flat_map(|name| [(name, 20.0_f64.exp2()), (name, (-20.0_f64).exp2())])
    {
        let prescription = catalogue::find(name).expect("listed");
        let lenses = [Lens::at_d_line(&prescription), Lens::at_d_line(&prescription.scaled(factor))];
        let film: Vec<Ray> = film_rays(&lenses[0], 5, 500).collect();
        let back = |ray: Ray| Ray { origin: ray.origin, direction: ray.direction.map(|d| -d) };
        let scene: Vec<Ray> = passing(&lenses[0], 4, 500).into_iter().map(|(_, scene)| back(scene)).collect();
        for (_, refraction) in Refraction::NAMES {
            for (direction, rays) in [(Direction::FilmToScene, &film), (Direction::SceneToFilm, &scene)] {
                let double = [0, 1].map(|i| Path::<f64>::new(&lenses[i], direction, refraction));
                let single = [0, 1].map(|i| Path::<f32>::new(&lenses[i], direction, refraction));
                for &ray in rays {
                    let large = scaled(ray, factor);
                    for (a, b) in [
                        (double[0].walk(ray), double[1].walk(large)),
                        (single[0].walk(ray), single[1].walk(large)),
                    ] {
                        let context = format!("{name} x {factor}, {refraction:?}, {direction:?}: {ray:?}");
                        assert_eq!((a.surfaces_met, a.blocked), (b.surfaces_met, b.blocked), "{context}");
                        assert_eq!(scaled(a.ray, factor), b.ray, "{context}");
                    }
                }
            }
        }
    }
}

#[test]
fn scaling_by_any_factor_scales_the_rays() {
    for name in catalogue::round() {
        let prescription = catalogue::find(name).expect("listed");
        let lens = Lens::at_d_line(&prescription);
        for factor in [0.7, 3.3, 1e-6, 1e7] {
            let path = Path::<f64>::film_to_scene(&widened(&Lens::at_d_line(&prescription.scaled(factor))));
            for (film, scene) in passing(&lens, 7, 1000) {
                let got = path.trace(scaled(film, factor)).unwrap_or_else(|why| panic!("{name}: {why}"));
                let turn = length(minus(got.direction, scene.direction));
                let shift = length(minus(got.origin, scaled(scene, factor).origin)) / factor;
                assert!(turn < 1e-14, "{name} {factor}: {film:?} turns {turn:e} rad");
                assert!(shift < 1e-12, "{name} {factor}: {film:?} shifts {shift:e} mm");
            }
        }
    }
}

#[test]
fn turning_film_point_and_pupil_point_turns_the_ray() {
    for name in catalogue::round() {
        let lens = lens(name);
        let path = Path::<f64>::film_to_scene(&widened(&lens));
        let mut random = Random::new(8);
        for (film, scene) in passing(&lens, 9, 2000) {
            let (sin, cos) = (TAU * random.next()).sin_cos();
            let turn = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
            let turned = Ray { origin: turn(film.origin), direction: turn(film.direction) };
            let got = path.trace(turned).unwrap_or_else(|why| panic!("{name}: {why}"));
            let mirrored = |[x, y, z]: [f64; 3]| [-x, y, z];
            assert!(length(minus(got.direction, turn(scene.direction))) < 1e-14, "{name} {film:?}");
            assert!(length(minus(got.origin, turn(scene.origin))) < 1e-12, "{name} {film:?}");
            let mirror = Ray { origin: mirrored(film.origin), direction: mirrored(film.direction) };
            let got = path.trace(mirror).unwrap_or_else(|why| panic!("{name}: {why}"));
            assert_eq!((got.origin, got.direction), (mirrored(scene.origin), mirrored(scene.direction)));
        }
    }
}

#[test]
fn the_length_of_a_direction_changes_nothing() {
    let lens = lens("dgauss.50mm");
    let path = Path::<f64>::film_to_scene(&lens);
    for (film, scene) in passing(&lens, 10, 300) {
        for exponent in [-1060.0_f64, -900.0, -1.0, 40.0, 1016.0] {
            let longer = Ray { direction: film.direction.map(|d| d * exponent.exp2()), ..film };
            let got = path.trace(longer).unwrap_or_else(|why| panic!("2^{exponent}: {longer:?}: {why}"));
            // Components of such a small direction have few digits.
            let allowed = if exponent < -1020.0 { 1e-3 } else { 0.0 };
            let turn = length(minus(got.direction, scene.direction));
            assert!(turn <= allowed, "2^{exponent}: {turn:e}");
        }
    }
}

#[test]
fn a_sphere_images_its_aplanatic_points_stigmatically() {
    // Light that converges to R n behind the centre is refracted toward R/n behind it (Born and Wolf, §4.2.3). The
    // second surface is concentric with that image and refracts nothing.
    let (radius, n, thickness) = (20.0, 1.5, 5.0);
    let lens = lens_of(&format!("20 5 1.5 38\n{} 0 1 30\n", radius + radius / n - thickness));
    let path = Path::<f64>::scene_to_film(&lens);
    for slope in (0..35).map(|i| f64::from(i) * 0.01) {
        for azimuth in [0.0_f64, 1.0, 4.0] {
            let (aim, image) = (-(radius + radius * n), -(radius + radius / n));
            let direction = [slope * azimuth.cos(), slope * azimuth.sin(), -1.0];
            let origin = std::array::from_fn(|i| [0.0, 0.0, aim][i] - 60.0 * direction[i]);
            let got = path.trace(Ray { origin, direction }).unwrap_or_else(|why| panic!("{slope}: {why}"));
            let [x, y, _] = at_plane(got, image);
            assert!(x.hypot(y) < 1e-13, "slope {slope}: {:e}", x.hypot(y));
            // The sine condition: the ratio of the sines is n.
            let sine = |d: [f64; 3]| unit(d)[0].hypot(unit(d)[1]);
            assert!((sine(got.direction) - n * sine(direction)).abs() < 1e-14);
        }
    }
}

#[test]
fn concentric_shells_do_not_bend_rays_through_their_centre() {
    // The lens has six spheres about z = -40.
    let lens = lens_of("40 6 1.6 60\n34 4 1.8 50\n30 7 1 44\n23 5 1.5 30\n18 8 1.9 26\n10 0 1 16\n");
    let path = Path::<f64>::film_to_scene(&lens);
    for slope in (-9..10).map(|i| f64::from(i) * 0.08) {
        let direction = [slope, 0.3 * slope, 1.0];
        // The film-side ray starts at the centre, which lies behind the last vertex.
        let got = path.trace(Ray { origin: [0.0, 0.0, -40.0], direction }).expect("through");
        assert!(length(minus(got.direction, unit(direction))) < 1e-15, "{slope}");
        let on_sphere = length(minus(got.origin, [0.0, 0.0, -40.0]));
        assert!((on_sphere - 40.0).abs() < 1e-13, "{slope}: {on_sphere}");
    }
}

#[test]
fn a_plate_shifts_a_ray_and_keeps_its_direction() {
    let (d, n) = (7.0_f64, 1.62_f64);
    let path = Path::<f64>::film_to_scene(&lens_of("0 7 1.62 90\n0 0 1 90\n"));
    for sine in (0..10).map(|i| f64::from(i) / 10.0) {
        let cos = (1.0 - sine * sine).sqrt();
        let direction = [0.6 * sine, 0.8 * sine, cos];
        let got = path.trace(Ray { origin: [0.0, 0.0, -10.0], direction }).expect("through");
        assert!(length(minus(got.direction, direction)) < 1e-15);
        // Born and Wolf, §4.8: d sin θ (1 - cos θ/(n cos θ')), perpendicular to the ray.
        let cos_inside = (1.0 - (sine / n).powi(2)).sqrt();
        let expected = d * sine * (1.0 - cos / (n * cos_inside));
        let straight = at_plane(Ray { origin: [0.0, 0.0, -10.0], direction }, 0.0);
        let aside = minus(straight, at_plane(got, 0.0));
        assert!((aside[0].hypot(aside[1]) * cos - expected).abs() < 1e-14, "{sine}");
    }
}

#[test]
fn close_rays_meet_where_coddington_says() {
    // n' cos²I'/t' = n cos²I/t + (n' cos I' - n cos I)/R and n'/s' = n/s + the same (Kingslake and Johnson, *Lens
    // Design Fundamentals*, 2nd ed., §11.1).
    let n = 1.65;
    for radius in [30.0, -45.0] {
        let surface = Surface {
            vertex: 0.0,
            radius,
            curvature: 1.0 / radius,
            figure: None,
            unsymmetric: None,
            thickness: 0.0,
            n_scene: 1.0,
            n_film: n,
            absorption: 0.0,
            semi_diameter: 25.0,
            is_stop: false,
            is_mirror: false,
            is_reversed: false,
            coordinate_break: None,
            apertures: std::sync::Arc::default(),
            is_contact: false,
        };
        let mut sphere = lens_of("30 4 1.6 10\n-30 0 1 10\n");
        sphere.surfaces = vec![surface.clone()];
        let path = Path::<f64>::scene_to_film(&sphere);
        for (height, angle) in [(0.0_f64, 0.5_f64), (9.0, 0.0), (8.0, 0.4), (-12.0, 0.3)] {
            // The object point lies 80 mm from the surface, up the chief ray; the tangential plane is the y-z plane.
            let chief = [0.0, angle.sin(), -angle.cos()];
            let hit = [0.0, height, surface.sagitta(height)];
            let object = std::array::from_fn(|i| hit[i] - 80.0 * chief[i]);
            let trace = |turn: [f64; 3]| {
                let direction = unit(std::array::from_fn(|i| chief[i] + turn[i]));
                path.trace(Ray { origin: object, direction }).expect("through")
            };
            let middle = trace([0.0; 3]);
            // Returns the distance along the refracted chief ray to the point that a neighbouring ray approaches most
            // closely.
            let focus = |turn: [f64; 3]| {
                let meeting = |sign: f64| {
                    let close = trace(turn.map(|x| sign * x));
                    let apart = minus(close.origin, middle.origin);
                    let bend = minus(close.direction, middle.direction);
                    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                    let across = |v: [f64; 3]| {
                        let along = dot(v, middle.direction);
                        minus(v, middle.direction.map(|d| along * d))
                    };
                    let (apart, bend) = (across(apart), across(bend));
                    -dot(apart, bend) / dot(bend, bend)
                };
                // Averaging both sides cancels the coma.
                f64::midpoint(meeting(1.0), meeting(-1.0))
            };
            let h = 1e-5;
            let across_y = [0.0, h * angle.cos(), h * angle.sin()];
            let (tangential, sagittal) = (focus(across_y), focus([h, 0.0, 0.0]));
            let centre = [0.0, 0.0, -radius];
            // The normal points to the side of the refracted light.
            let normal = unit(minus(centre, hit)).map(|x| radius.signum() * x);
            let cos = chief.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>();
            let cos_after = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
            let power = (n * cos_after - cos) / radius;
            let t = n * cos_after.powi(2) / (power - cos.powi(2) / 80.0);
            let s = n / (power - 1.0 / 80.0);
            assert!(
                (tangential / t - 1.0).abs() < 1e-7,
                "R {radius}, {height}, {angle}: {tangential} is not {t}"
            );
            assert!(
                (sagittal / s - 1.0).abs() < 1e-7,
                "R {radius}, {height}, {angle}: {sagittal} is not {s}"
            );
        }
    }
}

/// Generates tables of one to eight rows that can be read as lenses, but may not image anything: any order of radii,
/// media, thicknesses and apertures, with or without a stop.
fn tables() -> impl Strategy<Value = String> {
    let radius = prop_oneof![2 => 4.0..300.0_f64, 2 => -300.0..-4.0_f64, 1 => Just(0.0)];
    let index = prop_oneof![1 => Just(1.0), 2 => 1.3..2.2_f64];
    let row = (radius, 0.0..15.0_f64, index, 0.05..1.0_f64, 0.5..25.0_f64);
    proptest::collection::vec(row, 1..=8).prop_map(|rows| {
        let (mut before, mut has_stop) = (1.0, false);
        let last = rows.len() - 1;
        let lines =
            rows.into_iter().enumerate().map(|(number, (mut radius, thickness, index, edge, plane))| {
                let after = if number == last { 1.0 } else { index };
                if radius == 0.0 && before == 1.0 && after == 1.0 {
                    radius = if has_stop { 40.0 } else { 0.0 };
                    has_stop = true;
                }
                before = after;
                let diameter = if radius == 0.0 { 2.0 * plane } else { 2.0 * edge * f64::abs(radius) };
                let thickness = if number == last { 0.0 } else { thickness };
                format!("{radius} {thickness} {after} {diameter}\n")
            });
        lines.collect()
    })
}

fn is_unit(d: [f64; 3]) -> bool {
    (length(d) - 1.0).abs() < 1e-15 * 4.0
}

proptest! {
    #![proptest_config(support::cases(1500))]

    #[test]
    fn whatever_the_lens_a_ray_ends_in_numbers_and_a_reason(
        table in tables(),
        starts in proptest::collection::vec(
            ((-30.0..30.0_f64, -30.0..30.0_f64, 0.01..80.0_f64), (-2.0..2.0_f64, -2.0..2.0_f64)), 20),
    ) {
        let lens = lens_of(&table);
        for ((x, y, behind), (sx, sy)) in starts {
            let from_film = Ray { origin: [x, y, lens.rear().vertex - behind], direction: [sx, sy, 1.0] };
            let from_scene = Ray { origin: [x, y, behind], direction: [sx, sy, -1.0] };
            for walk in [
                Path::<f64>::film_to_scene(&lens).walk(from_film),
                Path::<f64>::scene_to_film(&lens).walk(from_scene),
            ] {
                prop_assert!(walk.ray.origin.iter().all(|x| x.is_finite()), "{:?}", walk);
                prop_assert!(is_unit(walk.ray.direction), "{:?}", walk);
                prop_assert!(walk.blocked.is_some() || walk.surfaces_met == lens.surfaces.len());
            }
            let single = Path::<f32>::film_to_scene(&lens).walk(from_film);
            prop_assert!(single.ray.origin.iter().all(|x| x.is_finite()) && is_unit(single.ray.direction));
        }
    }

    #[test]
    fn any_passing_ray_keeps_its_skewness_and_returns(
        table in tables(),
        starts in proptest::collection::vec((-5.0..5.0_f64, -5.0..5.0_f64, -0.9..0.9_f64, -0.9..0.9_f64), 30),
    ) {
        let lens = lens_of(&table);
        let (out, back) = (Path::<f64>::film_to_scene(&lens), Path::<f64>::scene_to_film(&widened(&lens)));
        for (x, y, u, v) in starts {
            let rear = lens.rear();
            let film = rear.vertex + rear.sagitta(rear.semi_diameter).min(0.0) - 20.0;
            let aim = [u * rear.semi_diameter, v * rear.semi_diameter, rear.vertex];
            let ray = Ray { origin: [x, y, film], direction: minus(aim, [x, y, film]) };
            let Ok(scene) = out.trace(ray) else { continue };
            let skew = |p: [f64; 3], d: [f64; 3]| p[0] * d[1] - p[1] * d[0];
            let (before, after) = (skew(ray.origin, unit(ray.direction)), skew(scene.origin, scene.direction));
            prop_assert!((before - after).abs() < 1e-12, "{} then {}", before, after);
            // Near grazing incidence and total reflection a ray depends on its last bits, and its reverse may go
            // anywhere.
            let cosines_are_safe = Path::<f64>::film_to_scene(&narrowed(&lens)).trace(ray).is_ok();
            if !cosines_are_safe {
                continue;
            }
            // Rays start in front of the whole lens: a stop in the last row may lie behind the surface whose bulge
            // contains it.
            let start = std::array::from_fn(|i| scene.origin[i] + lens.surfaces[0].semi_diameter * scene.direction[i]);
            let turned = Ray { origin: start, direction: scene.direction.map(|d| -d) };
            let got = back.trace(turned);
            prop_assert!(got.is_ok(), "{:?} comes out as {:?} and then {:?}", ray, scene, got);
            let error = length(minus(at_plane(got.expect("checked"), film), ray.origin));
            prop_assert!(error < 1e-6, "{:?} is off by {:e}", ray, error);
        }
    }

    #[test]
    fn any_camera_answers_in_numbers_or_says_why_not(
        table in tables(),
        distance in prop_oneof![Just(None), (0.1..200.0_f64).prop_map(Some)],
        pupil in prop_oneof![Just("rear"), Just("disk")],
        weighting in prop_oneof![Just("radiometric"), Just("assignment"), Just("relative"), Just("none")],
        samples in proptest::collection::vec((-3.0..403.0_f32, -3.0..303.0_f32, 0.0..=1.0_f32, 0.0..=1.0_f32), 20),
    ) {
        let distance = distance.map(|d| d.to_string());
        let mut given = vec![("pupil", pupil), ("weighting", weighting)];
        given.extend(distance.as_deref().map(|distance| ("film_distance", distance)));
        match build(&host_with(&table), &given) {
            Err(refusal) => prop_assert!(refusal.len() > 20, "{}", refusal),
            Ok((camera, _)) => {
                prop_assert!(camera.facts().expect("a lens").film_distance.is_finite() && camera.facts().expect("a lens").film_distance > 0.0);
                prop_assert!(camera.facts().expect("a lens").focus_distance_mm.is_none_or(|d| d > 0.0), "{:?}", camera.facts().expect("a lens").focus_distance_mm);
                for (x, y, u, v) in samples {
                    let sample = sample([x, y], [u, v]);
                    let substitute = camera.substitute(&sample);
                    prop_assert!(substitute.origin.iter().chain(&substitute.direction).all(|x| x.is_finite()));
                    if let Outcome::Ray(ray, weight) = camera.generate(&sample, None) {
                        prop_assert!(weight > 0.0 && weight.is_finite(), "{}", weight);
                        prop_assert!(ray.origin.iter().all(|x| x.is_finite()));
                        prop_assert!((length(ray.direction.map(f64::from)) - 1.0).abs() < 2e-7);
                    }
                }
            }
        }
    }
}

/// Returns the lens with its apertures reduced to well within its spheres, so that no passing ray grazes them.
fn narrowed(lens: &Lens) -> Lens {
    let mut narrow = lens.clone();
    for surface in &mut narrow.surfaces {
        if surface.curvature != 0.0 {
            surface.semi_diameter = surface.semi_diameter.min(0.8 / surface.curvature.abs());
        }
    }
    narrow
}
