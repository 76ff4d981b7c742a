//! What a ray costs: one, three at once, and many, against the textbook walk and what the processor
//! can do at best, all in one run.
//!
//! `cargo bench --no-default-features --bench kernel` (under a minute; with `-- dgauss` one lens). Every figure is
//! the median over rounds in which all contestants take turns, so that a busy machine disturbs them alike; the
//! smallest stands beside it.

mod contest;
mod limits;
mod scenes;

use std::hint::black_box;

use contest::Contest;
use realistic::{
    lens::refraction::Refraction,
    trace::{
        Direction, Path, Ray,
        kernel::{Kernel, LensRays, PlaneRays, Precision, Simd},
    },
};
use scenes::{Film, Scene};

/// Rays of a batch: in and out of the first and second cache.
const BATCH: usize = 2048;

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let rounds = if arguments.iter().any(|argument| argument == "--test") { 1 } else { 41 };
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    for scene in scenes::all().iter().filter(|scene| filter.is_none_or(|filter| scene.name.contains(filter)))
    {
        println!("\n## {}: {} surfaces", scene.name, scene.lens.surfaces.len());
        one_at_a_time(scene, rounds);
        many(scene, rounds);
    }
    println!("\n## What the processor can do at best");
    limits::print(rounds);
}

/// Latency: each ray's film point depends on the ray before.
fn one_at_a_time(scene: &Scene, rounds: usize) {
    let film = Film::<f64>::new(scene, 512);
    let rays = film.rays();
    let mut contest = Contest::new(film.len(), "ns a call");
    for (name, method) in [("textbook walk (Heckbert)", Refraction::Heckbert), ("walk", Refraction::Fused)] {
        let path = Path::<f64>::new(&scene.lens, Direction::FilmToScene, method);
        let rays = rays.clone();
        contest.enter(name, move || {
            let mut carry = 0.0;
            for ray in &rays {
                let mut ray = *ray;
                ray.origin[0] += carry;
                carry = path.trace(ray).map_or(0.0, |ray| ray.direction[2] * 1e-300);
            }
            black_box(carry);
        });
    }
    let latency = |simd| {
        let kernel = Kernel::<f64>::with_simd(&scene.lens, Direction::FilmToScene, simd)?;
        let film = film.clone();
        Some(move || {
            let mut carry = 0.0;
            for i in 0..film.len() {
                let (point, slopes) = film.at(i);
                let traced = kernel.trace_one(film.plane, [point[0] + carry, point[1]], slopes);
                carry = traced.map_or(0.0, |ray| ray.direction[2] * 1e-300);
            }
            black_box(carry);
        })
    };
    contest.enter_if("one ray, f64", latency(Simd::Avx2));
    contest.enter_if("one ray, f64, portable", latency(Simd::Portable));
    contest.enter("three rays, f64", triple::<f64>(scene, 1e-300));
    contest.enter("three rays, f32", triple::<f32>(scene, 1e-30));
    contest.run(rounds);
}

fn triple<S: Precision>(scene: &Scene, tiny: f64) -> impl FnMut() + use<S> {
    let kernel = Kernel::<S>::new(&scene.lens, Direction::FilmToScene);
    let film = Film::<S>::new(scene, 512);
    let pixel = S::from_f64(0.01);
    let tiny = S::from_f64(tiny);
    move || {
        let mut carry = S::ZERO;
        for i in 0..film.len() {
            let ([x, y], slopes) = film.at(i);
            let x = x + carry;
            let three =
                kernel.trace_triple(film.plane, [[x, y], [x + pixel, y], [x, y + pixel]], [slopes; 3]);
            carry = three[2].map_or(S::ZERO, |ray| ray.direction[2] * tiny);
        }
        black_box(carry);
    }
}

fn many(scene: &Scene, rounds: usize) {
    let mut contest = Contest::new(BATCH, "ns a ray");
    let path = Path::<f64>::new(&scene.lens, Direction::FilmToScene, Refraction::Heckbert);
    let rays: Vec<Ray> = Film::<f64>::new(scene, BATCH).rays();
    contest.enter("textbook walk (Heckbert)", move || {
        for ray in &rays {
            let _ = black_box(path.trace(*ray));
        }
    });
    for simd in Simd::ALL {
        contest.enter_if(&format!("f32 {}", simd.name()), batch::<f32>(scene, simd));
        contest.enter_if(&format!("f64 {}", simd.name()), batch::<f64>(scene, simd));
    }
    contest.run(rounds);
}

fn batch<S: Precision>(scene: &Scene, simd: Simd) -> Option<impl FnMut() + use<S>> {
    let kernel = Kernel::<S>::with_simd(&scene.lens, Direction::FilmToScene, simd)?;
    let film = Film::<S>::new(scene, BATCH);
    let mut out: [Vec<S>; 7] = std::array::from_fn(|_| vec![S::ZERO; BATCH]);
    Some(move || {
        let [x, y, z, dx, dy, dz, weight] = &mut out;
        let from = PlaneRays {
            plane: film.plane,
            x: &film.x,
            y: &film.y,
            slope_x: &film.slope_x,
            slope_y: &film.slope_y,
        };
        let mut to = LensRays { origin: [x, y, z], direction: [dx, dy, dz], weight };
        kernel.trace_batch(black_box(&from), &mut to);
        black_box(&to);
    })
}
