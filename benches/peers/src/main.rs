//! The realistic camera of the crate `rs_pbrt` (pbrt-v3's, ported) and this library's: the same lens file, film,
//! aperture, film distance and samples, in interleaved rounds of one run: `cargo run --release [LENS]`.

#[path = "../../kernel/contest.rs"]
mod contest;

use std::{
    ffi::CString, fs, hint::black_box, mem::MaybeUninit, path::Path, ptr::null_mut, sync::Arc, time::Instant,
};

use contest::Contest;
use realistic::abi::*;
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

/// The catalogue's files, whose columns are pbrt's.
const LENSES: [(&str, &str); 4] = [
    ("dgauss.50mm", include_str!("../../../lenses/dgauss.50mm.dat")),
    ("wide.22mm", include_str!("../../../lenses/wide.22mm.dat")),
    ("telephoto.250mm", include_str!("../../../lenses/telephoto.250mm.dat")),
    ("fisheye.10mm", include_str!("../../../lenses/fisheye.10mm.dat")),
];
const SAMPLES: usize = 2048;
const ROUNDS: usize = 41;
const RESOLUTION: i32 = 1000;
/// Film diagonal, mm.
const DIAGONAL: f32 = 35.0;
/// Wider than any stop: both cameras then use the file's.
const WIDE_OPEN: f32 = 1e3;
/// To the film plane, m.
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
    let ours = Ours::new(file, film_distance);
    let mut starts: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            black_box(Ours::new(file, film_distance).one(&samples()[0]));
            start.elapsed().as_secs_f64()
        })
        .collect();
    starts.sort_by(f64::total_cmp);

    let samples = samples();
    let peer_samples: Vec<_> = samples.iter().map(peer_sample).collect();
    let weights = [
        peer_samples.iter().map(|sample| trace(peer, sample)).collect::<Vec<f32>>(),
        samples.iter().map(|sample| ours.one(sample)).collect(),
    ];
    println!("\n## {lens}, {SAMPLES} samples all over the film, {film_distance:.4} mm behind the lens\n");
    let mut contest = Contest::new(SAMPLES, "ns a sample");
    contest.enter("rs_pbrt, `generate_ray`", || {
        chain(&peer_samples, |sample, carry| {
            trace(
                peer,
                &CameraSample { p_film: Point2f { x: sample.p_film.x + carry, ..sample.p_film }, ..*sample },
            )
        });
    });
    contest.enter("realistic, `realistic_generate_ray`", || {
        chain(&samples, |sample, carry| {
            ours.one(&realistic_sample { image_x: sample.image_x + carry, ..*sample })
        });
    });
    contest.enter("rs_pbrt, `generate_ray_differential`", || {
        chain(&peer_samples, |sample, carry| {
            let p_film = Point2f { x: sample.p_film.x + carry, ..sample.p_film };
            let mut ray = Ray::default();
            black_box(peer.generate_ray_differential(&CameraSample { p_film, ..*sample }, &mut ray))
        });
    });
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    contest.enter("realistic, three calls through the vtable", || {
        chain(&samples, |sample, carry| {
            let first = realistic_sample { image_x: sample.image_x + carry, ..*sample };
            let right = realistic_sample { image_x: first.image_x + 1.0, ..first };
            let below =
                realistic_sample { image_x: right.image_x - 1.0, image_y: first.image_y + 1.0, ..first };
            let weight = ours.host(&first);
            black_box(ours.host(&right) + ours.host(&below));
            weight
        });
    });
    let medians = contest.run(ROUNDS);

    println!("\n| | rs_pbrt | realistic | ratio |\n|---|---|---|---|");
    let accepted = weights.each_ref().map(|w| w.iter().filter(|&&w| w > 0.0).count() as f64 / SAMPLES as f64);
    let mean = weights.each_ref().map(|w| w.iter().map(|&w| f64::from(w)).sum::<f64>() / SAMPLES as f64);
    let row = |what: &str, [a, b]: [f64; 2], digits: usize| {
        println!("| {what} | {a:.digits$} | {b:.digits$} | {:.2} |", a / b);
    };
    row("share of samples that pass", accepted, 4);
    row("ns a ray that passes", [medians[0] / accepted[0], medians[1] / accepted[1]], 1);
    row("from lens file to first ray, ms", [peer_start * 1e3, starts[ROUNDS / 2] * 1e3], 2);
    row("mean weight (the same, if the cameras are)", mean, 4);
    let variance = [0, 1].map(|i| {
        let square = |w: &f32| (f64::from(*w) / mean[i] - 1.0).powi(2);
        weights[i].iter().map(square).sum::<f64>() / SAMPLES as f64
    });
    row("relative variance of a sample's weight over the film", variance, 4);
}

