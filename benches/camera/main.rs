//! What a camera ray costs a host, from sample to world ray: through the vtable as a pbrt-v1 host calls
//! it, through the C export, and in batches, against the camera that walks with Heckbert's refraction, all in one run;
//! and what it takes to build a camera.
//!
//! `cargo bench --no-default-features --bench camera` (with `-- dgauss` one lens). Medians over interleaved rounds;
//! the least stands beside them.

#[path = "../kernel/contest.rs"]
mod contest;

use std::{ffi::CString, hint::black_box, mem::MaybeUninit, ptr::null_mut, sync::Barrier, time::Instant};

use contest::Contest;
use realistic::{abi::*, prescription::catalogue};

/// Samples of a round; three calls each through the vtable.
const SAMPLES: usize = 2048;

const RESOLUTION: i32 = 1000;

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let rounds = if arguments.iter().any(|argument| argument == "--test") { 1 } else { 41 };
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    let lenses =
        || catalogue::names().filter(|name| filter.is_none_or(|filter| name.contains(filter.as_str())));
    for name in lenses().filter(|name| TIMED.contains(name)) {
        println!("\n## {name}");
        calls(name, rounds);
    }
    println!("\n## From a lens's name to the first ray\n");
    println!("| lens | warped pupil, ms: median | least | pupil \"rear\", ms: median | least |");
    println!("|---|---|---|---|---|");
    for name in lenses() {
        let [warped, rear] = ["warped", "rear"].map(|pupil| start(name, pupil, rounds));
        println!("| {name} | {:.2} | {:.2} | {:.3} | {:.3} |", warped[0], warped[1], rear[0], rear[1]);
    }
}

