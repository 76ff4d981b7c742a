//! Light in absorbing glass: the library's direct light and ghosts are compared with photons that are absorbed at
//! random, and the energy balance is checked.

use realistic_lab::stray::{Balance, balance};
use realistic_light::{Ghosts, Lamp, Spray, Surfaces};
use realistic_optics::{
    lens::{Lens, first_order::FirstOrder},
    prescription::{Coating, GlassLibrary, read_with},
};

/// Fictitious glasses that transmit 0.9 and 0.7 over 10 mm.
const GLASSES: &str = "NM CROWN 1 0\nCD 2.33 0 0 0 0 0\nLD 0.3 2\nIT 0.587 0.9 10\n\
                       NM FLINT 1 0\nCD 2.89 0 0 0 0 0\nLD 0.3 2\nIT 0.587 0.7 10\n";
/// The double Gauss of the catalogue, made of these glasses.
const LENS: &str = "29.475 3.76 FLINT 25.2\n84.83 0.12 1 25.2\n19.275 4.025 FLINT 23\n40.77 3.275 CROWN 23\n12.75 5.705 1 18\n\
                    0 4.5 0 17.1\n-14.495 1.18 CROWN 17\n40.77 6.065 FLINT 20\n-20.385 0.19 1 20\n437.065 3.22 FLINT 20\n\
                    -39.73 0 1 20\n";
const SPOT: f64 = 20.0;

#[test]
fn absorbed_photons_and_the_librarys_light_add_up() {
    let mut library = GlassLibrary::default();
    library.add("own.agf", GLASSES.as_bytes()).expect("a catalogue");
    let lens = Lens::at_d_line(&read_with("own.dat", LENS.as_bytes(), &library).expect("a lens"));
    let plane = FirstOrder::of(&lens).expect("a focal length").rear_focal_point;
    let toward = [0.05, 0.0, 1.0];
    let photons = balance(&lens, None, toward, plane, SPOT, 300_000, 11);
    let Balance { direct, two, more, beside, blocked, back, absorbed, .. } = photons;
    let ghosts = Ghosts::new(&lens, &Surfaces::new(&lens, Coating::Bare), plane);
    let inside = |spray: &Spray| -> f64 {
        let lands = spray.landings().filter(|landing| landing.point[0].hypot(landing.point[1]) <= SPOT);
        lands.map(|landing| landing.watts).sum()
    };
    let lamp = Lamp::Distant(toward);
    let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
    let entering = std::f64::consts::PI * (lens.front().semi_diameter * 1e-3).powi(2) * toward[2] / length;
    let by_rays = inside(&ghosts.spray(ghosts.direct(), lamp, 300)) / entering;
    let by_pairs: f64 =
        ghosts.pairs().map(|(_, path)| inside(&ghosts.spray(&path, lamp, 80))).sum::<f64>() / entering;
    println!(
        "direct {by_rays:.4}, {direct:.4}; ghosts {by_pairs:.2e}, {two:.2e}; absorbed {absorbed:.4}; more {more:.1e}"
    );
    let near = |a: f64, b: f64| (a - b).abs() < 4.0 * photons.error(b).hypot(2e-3 * b);
    assert!(near(by_rays, direct) && near(by_pairs, two), "{by_rays} {direct}, {by_pairs} {two}");
    // Absorption is so large that a wrong law would show.
    assert!(absorbed > 0.2, "{absorbed}");
    let whole = by_rays + by_pairs + more + beside + blocked + back + absorbed;
    assert!((whole - 1.0).abs() < 4.0 * photons.error(direct).hypot(2e-3 * direct), "{whole}");
}
