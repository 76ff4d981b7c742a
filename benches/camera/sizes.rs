//! Time per ray in batches of few samples, whose number is seldom a multiple of the vector width, compared with the
//! time in batches of the next multiple.

use realistic_lab::timing::{Effort, interleaved};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::catalogue,
};

use super::{
    MIDDLE, SAMPLES,
    c_camera::{Arrays, samples},
    camera,
};

/// Pairs of batch sizes whose times per ray are compared: a vector of four plus one sample against the vector, a group
/// of vectors minus one sample against the group, and few samples against many.
const PAIRS: [[usize; 2]; 3] = [[5, 4], [31, 32], [16, 1024]];

/// Prints one row per lens and precision, on a film whose size follows the lens's focal length so that every lens
/// illuminates it.
pub fn print(effort: Effort) {
    println!("\n## Batches of few samples: ns per ray, arrays\n");
    print!("| lens | precision ");
    PAIRS.iter().for_each(|[n, beside]| print!("| n = {n} | n = {beside} | ratio "));
    println!("|\n|---|---{}|", "|---|---|---".repeat(PAIRS.len()));
    let samples = samples(SAMPLES, MIDDLE);
    for name in catalogue::round() {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let film = (0.8 * FirstOrder::of(&lens).expect("focal").focal_length).min(35.0);
        for precision in [c"f64", c"f32"] {
            let camera = camera(name, |options| {
                options.film_diagonal = film;
                options.precision = precision.as_ptr();
            });
            let camera = &camera;
            print!("| {name} | {} ", precision.to_str().expect("ASCII"));
            for sizes in PAIRS {
                let tasks = sizes.map(|n| -> Box<dyn FnMut()> {
                    let mut arrays = Arrays::new(&samples);
                    Box::new(move || arrays.generate_by(camera, n, false))
                });
                let [own, other] = <[_; 2]>::try_from(interleaved(tasks, effort))
                    .expect("two tasks")
                    .map(|time| time.median);
                let per_ray = |time: f64| time * 1e9 / SAMPLES as f64;
                print!("| {:.2} | {:.2} | {:.2} ", per_ray(own), per_ray(other), own / other);
            }
            println!("|");
        }
    }
}
