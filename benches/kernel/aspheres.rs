//! The cost of an asphere, in spheres: a telephone's lens of twelve strong aspheres against a double Gauss of ten
//! spheres. From each time, that of two planes and of the transfers in and out is subtracted.

use realistic_lab::timing::{BenchArguments, Contest};
use realistic_optics::{lens::Lens, prescription::catalogue};
use realistic_simd::Simd;
use realistic_trace::kernel::KernelScalar;

use super::{BATCH, batch, scenes::Scene};

/// Prints the tables.
pub fn print(arguments: &BenchArguments) {
    if !arguments.wants("phone.4mm") {
        return;
    }
    println!("\n## Aspheres: phone.4mm has 12 of them, dgauss.50mm 10 spheres");
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        print_for::<f32>(simd, &format!("f32 {}", simd.name()), arguments);
        print_for::<f64>(simd, &format!("f64 {}", simd.name()), arguments);
    }
}

fn print_for<S: KernelScalar + 'static>(simd: Simd, name: &str, arguments: &BenchArguments) {
    let scene = |lens: Lens, distance: f64, reach: f64| {
        let film = lens.rear().vertex - distance;
        Scene { name: "", lens, film, reach }
    };
    let phone = Lens::at_d_line(&catalogue::find("phone.4mm").expect("listed"));
    let gauss = Lens::at_d_line(&catalogue::find("dgauss.50mm").expect("a catalogue lens"));
    let planes = phone.surfaces.iter().filter(|surface| surface.curvature == 0.0).cloned().collect();
    let planes = Lens { surfaces: planes, ..phone.clone() };
    let mut contest = Contest::default();
    for (name, scene) in [
        ("12 aspheres, 2 planes, stop", scene(phone, 0.0971, 2.5)),
        ("10 spheres, stop", scene(gauss, 36.1, 3.0)),
        ("2 planes, stop", scene(planes, 0.0971, 0.5)),
    ] {
        contest.enter(name, batch::<S>(&scene.lens, scene.film_rays(BATCH), simd));
    }
    println!("\n{name}\n");
    let times = contest.print("ns per ray", BATCH, arguments.effort);
    let [aspheres, spheres, planes] = [0, 1, 2].map(|i| times[i].median);
    let ratio = (aspheres - planes) / 12.0 / ((spheres - planes) / 10.0);
    println!("\nan asphere takes as long as {ratio:.1} spheres");
}
