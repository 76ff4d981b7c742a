//! Benchmarks the savings of a tolerance: rays by each model of a lens, one by one and in batches, whose times are the
//! source of the figures in `crates/camera/src/plan/cost.rs`; cameras of the catalogue's lenses at several stops, with
//! tolerances of 0.01, 0.1 and 1 pixel, against the exact trace in both precisions; and the build times of these
//! cameras.
//!
//! `cargo bench --bench plan` (`-- dgauss`: one lens; `-- --models` or `-- --cameras`: one part). The figures are
//! medians over interleaved rounds. `REALISTIC_SIMD=avx2` measures narrower registers.

use std::hint::black_box;

use realistic_camera::{Camera, Host, Parameters, Raster, Sample, plan::Entry, sampling::PupilDisk};
use realistic_lab::BLOCK;
use realistic_lab::columns::{RayColumns, SampleColumns};
use realistic_lab::{
    results::statistics::median,
    subject::{FilmRays, passing_rays, quasirandom::spread},
    timing::{BenchArguments, Contest, Effort, interleaved, repeated},
};
use realistic_optics::{
    imaging::focus::Focus,
    lens::Lens,
    prescription::catalogue,
    trace::{Direction, Path, Ray, Real},
};
use realistic_simd::Simd;
use realistic_trace::{
    kernel::{Kernel, KernelScalar, LensRays, PlaneRays, Traced},
    polynomial::{Polynomial, PolynomialLens},
};

/// The lenses of the assignment.
const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
/// Rays per batch of the models.
const BATCH: usize = 2048;
/// Blocks per round of the cameras.
const BLOCKS: usize = 8;
const RASTER: Raster = Raster { xres: 1920, yres: 1280 };
const TOLERANCES: [&str; 3] = ["0.01", "0.1", "1"];
const STOPS: [Option<&str>; 4] = [None, Some("4"), Some("8"), Some("16")];

fn main() {
    let arguments = BenchArguments::from_command_line(31);
    let named = |name: &str| std::env::args().any(|argument| argument == name);
    println!("instructions: {}", Simd::best().name());
    if !named("--cameras") {
        for name in LENSES.into_iter().filter(|name| arguments.wants(name)) {
            println!("\n## {name}: models\n");
            models(name, arguments.effort);
        }
    }
    if !named("--models") {
        println!("\n## cameras\n");
        cameras(&arguments);
    }
}

fn models(name: &str, effort: Effort) {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let distance = Focus::new(&lens).and_then(|focus| focus.film_distance(f64::INFINITY)).expect("focal");
    let film = lens.rear().vertex - distance;
    let reach = 10.0;
    let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
    let rays = passing_rays(&Path::<f64>::film_to_scene(&lens), film, reach, cover, BATCH, 0);
    let (mut many, mut one) = (Contest::default(), Contest::default());
    exact::<f64>("exact, f64", &lens, film, &rays, [&mut many, &mut one]);
    exact::<f32>("exact, f32", &lens, film, &rays, [&mut many, &mut one]);
    for (order, apertures) in MODELS {
        let surfaces: Vec<usize> = (1..=apertures).collect();
        let fit = Polynomial::with_apertures(&lens, film, &rays, order, &surfaces).expect("determined");
        let name = format!("order {order}, {apertures} apertures");
        polynomials::<f32>(&format!("{name}, f32"), &fit, film, &rays, [&mut many, &mut one]);
        if apertures == 1 {
            polynomials::<f64>(&format!("{name}, f64"), &fit, film, &rays, [&mut many, &mut one]);
        }
    }
    many.print("ns per ray, batches", BATCH, effort);
    println!();
    one.print("ns per ray, one by one", BATCH, effort);
}

/// Adds the exact trace in batches and one by one.
fn exact<S: KernelScalar + Real + 'static>(
    name: &str,
    lens: &Lens,
    film: f64,
    rays: &[Ray],
    [many, one]: [&mut Contest<'_>; 2],
) {
    let kernel = Kernel::<S>::new(lens, Direction::FilmToScene);
    let same = kernel.clone();
    many.enter(name, batch::<S>(film, rays, move |from, to| kernel.trace_batch(from, to)));
    one.enter(name, chain::<S>(film, rays, move |point, slopes| same.trace_one(film, point, slopes)));
}

/// Adds polynomials in batches and one by one.
fn polynomials<S: KernelScalar + Real + 'static>(
    name: &str,
    fit: &Polynomial,
    film: f64,
    rays: &[Ray],
    [many, one]: [&mut Contest<'_>; 2],
) {
    let lens = PolynomialLens::<S>::new(fit);
    let same = lens.clone();
    many.enter(name, batch::<S>(film, rays, move |from, to| lens.trace_batch(from, to)));
    one.enter(name, chain::<S>(film, rays, move |point, slopes| same.trace_one(point, slopes)));
}

/// Traces rays one by one, each waiting for the previous one.
fn chain<S: KernelScalar + Real + 'static>(
    film: f64,
    rays: &[Ray],
    trace: impl Fn([S; 2], [S; 2]) -> Option<Traced<S>> + 'static,
) -> Box<dyn FnMut()> {
    let rays: Vec<([S; 2], [S; 2])> = rays
        .iter()
        .map(|ray| {
            let slopes = [0, 1].map(|i| ray.direction[i] / ray.direction[2]);
            let point = [0, 1].map(|i| ray.origin[i] + slopes[i] * (film - ray.origin[2]));
            (point.map(S::from_f64), slopes.map(S::from_f64))
        })
        .collect();
    let small = S::from_f64(1e-30);
    Box::new(move || {
        let mut carry = S::ZERO;
        for &([x, y], slopes) in &rays {
            // The carry is too small to change the sum.
            carry = trace([x + carry, y], slopes).map_or(S::ZERO, |ray| ray.weight * small);
        }
        black_box(carry);
    })
}

