//! Benchmarks the realistic camera of the crate `rs_pbrt` (ported from pbrt-v3) against this library's camera, with the
//! same lens file, film, aperture, film distance and samples, in interleaved rounds of one run: `cargo run --release
//! [LENS]`.

#[path = "../../camera/c_camera.rs"]
#[allow(dead_code, reason = "the cameras' bench uses the rest")]
mod c_camera;
#[path = "../../../tests/support/inline.rs"]
mod inline;

use std::{
    ffi::CString,
    fs,
    hint::black_box,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
use c_camera::triple;
use c_camera::{Camera, chain, moved, samples};
use realistic::ffi::*;
use realistic_lab::timing::{Contest, Effort};
use rs_pbrt::{
    cameras::realistic::RealisticCamera,
    core::{
        camera::{Camera as Peer, CameraSample},
        film::Film,
        geometry::{Bounds2f, Point2f, Point2i, Ray},
        paramset::ParamSet,
        transform::{AnimatedTransform, Transform},
    },
    filters::boxfilter::BoxFilter,
};

/// Lens files of the catalogue whose columns are those of pbrt.
const LENSES: [(&str, &str); 4] = [
    ("dgauss.50mm", include_str!("../../../crates/optics/lenses/dgauss.50mm.dat")),
    ("wide.22mm", include_str!("../../../crates/optics/lenses/wide.22mm.dat")),
    ("telephoto.250mm", include_str!("../../../crates/optics/lenses/telephoto.250mm.dat")),
    ("fisheye.10mm", include_str!("../../../crates/optics/lenses/fisheye.10mm.dat")),
];
const SAMPLES: usize = 2048;
const ROUNDS: usize = 41;
const RESOLUTION: i32 = 1000;
/// Film diagonal, mm.
const DIAGONAL: f32 = 35.0;
/// An aperture wider than any stop, so that both cameras use the stop of the file.
const WIDE_OPEN: f32 = 1e3;
/// Distance from the focused plane to the film plane, m.
const FOCUS_DISTANCE: f32 = 10.0;

fn main() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let named = std::env::args().nth(1);
    let named = named.as_deref().unwrap_or("dgauss.50mm");
    for (lens, text) in LENSES.into_iter().filter(|(lens, _)| *lens == named) {
        let file = directory.path().join(format!("{lens}.dat"));
        fs::write(&file, text).expect("room for a lens file");
        compare(lens, &file);
    }
}

