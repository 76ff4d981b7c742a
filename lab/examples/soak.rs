//! A soak test of the C ABI: it generates random lenses in random cameras and samples of random bits, and checks the
//! header's promises on each ray.
//!
//! ```text
//! cargo run --release -p realistic-lab --example soak [RAYS [SEED]]      # default: 1e9 rays
//! ```
//!
//! Half of the lenses are random ones that pass the checks of a lens file; the other half come from the catalogue,
//! scaled. For each model, every parameter of the table that applies to it is set in some of the cameras, to any value
//! in the parameter's range. One sample in four has random bits, in one member or in all. Every camera is called with
//! structures of arrays, with and without reasons, and some of the samples are requested again one by one; with a
//! tolerance, the results of the two calls may differ by as much as the tolerance permits.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString, NulError};
use std::fmt;
use std::ptr::{null, null_mut};
use std::time::Instant;

use ::realistic_camera::Parameters;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus as Random;
use realistic::ffi::*;
use realistic_lab::stability::random::{lens_text, scaled};

#[path = "../../fuzz/bodies/any_parameters.rs"]
mod any_parameters;
#[path = "../../fuzz/bodies/contract.rs"]
mod contract;

/// Samples per call.
const BATCH: usize = 1 << 14;
/// Calls per camera.
const CALLS: u64 = 8;
/// Samples per call that are repeated one by one.
const SINGLES: usize = 64;
/// Pixels of the square picture.
const PIXELS: i32 = 256;

/// The results of a soak.
#[derive(Debug, Default)]
pub struct Counts {
    /// Cameras built, and cameras refused with a message.
    pub cameras: [u64; 2],
    /// Samples requested.
    pub rays: u64,
    /// Rays with a weight above 0.
    pub passed: u64,
    /// Samples by `realistic_reason`, among those requested with reasons.
    pub reasons: BTreeMap<i32, u64>,
    /// Rays that break the header's promises, or differ between two kinds of call.
    pub violations: u64,
    /// Descriptions of the first violations.
    pub examples: Vec<String>,
    /// Memory in use after a tenth of the rays, and at the end, bytes.
    pub memory: [u64; 2],
}

impl Counts {
    fn violation(&mut self, text: String) {
        self.violations += 1;
        if self.examples.len() < 10 {
            self.examples.push(text);
        }
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [&str; 7] = ["ok", "missed", "clipped", "reflected", "turned back", "redraw", "shut"];
        let [built, refused] = self.cameras;
        writeln!(f, "cameras     {built} built, {refused} refused")?;
        let share = 100.0 * self.passed as f64 / self.rays.max(1) as f64;
        writeln!(f, "rays        {}, of which {share:.1} % pass", self.rays)?;
        for (&reason, count) in &self.reasons {
            let name = usize::try_from(reason).ok().and_then(|i| NAMES.get(i)).unwrap_or(&"no known reason");
            writeln!(f, "  {name:<12}{count}")?;
        }
        let [early, late] = self.memory.map(|bytes| bytes as f64 / 1e6);
        writeln!(f, "memory      {early:.1} MB after a tenth, {late:.1} MB at the end")?;
        write!(f, "violations  {}", self.violations)?;
        self.examples.iter().try_for_each(|example| write!(f, "\n  {example}"))
    }
}

/// Arrays for one batch's samples and rays.
struct Arrays {
    samples: [Vec<f32>; 5],
    rays: [Vec<f32>; 10],
    reasons: Vec<realistic_reason>,
}

/// Initial value of every ray, to detect rays that were not written.
const MARK: realistic_ray = realistic_ray { o: [-7.0; 3], d: [-7.0; 3], mint: -7.0, maxt: -7.0, time: -7.0 };

impl Arrays {
    fn new() -> Self {
        Self {
            samples: std::array::from_fn(|_| vec![0.0; BATCH]),
            rays: std::array::from_fn(|_| vec![-7.0; BATCH]),
            reasons: vec![realistic_reason::Ok; BATCH],
        }
    }

