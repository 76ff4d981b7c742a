//! Any options are a camera that answers in numbers, or an error with a message; nothing breaks.

use std::ffi::CStr;
use std::ptr::{null, null_mut};

use realistic::abi::*;

/// Reads values off the front of the data; zeros where it ends.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N.min(self.0.len()));
        self.0 = rest;
        let mut taken = [0; N];
        taken[..head.len()].copy_from_slice(head);
        taken
    }

    fn choice(&mut self, count: usize) -> usize {
        usize::from(self.take::<1>()[0]) % count
    }

    /// Not given, a plain value of everyday size, or any bits at all.
    fn number(&mut self) -> f64 {
        match self.choice(32) {
            0..26 => f64::NAN,
            26..30 => f64::from(u16::from_le_bytes(self.take())) / 64.0,
            30 => [0.0, -1.0, f64::INFINITY, 1e-300, 1e300, 1e30, 1e-30, 5e-324][self.choice(8)],
            _ => f64::from_bits(u64::from_le_bytes(self.take())),
        }
    }

    fn float(&mut self, scale: f32) -> f32 {
        match self.choice(4) {
            0..3 => scale * f32::from(u16::from_le_bytes(self.take())) / 65535.0,
            _ => f32::from_bits(u32::from_le_bytes(self.take())),
        }
    }
}

/// Panics where the library breaks its word. True where the data give a camera.
pub fn run(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let mut options = realistic_options::default();
    let mut texts = |choices: &[&'static CStr]| match bytes.choice(2 * choices.len()) {
        i if i < choices.len() => choices[i].as_ptr(),
        _ => std::ptr::null(),
    };
    options.specfile =
        texts(&[c"wide.22mm", c"telephoto.250mm", c"fisheye.10mm@1e9mm", c"dgauss.100mm", c"@mm"]);
    options.weighting = texts(&[c"radiometric", c"assignment", c"relative", c"none", c"?"]);
    options.pupil = texts(&[c"rear", c"disk", c""]);
    options.disk = texts(&[c"concentric", c"polar", c"rejection", c"\xFF"]);
    options.refraction = texts(&[c"fused", c"heckbert", c"whitted", c"other"]);
    options.precision = texts(&[c"f64", c"f32"]);
    options.shutter = texts(&[c"global", c"leaf", c"focal-plane", c"slow"]);
    (options.xres, options.yres) = match bytes.choice(4) {
        0 => (i32::from_le_bytes(bytes.take()), i32::from_le_bytes(bytes.take())),
        _ => (40, 30),
    };
    options.simpleweighting = [-1, -1, -1, 0, 1, 2][bytes.choice(6)];
    for number in [
        &mut options.filmdistance,
        &mut options.focusdistance,
        &mut options.aperture_diameter,
        &mut options.fnumber,
        &mut options.filmdiag,
        &mut options.hither,
        &mut options.yon,
        &mut options.shutteropen,
        &mut options.shutterclose,
        &mut options.wavelength,
        &mut options.mmperunit,
    ] {
        *number = bytes.number();
    }
    if bytes.choice(4) == 0 {
        const MODELS: [&CStr; 7] =
            [c"thick", c"thin", c"perspective", c"orthographic", c"environment", c"lens", c"pinhole"];
        options.model = MODELS[bytes.choice(MODELS.len())].as_ptr();
        options.lensplane = [null(), c"eye".as_ptr(), c"hither".as_ptr()][bytes.choice(3)];
        let [from_x, to_x, from_y, to_y] = &mut options.screenwindow;
        let window = [from_x, to_x, from_y, to_y];
        let others = [
            &mut options.fov,
            &mut options.frameaspectratio,
            &mut options.lensradius,
            &mut options.focaldistance,
        ];
        for number in window.into_iter().chain(others) {
            *number = bytes.number();
        }
    }
    for number in [&mut options.tolerance, &mut options.shutterramp, &mut options.shutterslit] {
        *number = bytes.number();
    }
    if bytes.choice(8) == 0 {
        for entry in &mut options.camera_to_world[..12] {
            *entry = bytes.float(4.0);
        }
    }
    if bytes.choice(8) == 0 {
        (options.transformstart, options.transformend) = (bytes.number(), bytes.number());
        options.camera_to_world_end = options.camera_to_world;
        for entry in &mut options.camera_to_world_end[..12] {
            *entry += bytes.float(1.0);
        }
    }
    let has_text = bytes.choice(2) == 1;
    let samples: Vec<realistic_sample> = (0..16)
        .map(|_| realistic_sample {
            image_x: bytes.float(40.0),
            image_y: bytes.float(30.0),
            lens_u: bytes.float(1.0),
            lens_v: bytes.float(1.0),
            // What is no time in [0, 1] makes no time between the shutter's.
            time: f32::from(bytes.take::<1>()[0]) / 255.0,
        })
        .collect();
    let text = bytes.0;
    if has_text {
        options.lens_text = text.as_ptr().cast();
        options.lens_text_size = text.len();
    }

    let mut camera = null_mut();
    // SAFETY: the options and all that they point to live during the call; so does `camera`.
    let status = unsafe { realistic_camera_new(&options, &mut camera) };
    // SAFETY: the message lives until this thread's next failure.
    let message = unsafe { CStr::from_ptr(realistic_last_error()) }.to_string_lossy();
    assert_ne!(status, realistic_status::Panic, "{message} {options:?}");
    if status != realistic_status::Ok {
        assert!(camera.is_null() && message.len() > 10, "{message} {options:?}");
        return false;
    }
    let tame = options.camera_to_world.iter().all(|entry| entry.abs() < 1e20);
    let mark = realistic_ray { mint: -7.0, ..Default::default() };
    let mut rays = [mark; 16];
    let mut weights = [0.0; 16];
    // SAFETY: a live camera, and arrays of sixteen.
    let status = unsafe {
        let (rays, weights) = (rays.as_mut_ptr(), weights.as_mut_ptr());
        realistic_camera_generate_rays(camera, 16, samples.as_ptr(), 0, rays, 0, weights, null_mut())
    };
    assert_eq!(status, realistic_status::Ok);
    for ((sample, ray), weight) in samples.iter().zip(&rays).zip(weights) {
        let mut single = mark;
        // SAFETY: a live camera, sample and ray.
        let other = unsafe { realistic_generate_ray(camera, sample, &mut single) };
        // A tolerance may have one tracer for single calls and one for batches.
        let within_a_tolerance = options.tolerance > 0.0;
        assert!(within_a_tolerance || (other, single) == (weight, *ray), "{ray:?} {single:?}");
        assert!(weight >= 0.0 && weight.is_finite(), "{weight} {sample:?} {options:?}");
        if weight == 0.0 {
            assert_eq!(*ray, mark);
            continue;
        }
        // A transform may carry an origin out of the range of floats; nothing else may.
        let origin: &[f32] = if tame { &ray.o } else { &[] };
        let finite = origin.iter().chain(&ray.d).chain([&ray.mint, &ray.time]).all(|x| x.is_finite());
        let length = ray.d.iter().map(|&d| f64::from(d).powi(2)).sum::<f64>();
        // Eight roundings, of which polynomials in single precision need five; the stock cameras take a transform
        // that is rigid to 1e-5 for a rigid one.
        let most = if options.model.is_null() { 8.0 * f64::from(f32::EPSILON) } else { 3e-5 };
        let is_unit = (length - 1.0).abs() < most;
        assert!(finite && ray.maxt >= ray.mint && is_unit, "{ray:?} {options:?}");
    }
    // SAFETY: nobody uses the camera any more.
    unsafe { realistic_camera_free(camera) };
    true
}
