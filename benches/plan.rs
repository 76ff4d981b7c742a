//! What a tolerance saves: a ray by each model of a lens, and a camera's batches with tolerances of 0, 0.01, 0.1
//! and 1 pixel, in one run; and what it takes to build such a camera.
//!
//! `cargo bench --bench plan` (with `-- dgauss` one lens). Medians over interleaved rounds. The models' lines are what `src/plan/cost.rs` has its figures from;
//! `REALISTIC_SIMD=avx2` gives those of narrower registers.

use std::hint::black_box;

use realistic::{
    camera::{Host, Parameters, Raster, RayBlock, RealisticCamera, Sample, SampleBlock},
    imaging::focus::Focus,
    lens::Lens,
    prescription::catalogue,
    sampling::PupilDisk,
    trace::{
        Direction, Path, Ray, Real,
        kernel::{Kernel, KernelScalar, LensRays, PlaneRays},
        polynomial::{Polynomial, PolynomialLens},
    },
};
use realistic_lab::BLOCK;
use realistic_lab::{
    results::statistics::median,
    subject::{FilmRays, passing_rays, quasirandom::spread},
    timing::{BenchArguments, Contest, Effort, repeated},
};

/// The lenses of the assignment.
const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
/// Rays of a batch of the models.
const BATCH: usize = 2048;
/// Blocks of a round of the cameras.
const BLOCKS: usize = 8;
const RASTER: Raster = Raster { xres: 1920, yres: 1280 };
const TOLERANCES: [&str; 4] = ["0", "0.01", "0.1", "1"];

fn main() {
    let arguments = BenchArguments::from_command_line(31);
    for name in LENSES.into_iter().filter(|name| arguments.wants(name)) {
        println!("\n## {name}: models\n");
        models(name, arguments.effort);
        println!("\n## {name}: cameras\n");
        cameras(name, arguments.effort);
    }
}

fn models(name: &str, effort: Effort) {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let distance = Focus::new(&lens).and_then(|focus| focus.film_distance(f64::INFINITY)).expect("focal");
    let film = lens.rear().vertex - distance;
    let reach = 10.0;
    let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
    let rays = passing_rays(&Path::<f64>::film_to_scene(&lens), film, reach, cover, BATCH, 0);
    let mut contest = Contest::default();
    let direction = Direction::FilmToScene;
    let kernel = Kernel::<f64>::new(&lens, direction);
    contest.enter("exact, f64", batch(film, &rays, move |from, to| kernel.trace_batch(from, to)));
    let kernel = Kernel::<f32>::new(&lens, direction);
    contest.enter("exact, f32", batch(film, &rays, move |from, to| kernel.trace_batch(from, to)));
    for (order, apertures) in MODELS {
        let surfaces: Vec<usize> = (1..=apertures).collect();
        let fit = Polynomial::with_apertures(&lens, film, &rays, order, &surfaces).expect("determined");
        let name = format!("order {order}, {apertures} apertures");
        let single = PolynomialLens::<f32>::new(&fit);
        let trace = move |from: &PlaneRays<'_, f32>, to: &mut LensRays<'_, f32>| single.trace_batch(from, to);
        contest.enter(format!("{name}, f32"), batch(film, &rays, trace));
        if apertures == 1 {
            let double = PolynomialLens::<f64>::new(&fit);
            let trace =
                move |from: &PlaneRays<'_, f64>, to: &mut LensRays<'_, f64>| double.trace_batch(from, to);
            contest.enter(format!("{name}, f64"), batch(film, &rays, trace));
        }
    }
    contest.print("ns per ray", BATCH, effort);
}

/// Orders, each with as many apertures as are tested.
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

fn camera(lens: &str, tolerance: &str) -> RealisticCamera {
    let mut parameters = Parameters::default();
    for (name, text) in [("specfile", lens), ("tolerance", tolerance)] {
        parameters.set_from_text(name, text).expect("a parameter");
    }
    RealisticCamera::build(&parameters, &Host::new(RASTER, None), &mut |_, _| ()).expect("a camera")
}

/// Samples all but evenly spread over the middle of the image.
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

fn cameras(lens: &str, effort: Effort) {
    let cameras = TOLERANCES.map(|tolerance| camera(lens, tolerance));
    for (camera, tolerance) in cameras.iter().zip(TOLERANCES) {
        let chosen =
            camera.plan().choice().map_or_else(|| "exact, f64".to_owned(), |choice| choice.sentence());
        let (_, times) = repeated(effort.rounds.min(9), || self::camera(lens, tolerance));
        println!("tolerance {tolerance}: {:.2} ms to build; {chosen}", median(&times) * 1e3);
    }
    println!();
    let samples: Vec<Sample> = samples().take(BLOCK * BLOCKS).collect();
    let (mut many, mut single) = (Contest::default(), Contest::default());
    for (camera, tolerance) in cameras.iter().zip(TOLERANCES) {
        let mut blocks: Vec<SampleBlock<BLOCK>> = vec![SampleBlock::<BLOCK>::new(); BLOCKS];
        for (block, samples) in blocks.iter_mut().zip(samples.chunks(BLOCK)) {
            samples.iter().enumerate().for_each(|(i, sample)| block.set(i, sample));
        }
        let mut rays = RayBlock::<BLOCK>::new();
        let batches = move || {
            for block in &blocks {
                camera.rays(&block.arrays(BLOCK), &mut rays.arrays(BLOCK));
                black_box(&rays);
            }
        };
        many.enter(format!("tolerance {tolerance}"), Box::new(batches) as Box<dyn FnMut()>);
        let samples = &samples[..BLOCK];
        let chain = move || {
            let mut carry = 0.0;
            for sample in samples {
                let mut sample = *sample;
                // Too little to change the sum.
                sample.image_x += carry;
                carry = camera.ray(&sample).map_or(0.0, |(_, weight)| weight * 1e-30);
            }
            black_box(carry);
        };
        single.enter(format!("tolerance {tolerance}"), Box::new(chain) as Box<dyn FnMut()>);
    }
    many.print("ns per ray, batches", BLOCK * BLOCKS, effort);
    println!();
    single.print("ns per ray, one by one", BLOCK, effort);
}