/// The lenses of the assignment.
const TIMED: [&str; 4] = ["dgauss.50mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];

/// A camera, freed in the end.
struct Camera(*mut realistic_camera);

// SAFETY: a camera does not change once it is built, and any thread may ask it for rays.
unsafe impl Sync for Camera {}

impl Camera {
    fn new(lens: &str, texts: &[(&str, &str)]) -> Self {
        let mut options = MaybeUninit::<realistic_options>::zeroed();
        let mut camera = null_mut();
        let texts: Vec<_> =
            texts.iter().map(|(name, text)| (*name, CString::new(*text).expect("no NUL"))).collect();
        let lens = CString::new(lens).expect("no NUL");
        // SAFETY: the structure is as large as said, and the strings outlive the call.
        unsafe {
            let size = size_of::<realistic_options>() as u32;
            assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
            let mut options = options.assume_init();
            (options.xres, options.yres) = (RESOLUTION, RESOLUTION);
            options.specfile = lens.as_ptr();
            for (name, text) in &texts {
                match *name {
                    "refraction" => options.refraction = text.as_ptr(),
                    "precision" => options.precision = text.as_ptr(),
                    "pupil" => options.pupil = text.as_ptr(),
                    _ => unreachable!("{name} is not used here"),
                }
            }
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

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: made in `new`, freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

/// Samples all but evenly spread (R2 sequence, M. Roberts 2018) over the middle of the image, which every lens
/// lights.
fn samples() -> Vec<realistic_sample> {
    let number = |i: usize, step: f64| (0.5 + step * i as f64).fract() as f32;
    let at = |i| realistic_sample {
        image_x: 250.0 + 500.0 * number(i, 0.819_172_513_396_164_4),
        image_y: 250.0 + 500.0 * number(i, 0.671_043_606_703_789_3),
        lens_u: number(i, 0.754_877_666_246_692_8),
        lens_v: number(i, 0.569_840_290_998_053_2),
        time: 0.5,
    };
    (0..SAMPLES).map(at).collect()
}

/// Calls of one sample each, every one waiting for the one before.
fn chain(samples: &[realistic_sample], call: impl Fn(&realistic_sample) -> f32) {
    let mut carry = 0.0;
    for sample in samples {
        // Too little to change the sum.
        let sample = realistic_sample { image_x: sample.image_x + carry, ..*sample };
        carry = call(&sample) * 1e-30;
    }
    black_box(carry);
}

fn calls(lens: &str, rounds: usize) {
    let samples = samples();
    let camera = Camera::new(lens, &[]);
    let single = Camera::new(lens, &[("precision", "f32")]);
    let walk = Camera::new(lens, &[("refraction", "heckbert")]);
    let passing = samples.iter().filter(|sample| camera.one(sample) > 0.0).count();
    println!("{passing} of {SAMPLES} samples get through\n");
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    let triples: Vec<_> = samples[..SAMPLES / 3 + 1]
        .iter()
        .flat_map(|sample| {
            let right = sample.image_x + 1.0;
            let below = sample.image_y + 1.0;
            [
                *sample,
                realistic_sample { image_x: right, ..*sample },
                realistic_sample { image_x: right - 1.0, image_y: below, ..*sample },
            ]
        })
        .take(SAMPLES)
        .collect();
    let mut contest = Contest::new(SAMPLES, "ns a call or ray");
    contest.enter("C export, Heckbert's walk", || chain(&samples, |sample| walk.one(sample)));
    contest.enter("C export", || chain(&samples, |sample| camera.one(sample)));
    contest.enter("C export, f32", || chain(&samples, |sample| single.one(sample)));
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    for (name, camera) in [("vtable, three calls a sample", &camera), ("the same, f32", &single)] {
        let triples = &triples;
        contest.enter(name, move || chain(triples, |sample| camera.host(sample)));
    }
    for (name, camera) in [("f64", &camera), ("f32", &single)] {
        let samples = &samples;
        let mut rays = vec![realistic_ray::default(); SAMPLES];
        let mut weights = vec![0.0; SAMPLES];
        contest.enter(&format!("batch, structures, {name}"), move || {
            // SAFETY: every array has room.
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
        });
        let mut arrays = Arrays::new(samples);
        contest.enter(&format!("batch, arrays, {name}"), move || arrays.generate(camera));
    }
    contest.run(rounds);
    for (name, camera) in [("f64", &camera), ("f32", &single)] {
        let [one, two] = [1, 2].map(|threads| throughput(camera, &samples, threads, rounds));
        println!("\nbatch, arrays, {name}: two threads at once do {:.2} times the work of one", two / one);
    }
}

/// Samples and rays as structure of arrays.
struct Arrays {
    asked: [Vec<f32>; 5],
    found: [Vec<f32>; 7],
}

impl Arrays {
    fn new(samples: &[realistic_sample]) -> Self {
        let column = |part: fn(&realistic_sample) -> f32| samples.iter().map(part).collect::<Vec<f32>>();
        Self {
            asked: [
                column(|sample| sample.image_x),
                column(|sample| sample.image_y),
                column(|sample| sample.lens_u),
                column(|sample| sample.lens_v),
                column(|sample| sample.time),
            ],
            found: std::array::from_fn(|_| vec![0.0; samples.len()]),
        }
    }

    fn generate(&mut self, camera: &Camera) {
        let [image_x, image_y, lens_u, lens_v, time] = self.asked.each_ref().map(|array| array.as_ptr());
        let asked = realistic_samples_soa { image_x, image_y, lens_u, lens_v, time };
        let [ox, oy, oz, dx, dy, dz, weight] = self.found.each_mut().map(|array| array.as_mut_ptr());
        let none = null_mut();
        let (mint, maxt, time, reason) = (none, none, none, null_mut());
        let rays = realistic_rays_soa { ox, oy, oz, dx, dy, dz, mint, maxt, time, weight, reason };
        let n = self.asked[0].len();
        // SAFETY: every array that is there has room.
        let status = unsafe { realistic_camera_generate_rays_soa(camera.0, n, &asked, &rays) };
        assert_eq!(status, realistic_status::Ok);
        black_box(&self.found);
    }
}

/// Batches a second that so many threads get from one camera, each with arrays of its own: the median over rounds.
fn throughput(camera: &Camera, samples: &[realistic_sample], threads: usize, rounds: usize) -> f64 {
    // Long, for a thread may begin a millisecond late.
    const BATCHES: usize = 4000;
    let mut rates: Vec<f64> = (0..rounds.min(9))
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
    rates.sort_by(f64::total_cmp);
    rates[rates.len() / 2]
}

/// Milliseconds from a lens's name to the first ray: median and least.
fn start(lens: &str, pupil: &str, rounds: usize) -> [f64; 2] {
    let middle = (RESOLUTION / 2) as f32;
    let sample = realistic_sample { image_x: middle, image_y: middle, lens_u: 0.5, lens_v: 0.5, time: 0.5 };
    let mut times: Vec<f64> = (0..rounds)
        .map(|_| {
            let start = Instant::now();
            let camera = Camera::new(lens, &[("pupil", pupil)]);
            camera.one(&sample);
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    [times[times.len() / 2], times[0]]
}
