//! The ghosts of a lamp at many wavelengths, interpolated from few wavelengths, compared with those of a lens built at
//! each wavelength.

use super::super::support::{lens, on_all_cores};
use realistic_light::{GhostSpectrum, Ghosts, Lamp, Surfaces};
use realistic_optics::{
    lens::Lens,
    prescription::{Blades, Coating, SurfaceCoating, catalogue},
};

/// Number of wavelengths, and the wavelengths that are compared: the two ends, which are nodes, and two between nodes.
const WAVELENGTHS: u32 = 16;
const COMPARED: [usize; 4] = [0, 3, 9, 15];
/// Maximum error of products of two reflectances between interpolation nodes, relative to the largest product.
const BETWEEN_NODES: f64 = 1e-3;

/// The centre of some light on film and its radius, mm.
type Spot = Option<([f64; 2], f64)>;

/// Errors of the pairs, each given as two numbers: the error of the watts relative to their sum; and the shift of the
/// light's centre relative to the light's radius, or to a tenth of a millimetre if that is larger, averaged with the
/// watts as weights.
struct Errors {
    /// Errors of interpolated wavelengths relative to a lens built at each wavelength.
    of_interpolation: [f64; 2],
    /// Differences from a grid with twice as many cells along a side.
    of_grid: [f64; 2],
}

/// Returns the errors for a lens and a lamp at an angle from the axis, by grids with `side` cells along a side; `None`
/// if no light arrives.
fn errors(
    name: &str,
    coating: &SurfaceCoating,
    degrees: f64,
    blades: Option<Blades>,
    side: usize,
) -> Option<Errors> {
    let prescription = catalogue::find(name).expect("a catalogue name");
    let own = lens(name);
    let film = own.rear().vertex - own.nominal_film_distance.unwrap_or(36.0);
    let coatings = vec![coating.clone(); own.surfaces.len()];
    let lens_at = |nm| {
        let mut lens = Lens::new(&prescription, nm);
        lens.set_blades(blades);
        lens
    };
    let (sin, cos) = f64::to_radians(degrees).sin_cos();
    let lamp = Lamp::Distant([0.6 * sin, 0.8 * sin, cos]);
    let width = 260.0 / f64::from(WAVELENGTHS);
    let wavelengths: Vec<f64> = (0..WAVELENGTHS).map(|i| 420.0 + width * (f64::from(i) + 0.5)).collect();
    let spectrum = GhostSpectrum::new(&wavelengths, lens_at, &coatings, film);
    let each = COMPARED.map(|k| {
        let lens = lens_at(wavelengths[k]);
        Ghosts::new(&lens, &Surfaces::of_each(&lens, &coatings), film)
    });
    let mut watts = 0.0;
    let mut errors = Errors { of_interpolation: [0.0; 2], of_grid: [0.0; 2] };
    let add = |[off, moved]: &mut [f64; 2], found: (f64, Spot), own: (f64, Spot)| {
        *off += (found.0 - own.0).abs();
        if let (Some((a, _)), Some((b, radius))) = (found.1, own.1) {
            *moved += own.0 * f64::hypot(a[0] - b[0], a[1] - b[1]) / f64::max(radius, 0.1);
        }
    };
    for pair in std::iter::once(None).chain(spectrum.pairs().map(Some)) {
        let made = |side| {
            let mut made = vec![(0.0, None); wavelengths.len()];
            spectrum.sprays(pair, lamp, side, |k, spray| made[k] = (spray.watts(), spray.spot()));
            made
        };
        let [made, finer] = [side, 2 * side].map(made);
        for (k, ghosts) in COMPARED.into_iter().zip(&each) {
            let path = match pair {
                None => ghosts.direct().clone(),
                Some(pair) => ghosts.lit(pair),
            };
            let spray = ghosts.spray(&path, lamp, side);
            let own = (spray.watts(), spray.spot());
            assert!(
                pair.is_some() || (made[k].0 - own.0).abs() <= 4e-3 * own.0,
                "{name}, {degrees} degrees, {} nm: direct light {} and not {}",
                wavelengths[k],
                made[k].0,
                own.0
            );
            // The direct light is 1e4 times as bright as a coated lens's ghosts.
            if pair.is_some() {
                add(&mut errors.of_interpolation, made[k], own);
                add(&mut errors.of_grid, made[k], finer[k]);
                watts += own.0;
            }
        }
    }
    let over = |both: [f64; 2]| both.map(|error| error / watts);
    (watts > 0.0)
        .then(|| Errors { of_interpolation: over(errors.of_interpolation), of_grid: over(errors.of_grid) })
}

#[test]
fn interpolated_wavelengths_have_the_watts_of_traced_ones() {
    // The lenses have few surfaces and many, near the film and far from it, spheres alone and aspheres; the last is the
    // fisheye whose ghosts come from the narrowest part of its front.
    let lenses =
        ["tessar.50mm", "dgauss.50mm", "telephoto.250mm", "retrofocus.24mm", "phone.4mm", "fisheye.6mm"];
    on_all_cores(&lenses, |name| {
        let Errors { of_interpolation, of_grid } =
            errors(name, &Coating::QuarterWave.into(), 12.0, None, 24).expect("light");
        println!(
            "| `{name}` | {:.1e} | {:.1e} | {:.1e} | {:.1e} |",
            of_interpolation[0], of_grid[0], of_interpolation[1], of_grid[1]
        );
        // The two grids cover different regions, and each has an error of its own.
        for (interpolated, grid) in of_interpolation.into_iter().zip(of_grid) {
            assert!(interpolated < BETWEEN_NODES + 2.0 * grid, "{name}: {of_interpolation:?} {of_grid:?}");
        }
        let [off, moved] = of_interpolation;
        // The fisheye's brightest ghost is a thin annulus, a few cells across.
        let factor = if *name == "fisheye.6mm" { 2.0 } else { 1.0 };
        assert!(off < factor * 2.5e-2 && moved < factor * 5e-2, "{name}: {off} {moved}");
    });
    let [off, moved] =
        errors("dgauss.50mm", &Coating::ThreeLayer.into(), 3.0, None, 32).expect("light").of_interpolation;
    assert!(off < 1e-3 && moved < 1e-3, "{off} {moved}");
}

#[test]
fn a_polygons_edges_are_those_of_each_wavelength() {
    let blades = Blades { count: 6, rotation: 10.0, curvature: 0.0 };
    let [off, moved] =
        errors("dgauss.100mm", &Coating::Bare.into(), 8.0, Some(blades), 32).expect("light").of_interpolation;
    let [whole, _] =
        errors("dgauss.100mm", &Coating::Bare.into(), 8.0, None, 32).expect("light").of_interpolation;
    println!("{off:.1e} {moved:.1e}; without blades {whole:.1e}");
    // The amount and position of the light are polynomials, accurate to a thousandth each; edges are found by tracing.
    assert!(off < 1e-3 && moved < 1e-3 && whole < 1e-3, "{off} {moved} {whole}");
}
