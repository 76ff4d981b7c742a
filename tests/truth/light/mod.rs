//! The effect of surfaces on light: films against closed forms, light along rays against an independent trace, and a
//! camera's weights against the product of its surfaces.

mod absorption;
mod camera;
mod film;
mod ghosts;
mod lamps;
mod oracle;
mod spectrum;

use super::support::{Random, lens};
use realistic_light::{Boundary, LitPath, Surfaces, beyond_pairs, split};
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::{Coating, Layer, SurfaceCoating},
    trace::{Direction, Path},
};

const GLASS: f64 = 1.5168;
/// The quarter-wave film at 550 nm, MgF2 of index 1.38.
const FILM: (f64, f64) = (1.38, 550.0 / 4.0 / 1.38);

/// Returns the layers of a coating on glass, from the air to the glass.
fn layers(coating: Coating, n: f64) -> Vec<Layer> {
    SurfaceCoating::from(coating).layers([1.0, n])
}

/// Returns the surfaces of a lens with a coating, computed at every ray by the transfer matrix.
fn exact_surfaces(lens: &Lens, coating: Coating) -> Surfaces {
    Surfaces::untabulated(lens, &vec![coating.into(); lens.surfaces.len()])
}

fn near(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} is not {b} within {within}");
}

#[test]
fn bare_and_quarter_wave_surfaces_reflect_what_closed_forms_say() {
    let reflectance =
        |coating: Coating, n: f64| split(&layers(coating, n), [1.0, n], 1.0, 550.0).reflected.mean();
    for n in [GLASS, 1.52, 1.785, 1.9044] {
        near(reflectance(Coating::Bare, n), ((n - 1.0) / (n + 1.0)).powi(2), 1e-12);
        let square = 1.38_f64.powi(2);
        near(reflectance(Coating::QuarterWave, n), ((n - square) / (n + square)).powi(2), 1e-12);
    }
    // Two quarter waves turn the glass's index n into n (1.38/1.70)²; at n = (1.70/1.38)² nothing is reflected.
    let matched = (1.7_f64 / 1.38).powi(2);
    for n in [GLASS, matched, 1.785] {
        let r = (1.0 - n / matched) / (1.0 + n / matched);
        near(reflectance(Coating::VCoat, n), r * r, 1e-12);
    }
    assert!(reflectance(Coating::VCoat, matched) < 1e-28);
    // A half wave has no effect; the quarter waves on either side of it turn the glass's index into n (1.38/1.63)².
    let n = GLASS * (1.38_f64 / 1.63).powi(2);
    near(reflectance(Coating::ThreeLayer, GLASS), ((1.0 - n) / (1.0 + n)).powi(2), 1e-12);
    // Values of H. A. Macleod's tables, computed elsewhere to four digits.
    let at = |wavelength| split(&layers(Coating::ThreeLayer, GLASS), [1.0, GLASS], 1.0, wavelength);
    for (wavelength, per_cent) in
        [(420.0, 1.53), (450.0, 0.207), (500.0, 0.084), (600.0, 0.107), (650.0, 0.031)]
    {
        near(100.0 * at(wavelength).reflected.mean(), per_cent, 0.005);
    }
}

#[test]
fn at_brewsters_angle_none_of_p_is_reflected() {
    let brewster = GLASS.atan();
    let found = split(&[], [1.0, GLASS], brewster.cos(), 550.0);
    assert!(found.reflected.p < 1e-30 && found.reflected.s > 0.1);
    near(found.transmitted.p, 1.0, 1e-12);
}

#[test]
fn films_conserve_energy_and_follow_airy() {
    let mut random = Random::new(7);
    for _ in 0..2000 {
        let [n, behind, index] = [(); 3].map(|()| 1.0 + random.next());
        let (cosine, wavelength) = (0.02 + 0.98 * random.next(), 400.0 + 300.0 * random.next());
        let layer = Layer { index, thickness: 400.0 * random.next() };
        let there = split(&[layer], [n, behind], cosine, wavelength);
        for (r, t) in [(there.reflected.s, there.transmitted.s), (there.reflected.p, there.transmitted.p)] {
            near(r + t, 1.0, 1e-12);
        }
        let (inside, square) = (n / index, 1.0 - (n / behind).powi(2) * (1.0 - cosine * cosine));
        if square <= 0.0 {
            assert!(there.transmitted.mean() == 0.0, "total reflection");
            continue;
        }
        let back = split(&[layer], [behind, n], square.sqrt(), wavelength);
        for (a, b) in [(there.reflected, back.reflected), (there.transmitted, back.transmitted)] {
            near(a.s, b.s, 1e-12);
            near(a.p, b.p, 1e-12);
        }
        if inside * inside * (1.0 - cosine * cosine) < 1.0 {
            let of = |p| oracle::amplitudes(n, Some((index, layer.thickness)), behind, cosine, wavelength, p);
            near(there.reflected.s, of(false)[0].square(), 1e-12);
            near(there.reflected.p, of(true)[0].square(), 1e-12);
        }
    }
}

