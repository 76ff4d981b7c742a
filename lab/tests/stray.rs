//! Direct light and ghosts of the library against photons of all orders: every watt that enters a lens goes somewhere.

use realistic::unstable::{
    lens::{Lens, first_order::FirstOrder},
    light::{Coating, Ghosts, Lamp, Spray, Surfaces},
    prescription::catalogue,
};
use realistic_lab::stray::{Balance, balance};

/// The quarter wave of MgF2.
const FILM: (f64, f64) = (1.38, 550.0 / 4.0 / 1.38);

/// What the library says, of 1 W that enters: direct light and ghosts on the film's disk.
fn product(lens: &Lens, coating: Coating, toward: [f64; 3], plane: f64, spot: f64) -> [f64; 2] {
    let ghosts = Ghosts::new(lens, None, &Surfaces::new(lens, coating), plane);
    let lamp = Lamp::Distant(toward);
    let inside = |spray: &Spray| -> f64 {
        let lands =
            |landing: &&realistic::unstable::light::Landing| landing.point[0].hypot(landing.point[1]) <= spot;
        spray.landings().filter(lands).map(|landing| landing.watts).sum()
    };
    let direct = inside(&ghosts.spray(ghosts.direct(), lamp, 400));
    let pairs: f64 = ghosts.pairs().map(|(_, path)| inside(&ghosts.spray(path, lamp, 96))).sum();
    // The watts of 1 W/m² that meet the front surface, a disk of its clear aperture seen along the light.
    let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
    let entering = entered(lens, toward.map(|x| x / length));
    [direct / entering, pairs / entering]
}

/// The area across the light of the front surface inside its clear aperture, m², by counting.
fn entered(lens: &Lens, toward: [f64; 3]) -> f64 {
    // The flux of the light through the aperture's disk: all that crosses it has met, or meets, the surface, as long as no ray
    // comes in over the edge.
    let area = std::f64::consts::PI * lens.front().semi_diameter.powi(2) * 1e-6;
    area * toward[2]
}

#[test]
fn every_watt_is_accounted_for() {
    // The largest difference, in standard errors.
    let mut most: f64 = 0.0;
    for (name, field) in
        [("dgauss.50mm", 0.0_f64), ("dgauss.50mm", 12.0), ("telephoto.250mm", 2.0), ("tessar.50mm", 10.0)]
    {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("in the catalogue"));
        let plane = FirstOrder::of(&lens).expect("a focal length").rear_focal_point;
        let (spot, toward) = (20.0, [field.to_radians().tan(), 0.0, 1.0]);
        for (coating, film) in [(Coating::Bare, None), (Coating::QuarterWave, Some(FILM))] {
            let photons = 400_000;
            let truth @ Balance { direct, two, more, beside, blocked, back, .. } =
                balance(&lens, film, toward, plane, spot, photons, 9);
            let [by_rays, by_pairs] = product(&lens, coating, toward, plane, spot);
            let error = |share: f64| truth.error(share);
            // A grid's edges are a few cells in ten thousand.
            let near = |a: f64, b: f64, what: &str| {
                let off = (a - b).abs() / (error(b).hypot(2e-3 * b).max(1.0 / f64::from(photons)));
                assert!(off < 4.0, "{name} at {field} degrees, {coating:?}: {what} {a}, by photons {b}");
                off
            };
            most = most.max(near(by_rays, direct, "direct")).max(near(by_pairs, two, "ghosts"));
            // Each of these measured by itself.
            let whole = by_rays + by_pairs + more + beside + blocked + back;
            assert!((whole - 1.0).abs() < 4.0 * error(direct).hypot(2e-3 * direct), "{name}: {whole}");
            println!(
                "{name} {field} {coating:?}: direct {by_rays:.5} {direct:.5}, ghosts {by_pairs:.3e} {two:.3e}, more {more:.1e}, whole {whole:.5}"
            );
        }
    }
    println!("largest {most:.2} standard errors");
}
