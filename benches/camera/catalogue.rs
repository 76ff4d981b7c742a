//! Time of a camera ray through every lens of the catalogue, in total and per interface: by calls for one sample, and
//! by batches in both precisions.

use realistic_lab::timing::{Effort, interleaved};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::catalogue,
};

use super::{
    MIDDLE, SAMPLES,
    c_camera::{Arrays, chain, moved, samples},
    camera,
};

/// Prints one row per lens, on a film whose size follows its focal length so that every lens illuminates it.
pub fn print(effort: Effort) {
    println!(
        "\n## The catalogue: ns per camera ray, and per interface\n\n| lens | interfaces | of these aspheres | samples that get through \
         | one call, f64 | per interface | batch, f64 | per interface | batch, f32 | per interface |\n\
         |---|---|---|---|---|---|---|---|---|---|"
    );
    let samples = samples(SAMPLES, MIDDLE);
    for name in catalogue::round() {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let film = (0.8 * FirstOrder::of(&lens).expect("focal").focal_length).min(35.0);
        let double = camera(name, |options| options.film_diagonal = film);
        let single = camera(name, |options| {
            options.film_diagonal = film;
            options.precision = c"f32".as_ptr();
        });
        let passing = samples.iter().filter(|sample| double.one(sample) > 0.0).count();
        let one = || chain(&samples, |sample, carry| double.one(&moved(sample, carry)));
        let [mut to_double, mut to_single] = [Arrays::new(&samples), Arrays::new(&samples)];
        let tasks: [Box<dyn FnMut()>; 3] = [
            Box::new(one),
            Box::new(|| to_double.generate(&double)),
            Box::new(|| to_single.generate(&single)),
        ];
        let times = interleaved(tasks, effort);
        let interfaces = lens.surfaces.len();
        let aspheres = lens.surfaces.iter().filter(|surface| surface.figure.is_some()).count();
        print!("| {name} | {interfaces} | {aspheres} | {:.3} ", passing as f64 / SAMPLES as f64);
        for time in times {
            let time = time.median * 1e9 / SAMPLES as f64;
            print!("| {time:.2} | {:.3} ", time / interfaces as f64);
        }
        println!("|");
    }
}
