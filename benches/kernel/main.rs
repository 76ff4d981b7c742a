//! Benchmarks kernel rays, one at a time, three at once and many at once, against the walk with Heckbert's refraction
//! and the processor's peak throughput, all in one run.
//!
//! `cargo bench --bench kernel` (some minutes; `-- dgauss`: one lens; `-- catalogue`: one table of all lenses). Every
//! figure is a median over rounds in which all contestants take turns, so that other load affects them alike.

mod aspheres;
mod catalogue;
mod limits;
mod scenes;

use std::hint::black_box;

use limits::Register;
use realistic_lab::{
    subject::FilmRays,
    timing::{BenchArguments, Contest, Effort},
};
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::{Direction, Path},
};
use realistic_simd::Simd;
use realistic_trace::kernel::{Kernel, KernelScalar};
use scenes::Scene;

/// Rays per batch: the input and output fit in the first- and second-level caches.
const BATCH: usize = 2048;
/// Rays in a latency chain.
const CHAIN: usize = 512;

fn main() {
    let arguments = BenchArguments::from_command_line(41);
    println!("\n## What the processor can do at best\n");
    let limits = limits::measure(arguments.effort.rounds);
    limits::print(&limits);
    for scene in scenes::all().iter().filter(|scene| arguments.wants(scene.name)) {
        println!("\n## {}: {} surfaces", scene.name, scene.lens.surfaces.len());
        one_at_a_time(scene, arguments.effort);
        many(scene, &limits, arguments.effort);
    }
    aspheres::print(&arguments);
    if arguments.wants("catalogue") {
        catalogue::print(arguments.effort);
    }
}

/// Measures latency: each ray's film point depends on the previous ray.
fn one_at_a_time(scene: &Scene, effort: Effort) {
    let rays = scene.rays(CHAIN);
    let mut contest = Contest::default();
    for (name, method) in [("walk (Heckbert)", Refraction::Heckbert), ("walk", Refraction::Fused)] {
        let path = Path::<f64>::new(&scene.lens, Direction::FilmToScene, method);
        let rays = rays.clone();
        let chain = move || {
            let mut carry = 0.0;
            for ray in &rays {
                let mut ray = *ray;
                ray.origin[0] += carry;
                carry = path.trace(ray).map_or(0.0, |ray| ray.direction[2] * 1e-300);
            }
            black_box(carry);
        };
        contest.enter(name, Box::new(chain) as Box<dyn FnMut()>);
    }
    let single = |simd| -> Option<Box<dyn FnMut()>> {
        let kernel = Kernel::<f64>::with_simd(&scene.lens, Direction::FilmToScene, simd)?;
        let film = FilmRays::new(scene.film, &rays);
        Some(Box::new(move || {
            let mut carry = 0.0;
            for i in 0..film.count() {
                let (point, slopes) = film.at_film(i);
                let traced = kernel.trace_one(film.plane, [point[0] + carry, point[1]], slopes);
                carry = traced.map_or(0.0, |ray| ray.direction[2] * 1e-300);
            }
            black_box(carry);
        }))
    };
    contest.enter("one ray, f64", single(Simd::Avx2));
    contest.enter("one ray, f64, portable", single(Simd::Portable));
    contest.enter("three rays, f64", triple::<f64>(scene, 1e-300));
    contest.enter("three rays, f32", triple::<f32>(scene, 1e-30));
    contest.print("ns per call", CHAIN, effort);
}

fn triple<S: KernelScalar + 'static>(scene: &Scene, tiny: f64) -> Box<dyn FnMut()> {
    let kernel = Kernel::<S>::new(&scene.lens, Direction::FilmToScene);
    let film = FilmRays::<S>::new(scene.film, &scene.rays(CHAIN));
    let (pixel, tiny) = (S::from_f64(0.01), S::from_f64(tiny));
    Box::new(move || {
        let mut carry = S::ZERO;
        for i in 0..film.count() {
            let ([x, y], slopes) = film.at_film(i);
            let x = x + carry;
            let three =
                kernel.trace_triple(film.plane, [[x, y], [x + pixel, y], [x, y + pixel]], [slopes; 3]);
            carry = three[2].map_or(S::ZERO, |ray| ray.direction[2] * tiny);
        }
        black_box(carry);
    })
}

fn many(scene: &Scene, limits: &[Register], effort: Effort) {
    let mut contest = Contest::default();
    let path = Path::<f64>::new(&scene.lens, Direction::FilmToScene, Refraction::Heckbert);
    let rays = scene.rays(BATCH);
    let walk = move || {
        for ray in &rays {
            let _ = black_box(path.trace(*ray));
        }
    };
    contest.enter("walk (Heckbert)", Box::new(walk) as Box<dyn FnMut()>);
    let mut kernels = Vec::new();
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        contest
            .enter(format!("f32 {}", simd.name()), batch::<f32>(&scene.lens, scene.film_rays(BATCH), simd));
        contest
            .enter(format!("f64 {}", simd.name()), batch::<f64>(&scene.lens, scene.film_rays(BATCH), simd));
        kernels.extend(["f32", "f64"].map(|precision| Register::of(limits, precision, simd)));
    }
    let times = contest.print("ns per ray", BATCH, effort);
    println!("\n| registers | the processor's limit, ns per ray | share of it reached |\n|---|---|---|");
    for (register, time) in kernels.into_iter().zip(&times[1..]) {
        if let Some(register) = register
            && let Some(least) = register.least(&scene.lens)
        {
            println!("| {} | {least:.2} | {:.2} |", register.name, least / (time.median * 1e9));
        }
    }
}

/// Runs the kernel on a copy of a film's rays.
pub fn batch<S: KernelScalar + 'static>(
    lens: &Lens,
    mut film: FilmRays<S>,
    simd: Simd,
) -> Option<Box<dyn FnMut()>> {
    let kernel = Kernel::<S>::with_simd(lens, Direction::FilmToScene, simd)?;
    Some(Box::new(move || black_box(&mut film).trace(BATCH, |from, to| kernel.trace_batch(from, to))))
}
