//! Directions from points near a front surface that bulges toward or away from the scene: their rays begin on the
//! surface, ahead of the point, and the directions have the importance of these rays.

use ::realistic_camera::{Importance, ScenePoint, WorldRay};

use super::{
    super::support::{Random, host_with},
    camera_of,
};

/// A dome, as a sphere and as an asphere: nearly half a ball of glass.
const DOME: &str = "20 10 1.7 - 38\n-20 12 - - 30\n";
/// A concave front.
const HOLLOW: &str = "-40 3 1.5 - 30\n-20 30 - - 30\n";

/// Returns z of a conic at a distance from the axis, by its formula; z is positive toward the scene.
fn sagitta([radius, conic]: [f64; 2], height: f64) -> f64 {
    let square = height * height;
    -square / (radius * (1.0 + (1.0 - (1.0 + conic) * square / (radius * radius)).sqrt()))
}

#[test]
fn directions_begin_on_the_front_and_count_as_their_rays_do() {
    for (name, text, shape, semi) in [
        ("dome", DOME.to_owned(), [20.0, 0.0], 19.0),
        ("aspheric dome", format!("{DOME}asphere 1 conic=-0.05\n"), [20.0, -0.05], 19.0),
        ("flat ellipsoid", format!("{DOME}asphere 1 conic=0.04\n"), [20.0, 0.04], 19.0),
        ("hollow", HOLLOW.to_owned(), [-40.0, 0.0], 15.0),
        ("aspheric hollow", format!("{HOLLOW}asphere 1 conic=-0.3\n"), [-40.0, -0.3], 15.0),
    ] {
        let camera = camera_of(&host_with(&text), &[("film_distance", "30"), ("film_diagonal", "30")]);
        let adjoint = camera.adjoint().expect("defined");
        let mut random = Random::new(11);
        let points: Vec<ScenePoint> = (0..20_000)
            .map(|i| {
                // Points lie near the front, within its bulge and beside it, and farther away.
                let reach = if i % 2 == 0 { 2.0 * semi } else { 100.0 * semi };
                let [x, y] = [random.signed(), random.signed()].map(|part| (reach * part) as f32);
                let z = (reach * random.signed()) as f32;
                let sample = [random.next() as f32, random.next() as f32];
                ScenePoint { point: [x, y, z], sample, time: 0.0 }
            })
            .collect();
        let mut aimed = vec![Default::default(); points.len()];
        adjoint.aim(&points, &mut aimed);
        let (mut lit, mut same) = (0, 0);
        for (ScenePoint { point, .. }, aim) in points.iter().zip(&aimed) {
            let [x, y, z] = point.map(f64::from);
            let height = x.hypot(y);
            if height < semi && z < sagitta(shape, height) {
                assert_eq!(aim.density, 0.0, "{name}: {point:?} lies behind the front");
            }
            if aim.density == 0.0 {
                continue;
            }
            let along: f64 = (0..3).map(|k| (aim.origin[k] - [x, y, z][k]) * aim.direction[k]).sum();
            assert!(along > 0.0, "{name}: {point:?} {aim:?}");
            if aim.importance.importance == 0.0 {
                continue;
            }
            lit += 1;
            let [ox, oy, oz] = aim.origin;
            let at = ox.hypot(oy);
            assert!(at <= semi * (1.0 + 1e-9), "{name}: {point:?} {aim:?}");
            assert!((oz - sagitta(shape, at)).abs() < 1e-7 * semi, "{name}: {point:?} {aim:?}");
            let ray = WorldRay {
                origin: aim.origin.map(|part| part as f32),
                direction: aim.direction.map(|part| part as f32),
                ..WorldRay::default()
            };
            let mut found = [Importance::default()];
            adjoint.arrive(&[ray], &mut found);
            same += usize::from((found[0].importance / aim.importance.importance - 1.0).abs() < 1e-3);
        }
        // Single precision may move a ray that grazes an edge beyond it.
        assert!(lit > 200 && same * 1000 >= lit * 998, "{name}: {same} of {lit}");
    }
}
