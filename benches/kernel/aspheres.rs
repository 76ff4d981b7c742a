//! What an asphere costs, in spheres: a telephone's lens of twelve strong aspheres against the same lens with spheres in
//! their place, both less what their planes and the way in and out take.

use realistic::{
    lens::{Lens, Surface},
    trace::kernel::{KernelScalar, Simd},
};
use realistic_lab::{
    subject::phone_lens,
    timing::{BenchArguments, Contest},
};

use super::{BATCH, batch, scenes::Scene};

/// Prints the tables.
pub fn print(arguments: &BenchArguments) {
    if !arguments.wants("phone.4mm") {
        return;
    }
    let lens = Lens::at_d_line(&phone_lens());
    println!("\n## Aspheres: {}, 12 of them", lens.name);
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        print_for::<f32>(&lens, simd, &format!("f32 {}", simd.name()), arguments);
        print_for::<f64>(&lens, simd, &format!("f64 {}", simd.name()), arguments);
    }
}

fn print_for<S: KernelScalar + 'static>(lens: &Lens, simd: Simd, name: &str, arguments: &BenchArguments) {
    let film = lens.rear().vertex - 0.0971;
    let scene = |lens: Lens| Scene { name: "phone.4mm", lens, film, reach: 2.5 };
    let spheres = lens.surfaces.iter().map(|surface| Surface { figure: None, ..*surface }).collect();
    let planes = lens.surfaces.iter().filter(|surface| surface.curvature == 0.0).copied().collect();
    let mut contest = Contest::default();
    let rays = scene(lens.clone()).film_rays::<S>(BATCH);
    let mut enter = |name: &str, surfaces: Vec<Surface>| {
        let lens = Lens { surfaces, ..lens.clone() };
        contest.enter(name, batch::<S>(&lens, rays.clone(), simd));
    };
    println!("\n{name}\n");
    enter("aspheres", lens.surfaces.clone());
    enter("spheres", spheres);
    enter("the planes alone", planes);
    let times = contest.print("ns per ray", BATCH, arguments.effort);
    let [aspheres, spheres, planes] = [0, 1, 2].map(|i| times[i].median);
    println!("\nan asphere takes as long as {:.1} spheres", (aspheres - planes) / (spheres - planes));
}
