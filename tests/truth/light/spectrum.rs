//! The ghosts of a lamp at many wavelengths, made of few, against those of a lens at each.

use super::super::support::lens;
use realistic::unstable::{
    lens::Lens,
    light::{GhostSpectrum, Ghosts, Lamp, Surfaces},
    prescription::{Blades, Coating, SurfaceCoating, catalogue},
};

/// So many wavelengths, of which some are looked at: at the ends, between the nodes and at none.
const WAVELENGTHS: u32 = 16;
const LOOKED_AT: [usize; 4] = [0, 3, 9, 15];

/// How far the watts of the pairs are off, over all of them; and the middles of their light, over the radius of that or a tenth
/// of a millimetre, the mean by watts.
fn errors(
    name: &str,
    coating: &SurfaceCoating,
    degrees: f64,
    blades: Option<Blades>,
    side: usize,
) -> Option<[f64; 2]> {
    let prescription = catalogue::find(name).expect("a catalogue name");
    let own = lens(name);
    let film = own.rear().vertex - own.nominal_film_distance.unwrap_or(36.0);
    let coatings = vec![coating.clone(); own.surfaces.len()];
    let lens_at = |nm| Lens::new(&prescription, nm);
    let (sin, cos) = f64::to_radians(degrees).sin_cos();
    let lamp = Lamp::Distant([0.6 * sin, 0.8 * sin, cos]);
    let width = 260.0 / f64::from(WAVELENGTHS);
    let wavelengths: Vec<f64> = (0..WAVELENGTHS).map(|i| 420.0 + width * (f64::from(i) + 0.5)).collect();
    let spectrum = GhostSpectrum::new(&wavelengths, lens_at, blades, &coatings, film);
    let each = LOOKED_AT.map(|k| {
        let lens = lens_at(wavelengths[k]);
        Ghosts::new(&lens, blades, &Surfaces::of_each(&lens, &coatings), film)
    });
    let [mut off, mut moved, mut watts] = [0.0; 3];
    for pair in std::iter::once(None).chain(spectrum.pairs().map(Some)) {
        let mut made = vec![(0.0, None); wavelengths.len()];
        spectrum.sprays(pair, lamp, side, |k, spray| made[k] = (spray.watts(), spray.spot()));
        for (k, ghosts) in LOOKED_AT.into_iter().zip(&each) {
            let path = match pair {
                None => ghosts.direct(),
                Some(pair) => ghosts.pairs().find(|(own, _)| *own == pair).expect("the same pairs").1,
            };
            let spray = ghosts.spray(path, lamp, side);
            let (own, spot) = (spray.watts(), spray.spot());
            // The direct light is 1e4 times as bright as a coated lens's ghosts.
            let weight = if pair.is_none() { 0.0 } else { 1.0 };
            off += weight * (made[k].0 - own).abs();
            watts += weight * own;
            if let (Some((a, _)), Some((b, radius))) = (made[k].1, spot) {
                moved += weight * own * (a[0] - b[0]).hypot(a[1] - b[1]) / radius.max(0.1);
            }
            assert!(
                pair.is_some() || (made[k].0 - own).abs() <= 4e-3 * own,
                "{name}, {degrees} degrees, {} nm: direct light {} and not {own}",
                wavelengths[k],
                made[k].0
            );
        }
    }
    (watts > 0.0).then(|| [off / watts, moved / watts])
}

#[test]
fn wavelengths_made_of_few_have_the_watts_and_places_of_their_own() {
    let mut looked = 0;
    // A ghost of the widest fisheye is two parts of its front, of which a search at one wavelength may find one.
    // Every other lens of the rest, in a minute less.
    for name in catalogue::names().filter(|name| *name != "fisheye.6mm").step_by(2) {
        let Some([off, moved]) = errors(name, &Coating::QuarterWave.into(), 12.0, None, 24) else { continue };
        println!("| `{name}` | {off:.1e} | {moved:.1e} |");
        // Two grids over parts of their own differ by most of it, for what lands a metre beside the film.
        assert!(off < 2.5e-2 && moved < 5e-2, "{name}: {off} {moved}");
        looked += 1;
    }
    assert!(looked > 9, "{looked}");
    let [off, moved] = errors("dgauss.50mm", &Coating::ThreeLayer.into(), 3.0, None, 32).expect("light");
    assert!(off < 1e-3 && moved < 1e-3, "{off} {moved}");
}

#[test]
fn a_polygons_edges_are_those_of_each_wavelength() {
    let blades = Blades { count: 6, rotation: 10.0, curvature: 0.0 };
    let [off, moved] = errors("dgauss.100mm", &Coating::Bare.into(), 8.0, Some(blades), 32).expect("light");
    let [whole, _] = errors("dgauss.100mm", &Coating::Bare.into(), 8.0, None, 32).expect("light");
    println!("{off:.1e} {moved:.1e}; without blades {whole:.1e}");
    assert!(off < 5e-3 && moved < 1e-2, "{off} {moved}");
}