#[test]
fn flat_plates_one_after_the_other_are_the_adding_formula() {
    // For two surfaces, all orders summed without interference give T = T1 T2/(1 - R1 R2) and R = R1 + T1² R2/(1 - R1
    // R2). For m equal surfaces this is T = (1 - R)/(1 + (m - 1) R), whose first two terms are the direct light and the
    // pairs.
    let [r, m] = [split(&[], [1.0, GLASS], 1.0, 550.0).reflected.mean(), 6.0];
    let plate = "0 1 1.5168 30\n0 1 1 30\n".repeat(2) + "0 1 1.5168 30\n0 0 1 30\n";
    let flat = Lens::at_d_line(&realistic::read("flat", plate.as_bytes()).expect("a lens"));
    let surfaces = exact_surfaces(&flat, Coating::Bare);
    let axial = Ray { origin: [0.0, 0.0, 5.0], direction: [0.0, 0.0, -1.0] };
    let direct = LitPath::new(Path::scene_to_film(&flat), &surfaces).trace(axial).expect("passes").1;
    near(direct, (1.0 - r).powi(6), 1e-12);
    let all = surfaces.reflecting();
    assert_eq!(all, [0, 1, 2, 3, 4, 5]);
    let mut two = 0.0;
    for (at, near) in all.iter().enumerate() {
        for far in &all[at + 1..] {
            let path = Path::reflected(&flat, Direction::SceneToFilm, Refraction::Fused, [*near, *far]);
            two += LitPath::new(path, &surfaces).trace(axial).expect("passes").1;
        }
    }
    // The remainder consists of the orders with four or more reflections.
    let left = (1.0 - r) / (1.0 + (m - 1.0) * r) - direct - two;
    near(left / direct, beyond_pairs(&surfaces, &flat), 1e-12);
    let adding = |(t1, r1): (f64, f64)| {
        let below = 1.0 - r1 * r;
        (t1 * (1.0 - r) / below, r + (1.0 - r).powi(2) * r1 / below)
    };
    let (t, _) = (1..6).fold((1.0 - r, r), |stack, _| adding(stack));
    near(t, (1.0 - r) / (1.0 + (m - 1.0) * r), 1e-12);
}

/// Returns rays toward the front of a lens.
fn rays(lens: &Lens, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let mut between = |a: f64| a * (2.0 * random.next() - 1.0);
    let front = lens.front().semi_diameter;
    let ray = |_| {
        let (x, y) = (between(front), between(front));
        let (u, v) = (between(0.25), between(0.25));
        let w = (1.0 - u * u - v * v).sqrt();
        // Rays start 20 mm in front of the front vertex plane.
        Ray { origin: [x - 20.0 * u / w, y - 20.0 * v / w, 20.0], direction: [u, v, -w] }
    };
    (0..count).map(ray).collect()
}

#[test]
fn light_along_rays_equals_that_of_an_independent_trace() {
    for name in ["dgauss.50mm", "fisheye.10mm", "wide.22mm"] {
        let lens = lens(name);
        for (coating, film) in [(Coating::Bare, None), (Coating::QuarterWave, Some(FILM))] {
            let lit = LitPath::new(Path::scene_to_film(&lens), &exact_surfaces(&lens, coating));
            let tabulated = LitPath::new(Path::scene_to_film(&lens), &Surfaces::new(&lens, coating));
            let mut passed = 0;
            for ray in rays(&lens, 20_000, 3) {
                let Ok((_, exact)) = lit.trace(ray) else { continue };
                let Some((other, ..)) = oracle::trace(&lens, film, None, ray.origin, ray.direction) else {
                    continue;
                };
                passed += 1;
                assert!((exact / other - 1.0).abs() < 1e-12, "{name}: {exact} {other}");
                let tabulated = tabulated.trace(ray).expect("as before").1;
                assert!((tabulated / exact - 1.0).abs() < 1e-5, "{name}: {tabulated} {exact}");
            }
            assert!(passed > 40, "{name}: {passed}");
        }
    }
}

#[test]
fn tables_are_their_surfaces_on_both_sides() {
    // The last coating is a mirror of twelve layers, three waves thick, which resonates.
    let mirror: Vec<Layer> =
        (0..12).map(|i| Layer::of_waves(if i % 2 == 0 { 2.3 } else { 1.46 }, 0.25, 480.0)).collect();
    let names = [Coating::Bare, Coating::QuarterWave, Coating::VCoat, Coating::ThreeLayer];
    for n in [1.45, 1.9] {
        let named = names.map(|coating| (layers(coating, n), 3e-6));
        for (layers, within) in named.into_iter().chain([(mirror.clone(), 5e-5)]) {
            let boundary = Boundary::new([1.0, n], &layers, 480.0);
            for side in [1.0, n] {
                for i in 1..1000 {
                    let cosine = f64::from(i) / 1000.0;
                    let (table, exact) = (boundary.split(side, cosine), boundary.computed(side, cosine));
                    for (a, b) in [(table.reflected, exact.reflected), (table.transmitted, exact.transmitted)]
                    {
                        near(a.s, b.s, within);
                        near(a.p, b.p, within);
                        near(a.cross[0], b.cross[0], within);
                        near(a.cross[1], b.cross[1], within);
                    }
                }
            }
        }
    }
}

#[test]
fn grazing_light_is_reflected_and_not_lost_in_rounding() {
    // For some indices the cosine behind is 0 to the last bit.
    for coating in [Coating::Bare, Coating::QuarterWave, Coating::VCoat, Coating::ThreeLayer] {
        for i in 0..700 {
            let n = 1.3 + f64::from(i) / 1000.0;
            let boundary = Boundary::new([1.0, n], &layers(coating, n), 587.56);
            for cosine in [0.0, 1e-9, 1e-4, 0.005, 0.02] {
                let split = boundary.split(1.0, cosine);
                for (r, t) in
                    [(split.reflected.s, split.transmitted.s), (split.reflected.p, split.transmitted.p)]
                {
                    near(r + t, 1.0, 1e-5);
                }
            }
        }
    }
}
