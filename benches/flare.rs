//! Benchmarks light inside the lens: `cargo bench --bench flare`. It measures the time of a lamp's ghosts from all
//! pairs of surfaces, without splatting them on a film, ms; the times of a camera's batches with `transmission`, with
//! `ghosts` and plain, ns per ray; and the relative cost of `transmission` in a batch, for every lens of the catalogue.

use std::hint::black_box;

use realistic_camera::{Camera, Precision, Raster, Transmission};
use realistic_lab::columns::RayColumns;
use realistic_lab::timing::{BenchArguments, Contest, camera_calls::samples, clock, interleaved};
use realistic_light::{GhostSpectrum, Lamp};
use realistic_optics::{
    lens::Lens,
    prescription::{Coating, catalogue},
};

const LENSES: [&str; 3] = ["dgauss.50mm", "planar.50mm", "retrofocus.24mm"];
const N: usize = 4096;
/// Cells along a side of a grid, and number of wavelengths.
const SIDE: usize = 64;
const WAVELENGTHS: u32 = 16;

fn main() {
    let arguments = BenchArguments::from_command_line(61);
    for name in LENSES.into_iter().filter(|lens| arguments.wants(lens)) {
        println!("\n{name}:\n");
        lamp(name, if arguments.effort.rounds > 1 { 5 } else { 1 });
        println!();
        cameras(name, &arguments);
    }
    println!("\n| lens | f64, ns | more | f32, ns | more |\n|---|---|---|---|---|");
    for name in catalogue::round().filter(|lens| arguments.wants(lens)) {
        shares(name, &arguments);
    }
}

/// Prints the relative cost of `transmission` in a batch, in each precision: the medians over rounds in which the two
/// cameras take turns. Films are 36 mm from corner to corner, or as wide as the lens's image.
fn shares(name: &str, arguments: &BenchArguments) {
    let film_diagonal = match name {
        "phone.4mm" => 6.0,
        "fisheye.6mm" => 20.0,
        _ => 36.0,
    };
    let samples = &samples(N, Raster { xres: 600, yres: 400 }, 0.0);
    let cells = [Precision::F64, Precision::F32].map(|precision| {
        let camera = |transmission| {
            let camera =
                Camera::builder().lens_file(name).film_diagonal(film_diagonal).transmission(transmission);
            camera.precision(precision).resolution(600, 400).build().expect("built")
        };
        let cameras = [Transmission::None, Transmission::QuarterWave].map(camera);
        let tasks = cameras.iter().map(|camera| {
            let mut rays = RayColumns::new(N);
            Box::new(move || camera.trace(&samples.first(N), &mut rays.first(N))) as Box<dyn FnMut()>
        });
        let [plain, lit] = &interleaved(tasks, arguments.effort)[..] else { panic!("two tasks") };
        format!("{:.1} | {:.1} %", 1e9 * plain.median / N as f64, 100.0 * (lit.median / plain.median - 1.0))
    });
    println!("| {name} | {} |", cells.join(" | "));
}

/// Prints the CPU time of a lamp's ghosts, the minimum over some rounds.
fn lamp(name: &str, rounds: u32) {
    let prescription = catalogue::find(name).expect("listed");
    let lamp = Lamp::Distant([0.25, 0.1, 1.0]);
    let width = 260.0 / f64::from(WAVELENGTHS);
    let wavelengths: Vec<f64> = (0..WAVELENGTHS).map(|i| 420.0 + width * (f64::from(i) + 0.5)).collect();
    let (lens, mut least) = (Lens::at_d_line(&prescription), f64::INFINITY);
    let film = lens.rear().vertex - lens.nominal_film_distance.unwrap_or(36.0);
    let coatings = vec![Coating::QuarterWave.into(); lens.surfaces.len()];
    let (mut sprays, mut watts) = (0, 0.0);
    for _ in 0..rounds {
        let start = clock::now();
        (sprays, watts) = (0, 0.0);
        let lens_at = |nm| Lens::new(&prescription, nm);
        let ghosts = GhostSpectrum::new(&wavelengths, lens_at, &coatings, film);
        for pair in ghosts.pairs() {
            ghosts.sprays(Some(pair), lamp, SIDE, |_, spray| {
                sprays += 1;
                watts += spray.watts();
            });
        }
        least = least.min((clock::now() - start).as_secs_f64());
    }
    let each = 1e9 * least / (sprays * SIDE * SIDE) as f64;
    println!(
        "a lamp's ghosts, {sprays} pairs and wavelengths of {SIDE} x {SIDE} cells: {:.0} ms, {each:.0} ns per cell ({:.4e} W)",
        1e3 * least,
        black_box(watts)
    );
}

/// Prints the times of batches of rays of three cameras.
fn cameras(name: &str, arguments: &BenchArguments) {
    let camera = |transmission, ghosts| {
        let camera = Camera::builder().lens_file(name).film_diagonal(35.0).transmission(transmission);
        camera.ghosts(ghosts).resolution(600, 400).build().expect("built")
    };
    let cameras = [
        ("batch", camera(Transmission::None, 0.0)),
        ("batch, transmission", camera(Transmission::QuarterWave, 0.0)),
        ("batch, ghosts of a tenth", camera(Transmission::QuarterWave, 0.1)),
    ];
    let samples = &samples(N, Raster { xres: 600, yres: 400 }, 0.0);
    let mut many = Contest::default();
    for (name, camera) in &cameras {
        let mut rays = RayColumns::new(N);
        let task = move || camera.trace(&samples.first(N), &mut rays.first(N));
        many.enter(*name, Box::new(task) as Box<dyn FnMut()>);
    }
    many.print("ns per sample", N, arguments.effort);
}