/// The peer's camera of a lens file, as its own scene reader makes it.
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

/// This library's camera.
struct Ours(*mut realistic_camera);

impl Ours {
    fn new(file: &Path, film_distance: f64) -> Self {
        let mut options = MaybeUninit::<realistic_options>::zeroed();
        let mut camera = null_mut();
        let file = CString::new(file.display().to_string()).expect("no NUL");
        // SAFETY: the structure is as large as said, and the string outlives the call.
        unsafe {
            let size = size_of::<realistic_options>() as u32;
            assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
            let mut options = options.assume_init();
            (options.xres, options.yres) = (RESOLUTION, RESOLUTION);
            options.specfile = file.as_ptr();
            options.filmdistance = film_distance;
            options.filmdiag = f64::from(DIAGONAL);
            assert_eq!(realistic_camera_new(&options, &mut camera), realistic_status::Ok);
        }
        Self(camera)
    }

    fn one(&self, sample: &realistic_sample) -> f32 {
        let mut ray = realistic_ray::default();
        // SAFETY: a live camera.
        black_box(unsafe { realistic_generate_ray(self.0, sample, &mut ray) })
    }

    /// The first slot of the vtable, as a pbrt-v1 host calls it.
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    fn host(&self, sample: &realistic_sample) -> f32 {
        type GenerateRay =
            unsafe extern "C" fn(*const realistic_camera, *const realistic_sample, *mut realistic_ray) -> f32;
        let mut ray = realistic_ray::default();
        // SAFETY: where the C++ face is built a camera begins with a pointer to its vtable, whose first slot this is.
        unsafe {
            let generate = **self.0.cast::<*const GenerateRay>();
            black_box(generate(self.0, sample, &mut ray))
        }
    }
}

impl Drop for Ours {
    fn drop(&mut self) {
        // SAFETY: made in `new`, freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

/// Samples all but evenly spread over the film (R2 sequence, M. Roberts 2018).
fn samples() -> Vec<realistic_sample> {
    let number = |i: usize, step: f64| (0.5 + step * i as f64).fract() as f32;
    let at = |i| realistic_sample {
        image_x: RESOLUTION as f32 * number(i, 0.819_172_513_396_164_4),
        image_y: RESOLUTION as f32 * number(i, 0.671_043_606_703_789_3),
        lens_u: number(i, 0.754_877_666_246_692_8),
        lens_v: number(i, 0.569_840_290_998_053_2),
        time: 0.5,
    };
    (0..SAMPLES).map(at).collect()
}

fn peer_sample(sample: &realistic_sample) -> CameraSample {
    CameraSample {
        p_film: Point2f { x: sample.image_x, y: sample.image_y },
        p_lens: Point2f { x: sample.lens_u, y: sample.lens_v },
        time: sample.time,
    }
}

/// Calls of one sample each, every one waiting for the one before.
fn chain<S>(samples: &[S], call: impl Fn(&S, f32) -> f32) {
    let mut carry = 0.0;
    for sample in samples {
        // Too little to change the sum.
        carry = call(sample, carry) * 1e-30;
    }
    black_box(carry);
}