fn compare(lens: &str, file: &Path) {
    let start = Instant::now();
    let peer = peer(file);
    let peer_start = start.elapsed().as_secs_f64();
    let Peer::Realistic(peer) = &*peer else { unreachable!("a realistic camera was asked for") };
    let film_distance = f64::from(peer.lens_rear_z()) * 1e3;
    let ours = camera(file, film_distance);
    let samples = samples(SAMPLES, [0.0, RESOLUTION as f32]);
    let mut starts: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            black_box(camera(file, film_distance).one(&samples[0]));
            start.elapsed().as_secs_f64()
        })
        .collect();
    starts.sort_by(f64::total_cmp);

    let peer_samples: Vec<_> = samples.iter().map(peer_sample).collect();
    let weights = [
        peer_samples.iter().map(|sample| trace(peer, sample)).collect::<Vec<f32>>(),
        samples.iter().map(|sample| ours.one(sample)).collect(),
    ];
    println!("\n## {lens}, {SAMPLES} samples all over the film, {film_distance:.4} mm behind the lens\n");
    let mut contest = Contest::default();
    contest.enter(
        "rs_pbrt, `generate_ray`",
        task(|| {
            chain(&peer_samples, |sample, carry| {
                trace(
                    peer,
                    &CameraSample {
                        p_film: Point2f { x: sample.p_film.x + carry, ..sample.p_film },
                        ..*sample
                    },
                )
            });
        }),
    );
    contest.enter(
        "realistic, `realistic_generate_ray`",
        task(|| {
            chain(&samples, |sample, carry| ours.one(&moved(sample, carry)));
        }),
    );
    contest.enter(
        "rs_pbrt, `generate_ray_differential`",
        task(|| {
            chain(&peer_samples, |sample, carry| {
                let p_film = Point2f { x: sample.p_film.x + carry, ..sample.p_film };
                let mut ray = Ray::default();
                black_box(peer.generate_ray_differential(&CameraSample { p_film, ..*sample }, &mut ray))
            });
        }),
    );
    contest.enter(
        "realistic, `realistic_generate_ray_differential`",
        task(|| {
            chain(&samples, |sample, carry| ours.differential(&moved(sample, carry)));
        }),
    );
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    contest.enter(
        "realistic, three calls through the vtable",
        task(|| {
            chain(&samples, |sample, carry| {
                let [first, right, below] = triple(&moved(sample, carry));
                let weight = ours.host(&first);
                black_box(ours.host(&right) + ours.host(&below));
                weight
            });
        }),
    );
    let effort = Effort { rounds: ROUNDS, least: Duration::from_micros(200) };
    let medians: Vec<f64> =
        contest.print("ns per sample", SAMPLES, effort).iter().map(|timing| timing.median * 1e9).collect();

    println!("\n| | rs_pbrt | realistic | ratio |\n|---|---|---|---|");
    let accepted = weights.each_ref().map(|w| w.iter().filter(|&&w| w > 0.0).count() as f64 / SAMPLES as f64);
    let mean = weights.each_ref().map(|w| w.iter().map(|&w| f64::from(w)).sum::<f64>() / SAMPLES as f64);
    let row = |what: &str, [a, b]: [f64; 2], digits: usize| {
        println!("| {what} | {a:.digits$} | {b:.digits$} | {:.2} |", a / b);
    };
    row("share of samples that pass", accepted, 4);
    row("ns per ray that passes", [medians[0] / accepted[0], medians[1] / accepted[1]], 1);
    row("from lens file to first ray, ms", [peer_start * 1e3, starts[ROUNDS / 2] * 1e3], 2);
    row("mean weight (the same, if the cameras are)", mean, 4);
    let variance = [0, 1].map(|i| {
        let square = |w: &f32| (f64::from(*w) / mean[i] - 1.0).powi(2);
        weights[i].iter().map(square).sum::<f64>() / SAMPLES as f64
    });
    row("relative variance of a sample's weight over the film", variance, 4);
}

/// Builds the peer's camera of a lens file, as its own scene reader does.
fn peer(file: &Path) -> Arc<Peer> {
    let whole = Bounds2f { p_min: Point2f { x: 0.0, y: 0.0 }, p_max: Point2f { x: 1.0, y: 1.0 } };
    let resolution = Point2i { x: RESOLUTION, y: RESOLUTION };
    let filter = BoxFilter::create(&ParamSet::default());
    let film = Film::new(resolution, whole, filter, DIAGONAL, String::new(), 1.0, f32::INFINITY);
    let identity = Transform::scale(1.0, 1.0, 1.0);
    let mut parameters = ParamSet::default();
    parameters.add_string("lensfile".to_owned(), file.display().to_string());
    parameters.add_float("aperturediameter".to_owned(), WIDE_OPEN);
    parameters.add_float("focusdistance".to_owned(), FOCUS_DISTANCE);
    parameters.add_bool("simpleweighting".to_owned(), false);
    let to_world = AnimatedTransform::new(&identity, 0.0, &identity, 1.0);
    RealisticCamera::create(&parameters, to_world, Arc::new(film), None, None)
}

fn trace(peer: &RealisticCamera, sample: &CameraSample) -> f32 {
    let mut ray = Ray::default();
    black_box(peer.generate_ray(sample, &mut ray))
}

/// Builds this library's camera of a lens file.
fn camera(file: &Path, film_distance: f64) -> Camera {
    let file = CString::new(file.display().to_string()).expect("no NUL");
    Camera::new(&realistic_options {
        xres: RESOLUTION,
        yres: RESOLUTION,
        lens_file: file.as_ptr(),
        film_distance,
        film_diagonal: f64::from(DIAGONAL),
        ..realistic_options::default()
    })
}

fn peer_sample(sample: &realistic_sample) -> CameraSample {
    CameraSample {
        p_film: Point2f { x: sample.image_x, y: sample.image_y },
        p_lens: Point2f { x: sample.lens_u, y: sample.lens_v },
        time: sample.time,
    }
}

/// Boxes the work of a contestant.
fn task<'a>(work: impl FnMut() + 'a) -> Box<dyn FnMut() + 'a> {
    Box::new(work)
}