    fn fill(&mut self, random: &mut Random) {
        let scale = [PIXELS as f32, PIXELS as f32, 1.0, 1.0, 1.0];
        for i in 0..BATCH {
            let wild = match random.random_range(0..20_u8) {
                0 => 0..5,
                which @ 1..5 => {
                    let one = usize::from(which) + random.random_range(0..2_usize) - 1;
                    one..one + 1
                }
                _ => 0..0,
            };
            for (member, array) in self.samples.iter_mut().enumerate() {
                array[i] = if wild.contains(&member) {
                    f32::from_bits(random.random())
                } else {
                    scale[member] * random.random::<f32>()
                };
            }
        }
        self.rays.iter_mut().for_each(|array| array.fill(-7.0));
    }

    fn sample(&self, i: usize) -> realistic_sample {
        let [image_x, image_y, lens_u, lens_v, time] = self.samples.each_ref().map(|array| array[i]);
        realistic_sample { image_x, image_y, lens_u, lens_v, time }
    }

    fn ray(&self, i: usize) -> (realistic_ray, f32) {
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] = self.rays.each_ref().map(|array| array[i]);
        (realistic_ray { o: [ox, oy, oz], d: [dx, dy, dz], mint, maxt, time }, weight)
    }

    fn trace(&mut self, camera: *const realistic_camera, with_reasons: bool) -> realistic_status {
        let [image_x, image_y, lens_u, lens_v, time] = self.samples.each_ref().map(Vec::as_ptr);
        let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, ray_time] =
            self.rays.each_mut().map(Vec::as_mut_ptr);
        let pair = |x, y| realistic_input::columns([x, y]);
        let vector = |x, y, z| realistic_output::columns([x, y, z]);
        let number = |x| realistic_output::columns([x]);
        let request = realistic_request {
            image: pair(image_x, image_y),
            lens: pair(lens_u, lens_v),
            time: realistic_input::columns([time]),
            origin: vector(ox, oy, oz),
            direction: vector(dx, dy, dz),
            weight: number(weight),
            mint: number(mint),
            maxt: number(maxt),
            ray_time: number(ray_time),
            reason: if with_reasons { self.reasons.as_mut_ptr() } else { null_mut() },
            reason_stride: size_of::<realistic_reason>() as isize,
            ..realistic_request::default()
        };
        // SAFETY: the camera is live, and the arrays have BATCH elements.
        unsafe { realistic_camera_generate_batch(camera, BATCH, &request) }
    }
}

/// A random camera, and whether it returns the same bits one by one and in batches; `None` if the library refuses the
/// options with a message.
fn camera(random: &mut Random, counts: &mut Counts) -> Option<(*mut realistic_camera, bool)> {
    let mut options = realistic_options { xres: PIXELS, yres: PIXELS, ..realistic_options::default() };
    let mut given = Parameters::default();
    for (name, value) in any_parameters::any_parameters(&mut || random.random()) {
        given.set_from_text(name, &value).expect("a parameter");
    }
    let text = lens_text(random);
    const LENSES: [&str; 5] = ["dgauss.50mm", "dgauss.100mm", "wide.22mm", "telephoto.250mm", "fisheye.10mm"];
    let name = LENSES[random.random_range(0..LENSES.len())];
    let name = match random.random_range(0..4_u8) {
        0 => format!("{name}@{}mm", scaled(random, 1e-3, 1e5)),
        _ => name.to_owned(),
    };
    given.film_diagonal.get_or_insert(scaled(random, 5.0, 60.0));
    if random.random_bool(0.5) {
        options.lens_text = text.as_ptr().cast();
        options.lens_text_size = text.len();
        if given.focus_distance.is_none() {
            given.film_distance.get_or_insert(scaled(random, 0.1, 300.0));
        }
    } else {
        given.lens_file = Some(name);
    }
    let mut texts = Vec::new();
    let keep = |text: String| {
        let text = CString::new(text)?;
        let pointer = text.as_ptr();
        texts.push(text);
        Ok::<_, NulError>(pointer)
    };
    options.fill(&given, keep).expect("no NUL");
    if random.random_bool(0.3) {
        for entry in &mut options.camera_to_world[..12] {
            *entry += random.random_range(-0.4..0.4);
        }
    }
    if random.random_bool(0.2) {
        options.camera_to_world_end = options.camera_to_world;
        options.camera_to_world_end[3] += 1.0;
    }
    let mut camera = null_mut();
    // SAFETY: the options and the texts live during the call.
    let status = unsafe { realistic_camera_new(&options, &mut camera) };
    if status == realistic_status::Ok {
        counts.cameras[0] += 1;
        return Some((camera, !(options.tolerance > 0.0)));
    }
    counts.cameras[1] += 1;
    // SAFETY: the message lives until this thread's next failure.
    let message = unsafe { CStr::from_ptr(realistic_last_error()) };
    if status == realistic_status::Panic || message.count_bytes() < 10 {
        counts.violation(format!("{status:?}: {message:?} {options:?} {text:?}"));
    }
    None
}

