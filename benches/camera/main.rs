//! Benchmarks camera rays from sample to world ray: through the vtable as a pbrt-v1 host calls it, through the C
//! export, and in batches. All are compared in one run with the camera that walks with Heckbert's refraction. It also
//! measures the build times of cameras.
//!
//! `cargo bench --bench camera` (`-- dgauss`: one lens; `-- catalogue`: one table of all lenses; `-- sizes`: one table
//! of all lenses in small batches; `-- models`: the models without interfaces). The figures are medians over
//! interleaved rounds.

mod c_camera;
mod calls;
mod catalogue;
#[path = "../../tests/support/inline.rs"]
mod inline;
mod models;
mod sizes;

use std::{
    ffi::{CStr, CString},
    hint::black_box,
    ptr::null_mut,
    sync::Barrier,
    time::Instant,
};

#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
use c_camera::triple;
use c_camera::{Arrays, Camera, chain, moved, samples};
use inline::realistic_camera_generate_rays;
use realistic::ffi::*;
use realistic_lab::{
    results::statistics::quantile,
    timing::{BenchArguments, Contest, Effort, LARGE_LENSES, repeated},
};
use realistic_optics::prescription;

/// Samples per round; through the vtable, each sample takes three calls.
const SAMPLES: usize = 2048;

const RESOLUTION: i32 = 1000;
/// The middle of the image, which every lens illuminates.
const MIDDLE: [f32; 2] = [250.0, 750.0];

fn main() {
    let arguments = BenchArguments::from_command_line(41);
    for (name, lens) in in_detail().filter(|(name, _)| arguments.wants(name)) {
        println!("\n## {name}");
        calls(lens, arguments.effort);
    }
    if arguments.wants("catalogue") {
        catalogue::print(arguments.effort);
    }
    if arguments.wants("sizes") {
        sizes::print(arguments.effort);
    }
    if arguments.wants("models") {
        println!("\n## Models without interfaces\n");
        models::print(&samples(SAMPLES, MIDDLE), arguments.effort);
    }
    println!("\n## From a lens's name to the first ray\n");
    println!("| lens | warped pupil, ms: median | least | pupil \"rear\", ms: median | least |");
    println!("|---|---|---|---|---|");
    for (name, lens) in lenses().filter(|(name, _)| arguments.wants(name)) {
        let [warped, rear] = [c"warped", c"rear"].map(|pupil| start(lens, pupil, arguments.effort.rounds));
        println!("| {name} | {:.2} | {:.2} | {:.3} | {:.3} |", warped[0], warped[1], rear[0], rear[1]);
    }
}

/// Returns every lens with its name and its `lens_file`: the catalogue's lenses, and two of realistic size.
fn lenses() -> impl Iterator<Item = (&'static str, &'static str)> {
    prescription::catalogue::round().map(|name| (name, name)).chain(LARGE_LENSES)
}

/// Returns the lenses for which every kind of call is timed, which takes some minutes.
fn in_detail() -> impl Iterator<Item = (&'static str, &'static str)> {
    const FEW: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
    FEW.into_iter().map(|name| (name, name)).chain(LARGE_LENSES)
}

/// Builds the camera of a lens; `give` sets further options.
fn camera(lens: &str, give: impl FnOnce(&mut realistic_options)) -> Camera {
    let lens = CString::new(lens).expect("no NUL");
    let mut options = realistic_options {
        xres: RESOLUTION,
        yres: RESOLUTION,
        lens_file: lens.as_ptr(),
        ..realistic_options::default()
    };
    give(&mut options);
    Camera::new(&options)
}

