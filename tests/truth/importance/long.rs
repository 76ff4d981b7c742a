//! Lenses of hundreds of interfaces. The longer a ray takes, the coarser the tables: fewer directions pass, but the
//! light is the same.

use std::fmt::Write;

use ::realistic_camera::{Aimed, Camera, Host, ScenePoint};

use super::{
    acceptance::{nearest_focus, share},
    camera_of,
    integrals::disagreements,
    scene::numbers,
    support::{Random, host},
};

/// Numbers of interfaces, and whether they are aspheres: one lens for each table size, the finest table first.
const LENSES: [(usize, bool); 4] = [(150, false), (400, false), (1000, false), (1000, true)];

/// Returns a lens in front of plates, which are too flat to touch.
fn long(interfaces: usize, is_aspheric: bool) -> Camera {
    let mut random = Random::new(interfaces as u64);
    let mut text = "60 6 1.6 14\n-400 2 1 14\n".to_owned();
    for i in 2..interfaces {
        let radius = 20_000.0 * 30.0_f64.powf(random.next()) * random.signed().signum();
        let index = if i % 2 == 0 { 1.4 + 0.4 * random.next() } else { 1.0 };
        writeln!(text, "{radius} 0.03 {index} 14").expect("a string");
    }
    for i in (1..=interfaces).filter(|_| is_aspheric) {
        let [conic, a4, a6] = [1.0, 1e-9, 1e-11].map(|size| size * random.signed());
        writeln!(text, "asphere {i} conic={conic} A4={a4:e} A6={a6:e}").expect("a string");
    }
    camera_of(&Host { lens_text: Some(("long.dat".to_owned(), text.into_bytes())), ..host() }, &[])
}

#[test]
fn most_directions_toward_long_lenses_get_through() {
    for (interfaces, is_aspheric) in LENSES {
        let camera = long(interfaces, is_aspheric);
        let nearest = nearest_focus(&camera).max(1.0);
        let (far, unseen, all) = share(&camera, |number| nearest / number.max(1e-6));
        eprintln!("{interfaces} {is_aspheric}: {far:.3} ({unseen} of {all} unseen)");
        assert!(far > 0.4 && unseen <= all / 700, "{interfaces} {is_aspheric}: {far}, {unseen} of {all}");
    }
}

#[test]
#[ignore = "a sweep of a minute and more, which .ci/run makes: lenses of up to 1,000 interfaces"]
fn integrals_agree_for_long_lenses() {
    let mut wrong = Vec::new();
    for ((interfaces, is_aspheric), radius) in LENSES.into_iter().zip([1000.0, 4000.0, 50_000.0, 2000.0]) {
        let name = format!("{interfaces} {is_aspheric}");
        // The tables of such expensive lenses have few nodes over scene points.
        let bounds = [3e-3, if interfaces > 300 { 1.5e-2 } else { 1e-3 }];
        wrong.extend(disagreements(&name, &long(interfaces, is_aspheric), radius, bounds));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn directions_toward_long_lenses_are_sound_anywhere() {
    for (interfaces, is_aspheric) in LENSES {
        let camera = long(interfaces, is_aspheric);
        let points: Vec<ScenePoint> = (0..2000)
            .map(|i| {
                let [x, y, z, far, u, v] = numbers(i, 3);
                let far = 10.0_f64.powf(6.0 * far);
                let point = [x - 0.5, y - 0.5, z].map(|part| (far * part) as f32);
                ScenePoint { point, sample: [u as f32, v as f32], time: 0.5 }
            })
            .collect();
        let mut aimed = vec![Aimed::default(); points.len()];
        camera.adjoint().expect("defined").aim(&points, &mut aimed);
        for (Aimed { origin, direction, density, importance }, point) in aimed.iter().zip(&points) {
            let numbers = origin.iter().chain(direction).chain([density, &importance.importance]);
            assert!(
                numbers.clone().all(|number| number.is_finite()),
                "{interfaces} {is_aspheric}: {point:?}"
            );
            assert!(*density >= 0.0 && importance.importance >= 0.0);
        }
    }
}
