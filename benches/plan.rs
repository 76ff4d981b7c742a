//! What a tolerance saves: a ray by each model of a lens, and a camera's batches with tolerances of 0, 0.01, 0.1
//! and 1 pixel, in one run; and what it takes to build such a camera.
//!
//! `cargo bench --no-default-features --bench plan` (with `-- dgauss` one lens). Medians over interleaved rounds;
//! the least stands beside them. The models' lines are what `src/plan/cost.rs` has its figures from;
//! `REALISTIC_SIMD=avx2` gives those of narrower registers.

#[path = "kernel/contest.rs"]
mod contest;

use std::{hint::black_box, time::Instant};

use contest::Contest;
use realistic::{
    camera::{BLOCK, Host, Parameters, Raster, RayBlock, RealisticCamera, Sample, SampleBlock},
    imaging::focus::Focus,
    lens::Lens,
    prescription::catalogue,
    sampling::PupilDisk,
    trace::{
        Direction, Path,
        kernel::{Kernel, LensRays, PlaneRays, Precision},
        polynomial::{Polynomial, PolynomialLens},
    },
};
use realistic_lab::ray_set::passing_rays;

/// The lenses of the assignment.
const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
/// Rays of a batch of the models.
const BATCH: usize = 2048;
/// Blocks of a round of the cameras.
const BLOCKS: usize = 8;
const RASTER: Raster = Raster { xres: 1920, yres: 1280 };
const TOLERANCES: [&str; 4] = ["0", "0.01", "0.1", "1"];

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let rounds = if arguments.iter().any(|argument| argument == "--test") { 1 } else { 31 };
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    for name in LENSES.into_iter().filter(|name| filter.is_none_or(|filter| name.contains(filter.as_str()))) {
        println!("\n## {name}: models\n");
        models(name, rounds);
        println!("\n## {name}: cameras\n");
        cameras(name, rounds);
    }
}

fn models(name: &str, rounds: usize) {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let distance = Focus::new(&lens).and_then(|focus| focus.film_distance(f64::INFINITY)).expect("focal");
    let film = lens.rear().vertex - distance;
    let reach = 10.0;
    let cover = PupilDisk::rear(&lens, film, reach).expect("behind the lens");
    let rays = passing_rays(&Path::<f64>::film_to_scene(&lens), film, reach, cover, BATCH, 0);
    let number = |part: fn(&realistic::trace::Ray) -> f64| rays.iter().map(part).collect::<Vec<f64>>();
    let columns = [
        number(|ray| ray.origin[0]),
        number(|ray| ray.origin[1]),
        number(|ray| ray.direction[0]),
        number(|ray| ray.direction[1]),
    ];
    let mut contest = Contest::new(BATCH, "ns a ray");
    let direction = Direction::FilmToScene;
    let kernel = Kernel::<f64>::new(&lens, direction);
    contest.enter("exact, f64", batch(film, &columns, move |from, to| kernel.trace_batch(from, to)));
    let kernel = Kernel::<f32>::new(&lens, direction);
    contest.enter("exact, f32", batch(film, &columns, move |from, to| kernel.trace_batch(from, to)));
    for (order, rims) in [
        (1, 0),
        (1, 2),
        (3, 0),
        (3, 1),
        (3, 2),
        (5, 0),
        (5, 1),
        (5, 2),
        (7, 0),
        (7, 1),
        (7, 2),
        (9, 0),
        (9, 1),
        (9, 2),
        (11, 0),
    ] {
        let surfaces: Vec<usize> = (1..=rims).collect();
        let fit = Polynomial::with_apertures(&lens, film, &rays, order, &surfaces).expect("determined");
        let single = PolynomialLens::<f32>::new(&fit);
        let trace = move |from: &PlaneRays<'_, f32>, to: &mut LensRays<'_, f32>| single.trace_batch(from, to);
        contest.enter(&format!("order {order}, {rims} rims, f32"), batch(film, &columns, trace));
        if rims == 1 {
            let double = PolynomialLens::<f64>::new(&fit);
            let trace =
                move |from: &PlaneRays<'_, f64>, to: &mut LensRays<'_, f64>| double.trace_batch(from, to);
            contest.enter(&format!("order {order}, {rims} rims, f64"), batch(film, &columns, trace));
        }
    }
    contest.run(rounds);
}