fn calls(lens: &str, effort: Effort) {
    let samples = samples(SAMPLES, MIDDLE);
    let walk = camera(lens, |options| options.refraction = c"heckbert".as_ptr());
    let single = camera(lens, |options| options.precision = c"f32".as_ptr());
    let camera = camera(lens, |_| ());
    let passing = samples.iter().filter(|sample| camera.one(sample) > 0.0).count();
    println!("{passing} of {SAMPLES} samples get through\n");
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    let triples: Vec<_> = samples[..SAMPLES / 3 + 1].iter().flat_map(triple).take(SAMPLES).collect();
    let mut contest = Contest::default();
    for (name, camera) in
        [("C export, Heckbert's walk", &walk), ("C export", &camera), ("C export, f32", &single)]
    {
        let samples = &samples;
        let calls = move || chain(samples, |sample, carry| camera.one(&moved(sample, carry)));
        contest.enter(name, Box::new(calls) as Box<dyn FnMut()>);
    }
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    for (name, camera) in [("vtable, three calls per sample", &camera), ("the same, f32", &single)] {
        let triples = &triples;
        let calls = move || chain(triples, |sample, carry| camera.host(&moved(sample, carry)));
        contest.enter(name, Box::new(calls) as Box<dyn FnMut()>);
    }
    for (name, camera) in [("f64", &camera), ("f32", &single)] {
        let samples = &samples;
        let mut rays = vec![realistic_ray::default(); SAMPLES];
        let mut weights = vec![0.0; SAMPLES];
        let structures = move || {
            // SAFETY: every array that is passed has room for its elements.
            let status = unsafe {
                realistic_camera_generate_rays(
                    camera.0,
                    SAMPLES,
                    samples.as_ptr(),
                    0,
                    rays.as_mut_ptr(),
                    0,
                    weights.as_mut_ptr(),
                    null_mut(),
                )
            };
            assert_eq!(status, realistic_status::Ok);
            black_box((&rays, &weights));
        };
        contest.enter(format!("batch, structures, {name}"), Box::new(structures) as Box<dyn FnMut()>);
        let mut arrays = Arrays::new(samples);
        let arrays = move || arrays.generate(camera);
        contest.enter(format!("batch, arrays, {name}"), Box::new(arrays) as Box<dyn FnMut()>);
    }
    contest.print("ns per call or ray", SAMPLES, effort);
    calls::print(lens, [("f64", &camera), ("f32", &single)], &samples, effort);
    for (name, camera) in [("f64", &camera), ("f32", &single)] {
        let [one, two] = [1, 2].map(|threads| throughput(camera, &samples, threads, effort.rounds));
        println!("\nbatch, arrays, {name}: two threads at once do {:.2} times the work of one", two / one);
    }
}

/// Returns the median, over rounds, of the batches per second of this many threads, which share one camera and each
/// have their own arrays.
fn throughput(camera: &Camera, samples: &[realistic_sample], threads: usize, rounds: usize) -> f64 {
    // Runs are long because a thread may start a millisecond late.
    const BATCHES: usize = 4000;
    let rates: Vec<f64> = (0..rounds.min(9))
        .map(|_| {
            let start = Barrier::new(threads);
            let times: Vec<[Instant; 2]> = std::thread::scope(|scope| {
                let work = || {
                    let mut arrays = Arrays::new(samples);
                    arrays.generate(camera);
                    start.wait();
                    let begun = Instant::now();
                    (0..BATCHES).for_each(|_| arrays.generate(camera));
                    [begun, Instant::now()]
                };
                let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
                workers.into_iter().map(|worker| worker.join().expect("no panic")).collect()
            });
            let begun = times.iter().map(|time| time[0]).min().expect("a thread");
            let ended = times.iter().map(|time| time[1]).max().expect("a thread");
            let seconds = (ended - begun).as_secs_f64();
            (threads * BATCHES) as f64 / seconds
        })
        .collect();
    quantile(&rates, 0.5)
}

/// Returns the milliseconds from a lens's name to the first ray: median and minimum.
fn start(lens: &str, pupil: &CStr, rounds: usize) -> [f64; 2] {
    let middle = (RESOLUTION / 2) as f32;
    let sample = realistic_sample { image_x: middle, image_y: middle, lens_u: 0.5, lens_v: 0.5, time: 0.5 };
    let (_, times) = repeated(rounds, || camera(lens, |options| options.pupil = pupil.as_ptr()).one(&sample));
    [0.5, 0.0].map(|q| quantile(&times, q) * 1e3)
}