/// Checks the promises on one batch.
fn check(
    (camera, same_bits): (*const realistic_camera, bool),
    arrays: &Arrays,
    with_reasons: bool,
    counts: &mut Counts,
) {
    for i in 0..BATCH {
        let (ray, weight) = arrays.ray(i);
        counts.passed += u64::from(weight > 0.0);
        if let Some(broken) = contract::broken(&arrays.sample(i), &ray, weight, &MARK) {
            counts.violation(broken);
        }
        if with_reasons {
            let reason = arrays.reasons[i] as i32;
            *counts.reasons.entry(reason).or_default() += 1;
            if (reason == 0) != (weight > 0.0) {
                counts.violation(format!("reason {reason} with weight {weight}: {:?}", arrays.sample(i)));
            }
        }
    }
    for i in (0..BATCH).step_by(BATCH / SINGLES) {
        let (sample, mut ray) = (arrays.sample(i), MARK);
        // SAFETY: the camera, the sample and the ray are live.
        let weight = unsafe { realistic_generate_ray(camera, &sample, null(), &mut ray) };
        if let Some(broken) = contract::broken(&sample, &ray, weight, &MARK) {
            counts.violation(broken);
        }
        if same_bits && (ray, weight) != arrays.ray(i) {
            counts.violation(format!(
                "one by one {ray:?} {weight}, in a batch {:?}: {sample:?}",
                arrays.ray(i)
            ));
        }
    }
}

/// Resident memory of this process, bytes; 0 if the system does not report it.
fn memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// Requests `rays` rays or a few more; `progress` receives the counts so far after each camera.
pub fn soak(rays: u64, seed: u64, mut progress: impl FnMut(&Counts)) -> Counts {
    let mut random = Random::seed_from_u64(seed);
    let (mut counts, mut arrays) = (Counts::default(), Arrays::new());
    while counts.rays < rays {
        let Some((camera, same_bits)) = camera(&mut random, &mut counts) else { continue };
        for call in 0..CALLS {
            arrays.fill(&mut random);
            let with_reasons = call == 0;
            let status = arrays.trace(camera, with_reasons);
            if status != realistic_status::Ok {
                counts.violation(format!("a batch ended with {status:?}"));
            }
            check((camera, same_bits), &arrays, with_reasons, &mut counts);
            counts.rays += BATCH as u64;
        }
        // SAFETY: no call uses the camera any more.
        unsafe { realistic_camera_free(camera) };
        if counts.memory[0] == 0 && counts.rays >= rays / 10 {
            counts.memory[0] = memory();
        }
        progress(&counts);
    }
    counts.memory[1] = memory();
    counts
}

#[cfg_attr(test, allow(dead_code, reason = "the test of this file calls what this calls"))]
fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<f64>());
    let (rays, seed) = match (arguments.next().unwrap_or(Ok(1e9)), arguments.next().unwrap_or(Ok(1.0))) {
        (Ok(rays), Ok(seed)) => (rays as u64, seed as u64),
        _ => {
            eprintln!("soak: give the number of rays and a seed, two numbers");
            return std::process::ExitCode::from(2);
        }
    };
    let start = Instant::now();
    let mut reported = 0;
    let counts = soak(rays, seed, |counts| {
        if counts.rays / 100_000_000 > reported {
            reported = counts.rays / 100_000_000;
            eprintln!(
                "{:.0} s: {} rays, {} violations",
                start.elapsed().as_secs_f64(),
                counts.rays,
                counts.violations
            );
        }
    });
    println!("seed        {seed}\n{counts}");
    std::process::ExitCode::from(u8::from(counts.violations > 0))
}
