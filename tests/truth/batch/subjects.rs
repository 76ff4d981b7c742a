//! Cameras for every path through the code, and samples at which such paths differ.

use std::ffi::CStr;
use std::ptr::null;

use realistic::ffi::*;

use super::{Random, single};
use crate::support::abi_camera::{Camera, camera};

/// A camera with its samples.
pub struct Subject {
    pub name: &'static str,
    pub camera: Camera,
    /// The same camera with its shutter open, if it has a shutter, to check a ray's neighbours.
    open: Option<Camera>,
    edges: Vec<realistic_sample>,
    passing: Vec<realistic_sample>,
}

impl Subject {
    fn new(name: &'static str, camera: Camera, open: Option<Camera>) -> Self {
        let edges = beside_edges(&camera);
        let mut passing = samples(1000);
        passing.retain(|sample| single(&camera, sample, None).1 > 0.0);
        Self { name, camera, open, edges, passing }
    }

    /// Returns the camera of a ray's neighbours.
    pub fn open(&self) -> &Camera {
        self.open.as_ref().unwrap_or(&self.camera)
    }

    /// Returns samples of one kind: anywhere, along a radius, at tabulated radii, beside edges of apertures, or
    /// passing.
    pub fn samples(&self, n: usize, random: &mut Random) -> Vec<realistic_sample> {
        let pool = match (6.0 * random.next()) as usize {
            0 => along_the_radius(),
            1 => at_tabulated_radii(),
            2 if !self.edges.is_empty() => self.edges.clone(),
            3 if !self.passing.is_empty() => self.passing.clone(),
            _ => samples(1000),
        };
        let first = (random.next() * pool.len() as f64) as usize;
        pool.iter().cycle().skip(first).take(n).copied().collect()
    }
}

pub fn subjects() -> Vec<Subject> {
    type Set = fn(&mut realistic_options);
    const TURNED: [f32; 16] =
        [0.6, 0.0, 0.8, 3.0, 0.0, 2.0, 0.0, -1.0, -0.8, 0.0, 0.6, 5.0, 0.0, 0.0, 0.0, 1.0];
    let plain = |name: &'static str, set: Set| Subject::new(name, camera(set), None);
    // The lens's glasses have V-numbers.
    let dispersive = |set: Set| {
        camera(|options| {
            options.lens_file = c"dgauss.100mm".as_ptr();
            set(options);
        })
    };
    let lens = |name, file: &CStr, film, precision: &CStr| {
        let camera = camera(|options| {
            (options.lens_file, options.film_diagonal) = (file.as_ptr(), film);
            (options.precision, options.zoom) =
                (precision.as_ptr(), if name == "zoom" { c"45".as_ptr() } else { null() });
        });
        Subject::new(name, camera, None)
    };
    vec![
        plain("default", |_| ()),
        plain("rear", |o| o.pupil = c"rear".as_ptr()),
        plain("placed", |o| o.camera_to_world = TURNED),
        plain("moving", |o| o.camera_to_world_end = TURNED),
        plain("single", |o| o.precision = c"f32".as_ptr()),
        plain("walked", |o| o.refraction = c"whitted".as_ptr()),
        plain("fisheye", |o| o.lens_file = c"fisheye.10mm".as_ptr()),
        plain("redrawn", |o| o.disk = c"rejection".as_ptr()),
        plain("bare", |o| o.transmission = c"bare".as_ptr()),
        plain("ghosts", |o| (o.transmission, o.ghosts) = (c"quarter-wave".as_ptr(), 0.4)),
        plain("polar", |o| o.disk = c"polar".as_ptr()),
        // Single calls and batches use the same model.
        plain("tolerant", |o| (o.lens_file, o.fnumber, o.tolerance) = (c"dgauss.100mm".as_ptr(), 16.0, 1.0)),
        plain("thin", |o| o.model = c"thin".as_ptr()),
        plain("environment", |o| o.model = c"environment".as_ptr()),
        plain("perspective", |o| o.model = c"perspective".as_ptr()),
        Subject::new("slit", camera(|o| o.shutter = c"focal-plane".as_ptr()), Some(camera(|_| ()))),
        Subject::new("leaf", camera(|o| o.shutter = c"leaf".as_ptr()), Some(camera(|_| ()))),
        lens("aspheres", c"phone.4mm", 6.0, c"f64"),
        lens("single aspheres", c"phone.4mm", 6.0, c"f32"),
        lens("zoom", c"zoom.24-70mm", 35.0, c"f64"),
        Subject::new("dispersive", dispersive(|_| ()), None),
        Subject::new("dispersive single", dispersive(|o| o.precision = c"f32".as_ptr()), None),
        Subject::new("dispersive rear", dispersive(|o| o.pupil = c"rear".as_ptr()), None),
        Subject::new("dispersive walked", dispersive(|o| o.refraction = c"heckbert".as_ptr()), None),
        Subject::new(
            "dispersive slit",
            dispersive(|o| o.shutter = c"focal-plane".as_ptr()),
            Some(dispersive(|_| ())),
        ),
    ]
}