/// Orders of polynomials, each with the number of apertures that are tested.
#[rustfmt::skip]
const MODELS: [(usize, usize); 15] = [
    (1, 0), (1, 2), (3, 0), (3, 1), (3, 2), (5, 0), (5, 1), (5, 2), (7, 0), (7, 1), (7, 2), (9, 0), (9, 1), (9, 2),
    (11, 0),
];

fn batch<S: KernelScalar + Real + 'static>(
    film: f64,
    rays: &[Ray],
    trace: impl Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>) + 'static,
) -> Box<dyn FnMut()> {
    let mut rays = FilmRays::new(film, rays);
    Box::new(move || black_box(&mut rays).trace(BATCH, &trace))
}

fn camera(given: &[(&str, &str)]) -> Camera {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).expect("a parameter");
    }
    Camera::build(&parameters, &Host::new(RASTER, None), &mut |_, _| ()).expect("a camera")
}

/// Returns samples nearly evenly spread over the middle of the image.
fn samples() -> impl Iterator<Item = Sample> {
    let across = |pixels: u32, share: f64| (f64::from(pixels) * (0.25 + 0.5 * share)) as f32;
    spread::<4>(0.5).map(move |[x, y, u, v]| Sample {
        image_x: across(RASTER.xres, x),
        image_y: across(RASTER.yres, y),
        lens_u: u as f32,
        lens_v: v as f32,
        time: 0.5,
    })
}

/// Prints, for a camera, each tolerance at each stop, compared with the exact trace in both precisions.
fn cameras(arguments: &BenchArguments) {
    let effort = Effort { rounds: arguments.effort.rounds.min(15), ..arguments.effort };
    println!(
        "| lens | tolerance | one by one, ns | f32 | f64 | | in batches, ns | f32 | f64 | | ms to build |\n\
         |---|---|---|---|---|---|---|---|---|---|---|"
    );
    // The largest times relative to single and to double precision, one by one and in batches.
    let mut worst = [[0.0_f64; 2]; 2];
    let mut longest = 0.0_f64;
    for name in catalogue::round().filter(|name| arguments.wants(name)) {
        for stop in STOPS {
            let lens = match stop {
                None => vec![("lens_file", name)],
                Some(number) => vec![("lens_file", name), ("fnumber", number)],
            };
            let exact =
                ["f64", "f32"].map(|precision| camera(&[&lens[..], &[("precision", precision)]].concat()));
            for tolerance in TOLERANCES {
                let given = [&lens[..], &[("tolerance", tolerance)]].concat();
                let (model, seconds) = repeated(effort.rounds.min(9), || camera(&given));
                let build = median(&seconds) * 1e3;
                longest = longest.max(build);
                let cameras = [&exact[0], &exact[1], &model];
                let nanoseconds = |tasks: [Box<dyn FnMut() + '_>; 3], rays: usize| {
                    interleaved(tasks, effort).into_iter().map(|time| time.per(rays).median * 1e9).collect()
                };
                let times: [Vec<f64>; 2] = [
                    nanoseconds(cameras.map(one_by_one), BLOCK),
                    nanoseconds(cameras.map(in_batches), BLOCK * BLOCKS),
                ];
                let mut cells = String::new();
                for ((times, entry), worst) in times.iter().zip(Entry::ALL).zip(&mut worst) {
                    let chosen = model.plan().choice().expect("a tolerance").chosen(entry).0.tracing;
                    let [double, single, model] = times[..] else { unreachable!("three cameras") };
                    cells += &format!(
                        " {chosen} {model:.1} | {single:.1} | {double:.1} | {:.2} |",
                        single / model
                    );
                    *worst = [worst[0].max(model / single), worst[1].max(model / double)];
                }
                let stop = stop.map_or("wide open".to_owned(), |number| format!("f/{number}"));
                println!("| {name}, {stop} | {tolerance} |{cells} {build:.2} |");
            }
        }
    }
    let [one, many] = worst.map(|[single, double]| format!("{single:.2} times f32, {double:.2} times f64"));
    println!("\nslowest one by one: {one}; in batches: {many}; longest to build: {longest:.2} ms");
}

fn in_batches(camera: &Camera) -> Box<dyn FnMut() + '_> {
    let samples: Vec<Sample> = samples().take(BLOCK * BLOCKS).collect();
    let mut blocks: Vec<SampleColumns> = vec![SampleColumns::new(BLOCK); BLOCKS];
    for (block, samples) in blocks.iter_mut().zip(samples.chunks(BLOCK)) {
        samples.iter().enumerate().for_each(|(i, sample)| block.set(i, sample));
    }
    let mut rays = RayColumns::new(BLOCK);
    Box::new(move || {
        for block in &blocks {
            camera.trace(&block.first(BLOCK), &mut rays.first(BLOCK));
            black_box(&rays);
        }
    })
}

fn one_by_one(camera: &Camera) -> Box<dyn FnMut() + '_> {
    let samples: Vec<Sample> = samples().take(BLOCK).collect();
    Box::new(move || {
        let mut carry = 0.0;
        for sample in &samples {
            let mut sample = *sample;
            // The carry is too small to change the sum.
            sample.image_x += carry;
            carry = camera.ray(&sample).map_or(0.0, |(_, weight)| weight * 1e-30);
        }
        black_box(carry);
    })
}
