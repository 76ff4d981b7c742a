//! Exact rays between media: closed forms, and kernels against the walk.

use super::near;
use crate::support::{Random, by_kernel, lens_of};
use realistic_optics::{
    lens::{Lens, film_ray, first_order::FirstOrder},
    trace::{Direction, Path, Ray},
};
use realistic_trace::kernel::{Kernel, KernelScalar, PlaneRays, RayBuffer};

#[test]
fn a_ball_in_water_refracts_by_the_ratio_of_indices() {
    let (radius, glass, water) = (10.0, 1.5168, 1.33306);
    let lens = lens_of(&format!("medium {water}\n{radius} 20 {glass} 19.9\n-{radius} 0 {water} 19.9\n"));
    let ratio = glass / water;
    let ball = FirstOrder::of(&lens).expect("not afocal");
    // The focal length from the centre follows from the ratio of indices; 1/φ is shorter by the index of the water.
    let focal_length = ratio * radius / (2.0 * (ratio - 1.0));
    near(ball.front_focal_length(), focal_length, 1e-9);
    near(ball.rear_focal_length(), focal_length, 1e-9);
    near(ball.focal_length, focal_length / water, 1e-9);
    ball.nodal_points().into_iter().for_each(|z| near(z, -radius, 1e-9));
    // A parallel ray at height h crosses the axis at h/sin 2(i - r) behind the centre.
    for height in [0.1, 3.0, 7.0, 9.5] {
        let from = Ray { origin: [0.0, height, 15.0], direction: [0.0, 0.0, -1.0] };
        let turn = 2.0 * ((height / radius).asin() - (height / (ratio * radius)).asin());
        let crossing = -radius - height / turn.sin();
        let exact = Path::<f64>::scene_to_film(&lens).trace(from).expect("inside the ball");
        let [kernel] = by_kernel::<f64>(&lens, Direction::SceneToFilm, &[from])[..] else {
            panic!("one ray")
        };
        for out in [exact, kernel.expect("inside the ball")] {
            let slope = out.direction[1] / out.direction[2];
            near(slope, turn.tan(), 1e-12);
            near(out.origin[2] - out.origin[1] / slope, crossing, 1e-10 * crossing.abs());
        }
    }
}

#[test]
fn rays_beyond_the_critical_angle_are_reflected() {
    let lens = lens_of("0 1 1.336 100\n");
    let critical = (1.0 / 1.336_f64).asin();
    for (angle, passes) in [(0.999 * critical, true), (1.001 * critical, false)] {
        let ray = film_ray([0.0; 2], lens.rear().vertex - 1.0, [0.0, angle.tan()]);
        let walked = Path::<f64>::film_to_scene(&lens).trace(ray).ok();
        let [traced] = by_kernel::<f64>(&lens, Direction::FilmToScene, &[ray])[..] else { panic!("one ray") };
        for found in [walked, traced] {
            assert_eq!(found.is_some(), passes);
            if let Some(found) = found {
                near(found.direction[1], 1.336 * angle.sin(), 1e-12);
            }
        }
    }
}

/// Returns the text of a random lens between media: up to seven surfaces, some aspheric, and a stop in any medium.
fn random_lens(random: &mut Random) -> String {
    let medium = |random: &mut Random| match random.next() {
        kind if kind < 0.25 => "- -".to_owned(),
        kind if kind < 0.5 => format!("{} -", 1.0 + 0.8 * random.next()),
        _ => format!("{} {}", 1.0 + 0.8 * random.next(), 30.0 + 40.0 * random.next()),
    };
    let mut behind = medium(random);
    let mut text = if behind == "- -" { String::new() } else { format!("medium {behind}\n") };
    let count = 2 + (6.0 * random.next()) as usize;
    let stop = (random.next() * count as f64) as usize;
    for row in 0..count {
        if row == stop {
            let [thickness, diameter] = [0.5 + random.next(), 6.0 + 4.0 * random.next()];
            text += &format!("stop {thickness} {behind} {diameter}\n");
        }
        behind = if row % 2 == 0 { format!("{} 50", 1.4 + 0.4 * random.next()) } else { medium(random) };
        let sign = if random.next() < 0.5 { -1.0 } else { 1.0 };
        let radius = match random.next() {
            kind if kind < 0.15 => "inf".to_owned(),
            _ => (sign * (12.0 + 60.0 * random.next())).to_string(),
        };
        let [thickness, diameter] = [3.0 + 4.0 * random.next(), 12.0 + 4.0 * random.next()];
        text += &format!("{radius} {thickness} {behind} {diameter}\n");
    }
    for row in (1..=count + 1).filter(|row| *row != stop + 1) {
        if random.next() < 0.2 {
            text += &format!("asphere {row} conic={} A4={:e}\n", random.signed(), 1e-5 * random.signed());
        }
    }
    text
}