/// Returns samples all over the film and its margin, and some far outside it, with values of 0 and 1, and NaN.
fn samples(n: usize) -> Vec<realistic_sample> {
    let mut random = Random::new(5);
    let mut number = || ((1.02 * random.next() - 0.01) as f32).clamp(0.0, 1.0);
    let mut samples: Vec<_> = (0..n)
        .map(|_| realistic_sample {
            image_x: 46.0 * number() - 3.0,
            image_y: 36.0 * number() - 3.0,
            lens_u: number(),
            lens_v: number(),
            time: number(),
        })
        .collect();
    samples.iter_mut().skip(5).step_by(9).for_each(|sample| sample.image_x *= 2.0);
    samples.iter_mut().skip(7).step_by(101).for_each(|sample| sample.lens_u = f32::NAN);
    samples.iter_mut().skip(11).step_by(103).for_each(|sample| sample.image_x = f32::NAN);
    samples
}

/// Returns samples on the axis, and at many radii near it.
fn along_the_radius() -> Vec<realistic_sample> {
    let mut samples = samples(400);
    for (i, sample) in samples.iter_mut().enumerate() {
        sample.image_y = 15.0;
        sample.image_x = 20.0 + (i as f32 - 100.0) / 16.0;
    }
    samples[0].image_x = 20.0;
    samples
}

/// Returns samples at the radii that pupil tables may have, 64ths of the farthest radius and their square roots, and
/// one float to either side of each; also samples whose neighbour to the right is at such a radius.
fn at_tabulated_radii() -> Vec<realistic_sample> {
    // The farthest point, in pixels of the 40 x 30 film: its corner, and three pixels in each direction for a host's
    // filter.
    let farthest = 25.0 + 3.0 * std::f64::consts::SQRT_2;
    let parts = (0..=64).map(|k| f64::from(k) / 64.0);
    let radii = parts.flat_map(|part| [part, part.sqrt()]).map(|part| part * farthest);
    let at = radii.map(|radius| (20.0 + radius) as f32);
    let beside = at.flat_map(|x| [x.next_down(), x, x.next_up()]).flat_map(|x| [x, x - 1.0]);
    let lens = samples(97).into_iter().cycle();
    beside.zip(lens).map(|(image_x, sample)| realistic_sample { image_x, image_y: 15.0, ..sample }).collect()
}

/// Returns samples at the last float inside the edge of an aperture and the first float outside, along rows of the
/// film; also samples whose neighbour to the right is at such a point.
fn beside_edges(camera: &Camera) -> Vec<realistic_sample> {
    let mut found = Vec::new();
    for sample in samples(80).into_iter().filter(|sample| sample.image_x.is_finite()) {
        let at = |image_x| realistic_sample { image_x, ..sample };
        let passes = |x| single(camera, &at(x), None).1 > 0.0;
        let (mut inside, mut outside) = (20.0, 20.0 + 4.0 * (sample.image_x - 20.0));
        if !passes(inside) || passes(outside) {
            continue;
        }
        loop {
            let middle = f32::midpoint(inside, outside);
            match middle == inside || middle == outside {
                true => break,
                false if passes(middle) => inside = middle,
                false => outside = middle,
            }
        }
        found.extend([inside, outside, inside - 1.0, outside - 1.0].map(at));
    }
    found
}
