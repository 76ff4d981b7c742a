//! Benchmarks the overhead of the C ABI for a lens. It compares rays through `realistic_lens_trace` with the kernel
//! alone, and calls that return the intersections on every surface with calls that do not. It traces in batches and ray
//! by ray, from both sides.
//!
//! `cargo bench --bench lens` (with `-- dgauss`, one lens). The figures are medians over interleaved rounds in thread
//! CPU time.

use std::{
    ffi::CString,
    hint::black_box,
    ptr::{null, null_mut},
};

use realistic::ffi::*;
use realistic_lab::{
    subject::quasirandom::spread,
    timing::{BenchArguments, Effort, interleaved},
};
use realistic_optics::{
    lens::Lens,
    prescription::catalogue,
    trace::{Direction, Path},
};
use realistic_simd::Simd;
use realistic_trace::kernel::{Kernel, RayBuffer};

const LENSES: [&str; 4] = ["dgauss.50mm", "wide.22mm", "fisheye.10mm", "phone.4mm"];
/// Rays per batch, and per block of the kernel alone.
const BATCH: usize = 1024;
const BLOCK: usize = 256;

fn main() {
    let arguments = BenchArguments::from_command_line(31);
    println!("instructions: {}", Simd::best().name());
    println!(
        "\n| lens | from | kernel alone | trace, n = {BATCH} | ratio | trace, n = 1 | with points, n = {BATCH} | points \
         beside trace |\n|---|---|---|---|---|---|---|---|"
    );
    for name in LENSES.into_iter().filter(|name| arguments.wants(name)) {
        for from in [realistic_side::Scene, realistic_side::Film] {
            row(name, from, arguments.effort);
        }
    }
}

/// Prints one line of the table, ns per ray.
fn row(name: &str, from: realistic_side, effort: Effort) {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let (side, direction) = match from {
        realistic_side::Scene => ("scene", Direction::SceneToFilm),
        realistic_side::Film => ("film", Direction::FilmToScene),
    };
    let rays = passing(&lens, direction);
    let mut many = Opened::new(name, lens.surfaces.len(), &rays);
    let [mut single, mut points] = [(); 2].map(|()| Opened::new(name, lens.surfaces.len(), &rays));
    let kernel = Kernel::<f64>::new(&lens, direction);
    let mut buffer = RayBuffer::new(BLOCK);
    let alone = || {
        for block in rays.chunks(BLOCK) {
            for (i, (origin, direction)) in block.iter().enumerate() {
                buffer.put(i, *origin, *direction);
            }
            kernel.trace_in_place(&mut buffer.part(0..block.len()));
            black_box(&buffer);
        }
    };
    let tasks: [Box<dyn FnMut() + '_>; 4] = [
        Box::new(alone),
        Box::new(|| many.trace(from, BATCH)),
        Box::new(|| single.trace(from, 1)),
        Box::new(|| points.trace_points(from)),
    ];
    let times = interleaved(tasks, effort).into_iter().map(|time| time.median / BATCH as f64 * 1e9);
    let [alone, many, single, points]: [f64; 4] = times.collect::<Vec<_>>().try_into().expect("four");
    println!(
        "| {name} | {side} | {alone:.1} | {many:.1} | {:.2} | {single:.1} | {points:.1} | {:.2} |",
        many / alone,
        points / many
    );
}

/// Returns rays that pass, spread over the first surface that they meet.
fn passing(lens: &Lens, travel: Direction) -> Vec<([f64; 3], [f64; 3])> {
    let path = Path::<f64>::new(lens, travel, Default::default());
    let (first, toward) = match travel {
        Direction::SceneToFilm => (&lens.surfaces[0], -1.0),
        Direction::FilmToScene => (lens.rear(), 1.0),
    };
    let reach = first.semi_diameter;
    let ray = |cube: [f64; 4]| {
        let [x, y, sx, sy] = cube.map(|number| 2.0 * number - 1.0);
        ([reach * x, reach * y, first.vertex - toward * reach], [0.2 * sx, 0.2 * sy, toward])
    };
    let rays = spread::<4>(0.0).map(ray);
    let passes = |(origin, direction): &([f64; 3], [f64; 3])| {
        path.trace(realistic_optics::trace::Ray { origin: *origin, direction: *direction }).is_ok()
    };
    rays.filter(passes).take(BATCH).collect()
}

/// A lens of the C ABI, with input rays in its form.
struct Opened {
    lens: *mut realistic_lens,
    /// Original points and directions, one array per coordinate.
    given: [Vec<f64>; 6],
    /// Copies of the rays, to be traced in place.
    rays: [Vec<f64>; 6],
    points: [Vec<f64>; 3],
}

impl Opened {
    fn new(name: &str, surfaces: usize, rays: &[([f64; 3], [f64; 3])]) -> Self {
        let name = CString::new(name).expect("a name");
        let options = realistic_options { lens_file: name.as_ptr(), ..Default::default() };
        let mut lens = null_mut();
        // SAFETY: the name lives through the call.
        assert_eq!(unsafe { realistic_lens_new(&options, &mut lens) }, realistic_status::Ok);
        let column = |c: usize| {
            rays.iter().map(|(origin, direction)| if c < 3 { origin[c] } else { direction[c - 3] }).collect()
        };
        let given: [Vec<f64>; 6] = std::array::from_fn(column);
        let points = std::array::from_fn(|_| vec![0.0; rays.len() * surfaces]);
        Self { lens, rays: given.clone(), given, points }
    }

    /// Restores all original rays, and returns the rays from ray `first` on.
    fn restored(&mut self, first: usize) -> realistic_lens_rays {
        if first == 0 {
            self.rays.iter_mut().zip(&self.given).for_each(|(to, from)| to.copy_from_slice(from));
        }
        let [ox, oy, oz, dx, dy, dz] = self.rays.each_mut().map(|column| column[first..].as_mut_ptr());
        let struct_size = size_of::<realistic_lens_rays>() as u32;
        realistic_lens_rays {
            struct_size,
            origin: realistic_vectors::columns([ox, oy, oz]),
            direction: realistic_vectors::columns([dx, dy, dz]),
            reason: null_mut(),
            reason_stride: 0,
            optical_path: null_mut(),
            optical_path_stride: 0,
        }
    }

    /// Traces all rays, `n` per call.
    fn trace(&mut self, from: realistic_side, n: usize) {
        for first in (0..BATCH).step_by(n) {
            let rays = self.restored(first);
            // SAFETY: a live lens and arrays of at least `n` rays.
            unsafe { realistic_lens_trace(self.lens, from as i32, n, &rays, null()) };
        }
        black_box(&self.rays);
    }

    fn trace_points(&mut self, from: realistic_side) {
        let rays = self.restored(0);
        let [x, y, z] = self.points.each_mut().map(|column| column.as_mut_ptr());
        let struct_size = size_of::<realistic_lens_points>() as u32;
        let points = realistic_lens_points {
            struct_size,
            point: realistic_vectors::columns([x, y, z]),
            met: null_mut(),
            met_stride: 0,
        };
        // SAFETY: the lens is live, and the arrays have room for the rays and their points.
        unsafe { realistic_lens_trace(self.lens, from as i32, BATCH, &rays, &points) };
        black_box(&self.points);
    }
}

impl Drop for Opened {
    fn drop(&mut self) {
        // SAFETY: the lens is freed once.
        unsafe { realistic_lens_free(self.lens) }
    }
}
