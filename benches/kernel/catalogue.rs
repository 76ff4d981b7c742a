//! Time of a ray through every lens of the catalogue, in total and per interface: for one ray, and for batches in both
//! precisions with the widest instructions.

use std::hint::black_box;

use realistic_lab::timing::{Effort, interleaved};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::catalogue,
    trace::Direction,
};
use realistic_simd::Simd;
use realistic_trace::kernel::Kernel;

use super::{BATCH, CHAIN, batch, scenes::Scene};

/// Prints one row per lens.
pub fn print(effort: Effort) {
    println!(
        "\n## The catalogue: ns per ray, and per interface\n\n| lens | interfaces | of these aspheres | one ray, f64 | per interface \
         | batch, f64 | per interface | batch, f32 | per interface |\n|---|---|---|---|---|---|---|---|---|"
    );
    let simd = Simd::ALL.into_iter().rfind(|simd| simd.is_available()).expect("portable lanes always are");
    for name in catalogue::round() {
        let scene = scene(name);
        let (double, single) = (scene.film_rays::<f64>(BATCH), scene.film_rays::<f32>(BATCH));
        let counts = [CHAIN, double.count(), single.count()];
        let batches = [batch(&scene.lens, double, simd), batch(&scene.lens, single, simd)];
        let batches = batches.map(|task| task.expect("available"));
        let times = interleaved([one_ray(&scene)].into_iter().chain(batches), effort);
        let interfaces = scene.lens.surfaces.len();
        let aspheres = scene.lens.surfaces.iter().filter(|surface| surface.figure.is_some()).count();
        print!("| {name} | {interfaces} | {aspheres} ");
        for (time, rays) in times.into_iter().zip(counts) {
            let time = time.median * 1e9 / rays as f64;
            print!("| {time:.2} | {:.3} ", time / interfaces as f64);
        }
        println!("|");
    }
}

/// Returns a lens at its first zoom position, focused at infinity, with film points up to the distance from the axis
/// that every lens illuminates.
fn scene(name: &'static str) -> Scene {
    let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
    let optics = FirstOrder::of(&lens).expect("focal");
    Scene { name, film: optics.rear_focal_point, reach: (0.2 * optics.focal_length).min(10.0), lens }
}

/// Measures latency: each ray's film point depends on the previous ray.
fn one_ray(scene: &Scene) -> Box<dyn FnMut()> {
    let kernel = Kernel::<f64>::new(&scene.lens, Direction::FilmToScene);
    let film = scene.film_rays::<f64>(CHAIN);
    Box::new(move || {
        let mut carry = 0.0;
        for i in 0..film.count() {
            let ([x, y], slopes) = film.at_film(i);
            let traced = kernel.trace_one(film.plane, [x + carry, y], slopes);
            carry = traced.map_or(0.0, |ray| ray.direction[2] * 1e-300);
        }
        black_box(carry);
    })
}
