//! Cases of one and two interfaces whose answer the reference gives: extreme curvatures, edges of hemispheres, critical
//! angles, index steps and gaps.

use realistic_optics::trace::{
    Direction::{self, FilmToScene, SceneToFilm},
    Ray,
};

use super::{
    case::Case,
    lenses::{Row, SIDES, bundle, lens, parallel},
};

fn case(group: &'static str, name: &str, rows: &[Row], direction: Direction, rays: Vec<Ray>) -> Case {
    Case::new(group, name, &lens(name, rows), direction, rays)
}

/// Radii |R| from 1e-3 to 1e30 mm of both signs, and the plane, from 40 mm and from 1000 mm.
pub fn radii() -> Vec<Case> {
    let mut cases = Vec::new();
    for radius in [1e-3, 0.1, 5.5, 50.0, 1e3, 1e5, 1e7, 1e9, 1e12, 1e30, f64::INFINITY] {
        let signs: &[f64] = if radius.is_finite() { &[1.0, -1.0] } else { &[1.0] };
        for &sign in signs {
            let semi = (0.9_f64 * radius).min(5.0);
            let alone = [(sign * radius, 0.0, 1.5, semi)];
            // The film side must be air as well, so the surface is the front of a plate, which is as thick as the
            // surface is wide.
            let backed = [(sign * radius, 4.0 * semi, 1.5, semi), (f64::INFINITY, 0.0, 1.0, semi)];
            for (rows, direction) in [(&alone[..], SceneToFilm), (&backed[..], FilmToScene)] {
                let side = if direction == SceneToFilm { "scene" } else { "film" };
                let name = format!("R = {:e} from the {side}", sign * radius);
                let shape = lens(&name, rows);
                let mut rays = bundle(&shape, direction, 40.0, &[0.0, 3.0], semi);
                rays.extend(bundle(&shape, direction, 1000.0, &[0.0, 300.0], semi));
                cases.push(case("radius", &name, rows, direction, rays));
            }
        }
    }
    cases
}

/// Hemispheres, which rays meet at up to 1 - 1e-12 of the radius from the axis.
pub fn edges() -> Vec<Case> {
    let radius = 10.0;
    let nearness = [0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12];
    let heights = nearness.map(|near| radius * (1.0 - near));
    let inward = [0.0, 0.5 * radius, radius].into_iter().chain(heights);
    let alone = |sign: f64| [(sign * radius, 0.0, 1.5, radius)];
    // Every ray from its centre meets a sphere at normal incidence, up to the edge.
    let from_centre = (0..8).map(|i| {
        let slope = 4.0_f64.powi(i) - 1.0;
        Ray { origin: [0.0, 0.0, -radius - 1.0], direction: [slope, 0.3 * slope, 1.0] }
    });
    let beside = heights.map(|height| Ray { origin: [height, 0.0, 30.0], direction: [1e-3, 1e-2, -1.0] });
    let near_centre = [(radius, 10.5, 1.5, radius), (0.5, 0.0, 1.0, 0.5)];
    let [convex, concave] = [1.0, -1.0].map(alone);
    [
        ("parallel to the rim of a convex hemisphere", &convex[..], parallel(inward.clone())),
        ("parallel to the rim of a concave hemisphere", &concave, parallel(inward)),
        ("oblique past the rim of a hemisphere", &convex, beside.into()),
    ]
    .map(|(name, rows, rays)| case("rim", name, rows, SceneToFilm, rays))
    .into_iter()
    .chain([case(
        "rim",
        "from near the centre of a hemisphere",
        &near_centre,
        FilmToScene,
        from_centre.collect(),
    )])
    .collect()
}

/// Rays that meet a plane or a weak sphere at angles down to 1e-9 rad from grazing, and continue inside at the critical
/// angle; and rays that leave at it.
pub fn grazing() -> Vec<Case> {
    let rays = |sign: f64| -> Vec<Ray> {
        let slopes = (1..=9).flat_map(|i| [1.0, 3.0].map(|digit| digit * 10.0_f64.powi(i)));
        let ray = |slope: f64| Ray { origin: [1.0 - slope, 0.3, -sign], direction: [slope, 0.1, sign] };
        slopes.map(ray).collect()
    };
    let wide = |radius: f64| [(radius, 0.0, 1.5, 5.0)];
    let mut cases = vec![
        case("grazing", "a plane from the scene", &wide(f64::INFINITY), SceneToFilm, rays(-1.0)),
        case("grazing", "a sphere of 1e12 mm from the scene", &wide(1e12), SceneToFilm, rays(-1.0)),
    ];
    // The rays are reversed: they travel from inside toward the plane, as close to the critical angle.
    let critical = (1.0_f64 / 1.5).asin();
    let inside = (1..=10).flat_map(|i| [-1.0, 1.0].map(|side| critical + side * 10.0_f64.powi(-i)));
    let back = inside
        .map(|angle| Ray { origin: [-angle.tan(), 0.2, -1.0], direction: [angle.sin(), 0.0, angle.cos()] });
    let name = "out of a plane at the critical angle";
    cases.push(case("grazing", name, &wide(f64::INFINITY), FilmToScene, back.collect()));
    cases
}

