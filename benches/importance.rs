//! Benchmarks the evaluation of importance, compared with the generation of a camera's own rays: `cargo bench --bench
//! importance -- [LENS…]`.

use std::{env::args, hint::black_box, time::Duration};

use realistic_camera::{Aimed, Camera, Host, Importance, Parameters, Raster, Sample, ScenePoint, WorldRay};
use realistic_lab::columns::{RayColumns, SampleColumns};
use realistic_lab::timing::{Effort, interleaved, repeated};

/// Rays per batch.
const N: usize = 1024;
const EFFORT: Effort = Effort { rounds: 15, least: Duration::from_millis(4) };

fn camera(lens: &str) -> Camera {
    let mut parameters = Parameters::default();
    parameters.set_from_text("lens_file", lens).expect("a text");
    let host = Host::new(Raster { xres: 640, yres: 480 }, None);
    Camera::build(&parameters, &host, &mut |_, _| ()).unwrap_or_else(|error| panic!("{lens}: {error}"))
}

/// Returns samples all over picture and pupil.
fn samples() -> Vec<Sample> {
    let at = |i: usize, step: f64| (0.5 + i as f64 * step).fract() as f32;
    (0..N)
        .map(|i| Sample {
            image_x: 640.0 * at(i, 0.856_674_883_9),
            image_y: 480.0 * at(i, 0.733_891_856_6),
            lens_u: at(i, 0.628_706_721),
            lens_v: at(i, 0.538_597_257_2),
            time: 0.5,
        })
        .collect()
}

fn main() {
    let lenses: Vec<String> = args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let lenses =
        if lenses.is_empty() { ["dgauss.50mm", "fisheye.10mm"].map(str::to_owned).into() } else { lenses };
    println!("| lens | its rays, ns | the other way, ns | ratio | directions, ns | ratio | table, ms |");
    println!("|---|---|---|---|---|---|---|");
    for lens in &lenses {
        row(lens);
    }
}

fn row(lens: &str) {
    let camera = camera(lens);
    let adjoint = camera.adjoint().expect("a lens has importance");
    let samples = samples();
    let columns = SampleColumns::of(&samples);
    let rays: Vec<WorldRay> = samples
        .iter()
        .filter_map(|sample| camera.ray(sample))
        .map(|(ray, _)| WorldRay { direction: ray.direction.map(|part| -part), ..ray })
        .collect();
    let points: Vec<ScenePoint> = rays
        .iter()
        .zip(&samples)
        .map(|(ray, sample)| ScenePoint {
            point: [0, 1, 2].map(|axis| ray.origin[axis] - 5000.0 * ray.direction[axis]),
            sample: [sample.lens_u, sample.lens_v],
            time: 0.5,
        })
        .collect();
    let (mut counted, mut aimed) =
        (vec![Importance::default(); rays.len()], vec![Aimed::default(); rays.len()]);
    let mut first = [Aimed::default()];
    let (_, table) = repeated(1, || adjoint.aim(&points[..1], &mut first));
    let mut found = RayColumns::new(N);
    let times = interleaved(
        [
            Box::new(|| {
                camera.trace(&black_box(&columns).all(), &mut found.all());
            }) as Box<dyn FnMut()>,
            Box::new(|| adjoint.arrive(black_box(&rays), &mut counted)),
            Box::new(|| adjoint.aim(black_box(&points), &mut aimed)),
        ],
        EFFORT,
    );
    let own = times[0].per(N).median * 1e9;
    let [back, aim] = [1, 2].map(|i| times[i].per(rays.len()).median * 1e9);
    println!(
        "| {lens} | {own:.1} | {back:.1} | {:.1} | {aim:.1} | {:.1} | {:.0} |",
        back / own,
        aim / own,
        table[0] * 1e3
    );
}