/// Returns rays toward the rear or the front surface, from a plane before it.
fn random_rays(random: &mut Random, lens: &Lens, direction: Direction, count: usize) -> Vec<Ray> {
    let (from, to) = match direction {
        Direction::FilmToScene => (lens.rear().vertex - 25.0, lens.rear().vertex),
        Direction::SceneToFilm => (30.0, 0.0),
    };
    let mut ray = |_| {
        let [x, y] = [5.0 * random.signed(), 5.0 * random.signed()];
        let [u, v] = [6.0 * random.signed(), 6.0 * random.signed()];
        Ray { origin: [x, y, from], direction: [u - x, v - y, to - from] }
    };
    (0..count).map(&mut ray).collect()
}

/// Compares kernels with exact walks over random lenses. Returns the largest error, the number of rays that pass, and
/// the number of rays that only one of both blocks.
fn against_the_walk<S: KernelScalar>(lenses: usize) -> (f64, usize, usize) {
    let (mut random, mut worst, mut passed, mut differ) = (Random::new(60), 0.0_f64, 0, 0);
    for _ in 0..lenses {
        let lens = lens_of(&random_lens(&mut random));
        for direction in [Direction::FilmToScene, Direction::SceneToFilm] {
            let rays = random_rays(&mut random, &lens, direction, 64);
            let path =
                Path::<f64>::new(&lens, direction, realistic_optics::lens::refraction::Refraction::Fused);
            for (ray, found) in rays.iter().zip(by_kernel::<S>(&lens, direction, &rays)) {
                match (path.trace(*ray), found) {
                    (Ok(exact), Some(found)) => {
                        let off = |a: [f64; 3], b: [f64; 3]| {
                            (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
                        };
                        let moved = off(exact.origin, found.origin) / 100.0;
                        worst = worst.max(off(exact.direction, found.direction)).max(moved);
                        passed += 1;
                    }
                    (Err(_), None) => {}
                    _ => differ += 1,
                }
            }
            single_rays_are_those_of_a_batch::<S>(&lens, direction, &rays);
        }
    }
    (worst, passed, differ)
}

fn single_rays_are_those_of_a_batch<S: KernelScalar>(lens: &Lens, direction: Direction, rays: &[Ray]) {
    let kernel = Kernel::<S>::new(lens, direction);
    let plane = rays[0].origin[2];
    let column = |of: &dyn Fn(&Ray) -> f64| rays.iter().map(|ray| S::from_f64(of(ray))).collect::<Vec<S>>();
    let [x, y] = [0, 1].map(|axis| column(&|ray| ray.origin[axis]));
    let [slope_x, slope_y] = [0, 1].map(|axis| column(&|ray| ray.direction[axis] / ray.direction[2]));
    let mut batch = RayBuffer::<S>::new(rays.len());
    let from = PlaneRays { plane, x: &x, y: &y, slope_x: &slope_x, slope_y: &slope_y };
    kernel.trace_batch(&from, &mut batch.rays());
    for i in 0..rays.len() {
        let one = kernel.trace_one(plane, [x[i], y[i]], [slope_x[i], slope_y[i]]);
        assert_eq!(one.map(|ray| ray.ray()), batch.get(i).map(|ray| ray.ray()));
    }
}

#[test]
fn kernels_trace_lenses_in_media_as_the_walk_does() {
    let (worst, passed, differ) = against_the_walk::<f64>(300);
    eprintln!("f64: {worst:.1e}, {passed} rays, {differ} differ");
    assert!(worst < 1e-10 && passed > 5000 && differ <= 2, "{worst:e} {passed} {differ}");
    let (worst, passed, differ) = against_the_walk::<f32>(300);
    eprintln!("f32: {worst:.1e}, {passed} rays, {differ} differ");
    assert!(worst < 0.02 && passed > 5000 && differ < passed / 500, "{worst:e} {passed} {differ}");
}