/// Rays on both sides of the critical angle, whose sines differ from its sine by 1e-2 to 1e-12 of it.
pub fn critical_angles() -> Vec<Case> {
    let radius = 10.0;
    let mut cases = Vec::new();
    for n in [1.1, 1.5, 2.0, 4.0] {
        let mut rays = Vec::new();
        for near in [0.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            for side in [1.0 - near, 1.0 + near] {
                let height = radius / n * side;
                let origin = [0.6 * height, 0.8 * height, -30.0];
                rays.push(Ray { origin, direction: [0.0, 0.0, 1.0] });
            }
        }
        let rows = [(radius, 20.0, n, radius), (f64::INFINITY, 0.0, 1.0, radius)];
        let name = format!("n = {n}, parallel rays into a sphere");
        cases.push(case("critical angle", &name, &rows, FilmToScene, rays));
    }
    cases
}

/// Index steps from 1e-7 to 3, in a singlet and at a cemented surface.
pub fn index_steps() -> Vec<Case> {
    let mut cases = Vec::new();
    for step in [1e-7, 1e-5, 1e-3, 0.1, 0.5, 1.0, 2.0, 3.0] {
        let singlet = [(12.0, 4.0, 1.0 + step, 5.0), (-15.0, 0.0, 1.0, 5.0)];
        let cemented = [(12.0, 4.0, 1.5, 5.0), (-15.0, 2.0, 1.5 + step, 5.0), (30.0, 0.0, 1.0, 5.0)];
        for (kind, rows) in [("singlet", &singlet[..]), ("cemented", &cemented[..])] {
            for (side, direction) in SIDES {
                let name = format!("step {step:e}, {kind} from the {side}");
                let rays = bundle(&lens(&name, rows), direction, 40.0, &[0.0, 8.0], 5.0);
                cases.push(case("index step", &name, rows, direction, rays));
            }
        }
    }
    cases
}

/// Interfaces that touch at the vertex or at the edge, and gaps from 1e-9 to 1e6 mm.
pub fn gaps() -> Vec<Case> {
    let air = |gap: f64, next: f64| {
        [(30.0, 3.0, 1.5, 5.0), (-30.0, gap, 1.0, 5.0), (next, 3.0, 1.6, 5.0), (-200.0, 0.0, 1.0, 5.0)]
    };
    // The edge of a concave surface touches the convex one after it.
    let (steep, flat) = (20.0_f64, 40.0_f64);
    let sag = |radius: f64| radius - (radius * radius - 25.0_f64).sqrt();
    let edge = [
        (flat, 3.0, 1.5, 5.0),
        (-steep, sag(steep) - sag(flat), 1.0, 5.0),
        (-flat, 3.0, 1.6, 5.0),
        (90.0, 0.0, 1.0, 5.0),
    ];
    let mut all = vec![
        ("touching at the vertex".to_owned(), air(0.0, 30.0)),
        ("lying in each other".to_owned(), air(0.0, -30.0)),
        ("touching at the rim".to_owned(), edge),
        ("crossing inside the aperture".to_owned(), air(0.0, -20.0)),
    ];
    all.extend([1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6].map(|gap| (format!("gap {gap:e} mm"), air(gap, 30.0))));
    let mut cases = Vec::new();
    for (name, rows) in all {
        for (side, direction) in SIDES {
            let name = format!("{name} from the {side}");
            let shape = lens(&name, &rows);
            let mut rays = bundle(&shape, direction, 40.0, &[0.0, 1e-3, 3.0], 4.9);
            rays.extend(bundle(&shape, direction, 60.0, &[0.0], 1e-4));
            cases.push(case("gap", &name, &rows, direction, rays));
        }
    }
    cases
}
