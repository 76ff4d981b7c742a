//! Benchmarks a wavelength per sample against the camera's own wavelength: `cargo bench --bench wavelengths`. It
//! measures batches of random samples over the film and single calls, in both precisions, ns per sample; and the first
//! request.

use std::{hint::black_box, time::Instant};

use realistic_camera::{Camera, Precision, Pupil, Rays, Sample, Samples, WorldRay};
use realistic_lab::columns::{RayAt as _, RayColumns, SampleColumns};
use realistic_lab::{
    subject::quasirandom::spread,
    timing::{BenchArguments, Contest},
};

/// A lens whose glasses are given by two numbers, lenses whose glasses are given by name (Sellmeier's formula), and
/// lenses with aspheres; each with its film diagonal, mm.
const LENSES: [(&str, f64); 4] =
    [("dgauss.100mm", 35.0), ("retrofocus.24mm", 35.0), ("zoom.24-70mm", 35.0), ("phone.4mm", 5.6)];
const N: usize = 2048;

fn main() {
    let arguments = BenchArguments::from_command_line(61);
    for (lens, diagonal) in LENSES.into_iter().filter(|(lens, _)| arguments.wants(lens)) {
        for precision in [Precision::F64, Precision::F32] {
            for pupil in [Pupil::Warped, Pupil::Rear] {
                let camera = Camera::builder().lens_file(lens).film_diagonal(diagonal).precision(precision);
                let camera = camera.pupil(pupil).resolution(600, 400).build().expect("built");
                println!("\n{lens}, {precision}, pupil {pupil}:\n");
                contest(&camera, &arguments);
            }
        }
    }
}

fn contest(camera: &Camera, arguments: &BenchArguments) {
    let mut samples = SampleColumns::new(N);
    let mut wavelengths = [0.0; N];
    for (i, [x, y, u, v, wave, time]) in spread::<6>(0.0).take(N).enumerate() {
        let [image_x, image_y] = [600.0 * x as f32, 400.0 * y as f32];
        let [lens_u, lens_v, time] = [u, v, time].map(|number: f64| number as f32);
        samples.set(i, &Sample { image_x, image_y, lens_u, lens_v, time });
        wavelengths[i] = 380.0 + 400.0 * wave as f32;
    }
    let first = Instant::now();
    camera.ray_at(&samples.get(0), 500.0);
    let first = first.elapsed();
    let [mut own, mut at] = [RayColumns::new(N), RayColumns::new(N)];
    let (samples, wavelengths) = (&samples, &wavelengths);
    let mut many = Contest::default();
    many.enter(
        "batch, the camera's wavelength",
        task(move || camera.trace(&samples.first(N), &mut own.first(N))),
    );
    many.enter(
        "batch, a wavelength each",
        task(move || camera.trace(&samples.first(N).at(wavelengths), &mut at.first(N))),
    );
    many.enter("batch with differentials, the camera's wavelength", {
        let mut rooms: [_; 3] = std::array::from_fn(|_| RayColumns::new(N));
        task(move || {
            let [rays, rx, ry] = &mut rooms;
            let mut rays = rays.all().with_neighbours([rx.neighbours(), ry.neighbours()]);
            camera.trace(&samples.all(), &mut rays);
        })
    });
    many.enter("batch with differentials, a wavelength each", {
        let mut rooms: [_; 3] = std::array::from_fn(|_| RayColumns::new(N));
        task(move || {
            let [rays, rx, ry] = &mut rooms;
            let mut rays = rays.all().with_neighbours([rx.neighbours(), ry.neighbours()]);
            camera.trace(&samples.all().at(wavelengths), &mut rays);
        })
    });
    many.enter(
        "four wavelengths each, per ray",
        task(move || {
            for (i, four) in wavelengths.chunks_exact(4).enumerate() {
                let (mut rays, mut weights) = ([WorldRay::default(); 4], [0.0; 4]);
                let sample = samples.get(i);
                camera.trace(&Samples::of(&sample).at(four), &mut Rays::structs(&mut rays, &mut weights));
                black_box((rays, weights));
            }
        }),
    );
    many.enter("one by one, the camera's wavelength", {
        task(move || (0..N).for_each(|i| _ = black_box(camera.ray(&samples.get(i)))))
    });
    many.enter("one by one, a wavelength each", {
        task(move || {
            (0..N).for_each(|i| _ = black_box(camera.ray_at(&samples.get(i), wavelengths[i])));
        })
    });
    let times = many.print("ns per sample", N, arguments.effort);
    println!(
        "\nA wavelength each is {:.2} of one, with differentials {:.2}; the first request took {:.1} ms.",
        times[1].median / times[0].median,
        times[3].median / times[2].median,
        1e3 * first.as_secs_f64()
    );
}

fn task<'a>(task: impl FnMut() + 'a) -> Box<dyn FnMut() + 'a> {
    Box::new(task)
}