fn batch<S: Precision, F: FnMut(&PlaneRays<'_, S>, &mut LensRays<'_, S>)>(
    film: f64,
    columns: &[Vec<f64>; 4],
    mut trace: F,
) -> impl FnMut() + use<S, F> {
    let [x, y, slope_x, slope_y] =
        columns.each_ref().map(|column| column.iter().map(|&x| S::from_f64(x)).collect::<Vec<S>>());
    let mut out: [Vec<S>; 7] = std::array::from_fn(|_| vec![S::from_f64(0.0); BATCH]);
    move || {
        let [ox, oy, oz, dx, dy, dz, weight] = &mut out;
        let from = PlaneRays { plane: film, x: &x, y: &y, slope_x: &slope_x, slope_y: &slope_y };
        let mut to = LensRays { origin: [ox, oy, oz], direction: [dx, dy, dz], weight };
        trace(black_box(&from), &mut to);
        black_box(&to);
    }
}

fn camera(lens: &str, tolerance: &str) -> RealisticCamera {
    let mut parameters = Parameters::default();
    for (name, text) in [("specfile", lens), ("tolerance", tolerance)] {
        parameters.set_from_text(name, text).expect("a parameter");
    }
    RealisticCamera::build(&parameters, &Host::new(RASTER, None), &mut |_, _| ()).expect("a camera")
}

/// Samples all but evenly spread (R2 sequence, M. Roberts 2018) over the middle of the image.
fn sample(i: usize) -> Sample {
    let number = |step: f64| (0.5 + step * i as f64).fract();
    Sample {
        image_x: (f64::from(RASTER.xres) * (0.25 + 0.5 * number(0.819_172_513_396_164_4))) as f32,
        image_y: (f64::from(RASTER.yres) * (0.25 + 0.5 * number(0.671_043_606_703_789_3))) as f32,
        lens_u: number(0.754_877_666_246_692_8) as f32,
        lens_v: number(0.569_840_290_998_053_2) as f32,
        time: 0.5,
    }
}

fn cameras(lens: &str, rounds: usize) {
    let cameras = TOLERANCES.map(|tolerance| camera(lens, tolerance));
    for (camera, tolerance) in cameras.iter().zip(TOLERANCES) {
        let chosen =
            camera.plan().choice().map_or_else(|| "exact, f64".to_owned(), |choice| choice.sentence());
        let mut times: Vec<f64> = (0..rounds.min(9))
            .map(|_| {
                let start = Instant::now();
                black_box(self::camera(lens, tolerance));
                start.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        times.sort_by(f64::total_cmp);
        println!("tolerance {tolerance}: {:.2} ms to build; {chosen}", times[times.len() / 2]);
    }
    println!();
    let mut many = Contest::new(BLOCK * BLOCKS, "ns a ray, batches");
    let mut single = Contest::new(BLOCK, "ns a ray, one by one");
    for (camera, tolerance) in cameras.iter().zip(TOLERANCES) {
        let mut blocks: Vec<SampleBlock> = vec![SampleBlock::new(); BLOCKS];
        for (i, block) in blocks.iter_mut().enumerate() {
            (0..BLOCK).for_each(|j| block.set(j, &sample(i * BLOCK + j)));
        }
        let mut rays = RayBlock::new();
        many.enter(&format!("tolerance {tolerance}"), move || {
            for block in &blocks {
                camera.rays(&block.arrays(BLOCK), &mut rays.arrays(BLOCK));
                black_box(&rays);
            }
        });
        single.enter(&format!("tolerance {tolerance}"), move || {
            let mut carry = 0.0;
            for i in 0..BLOCK {
                let mut sample = sample(i);
                // Too little to change the sum.
                sample.image_x += carry;
                carry = camera.ray(&sample).map_or(0.0, |(_, weight)| weight * 1e-30);
            }
            black_box(carry);
        });
    }
    many.run(rounds);
    println!();
    single.run(rounds);
}
