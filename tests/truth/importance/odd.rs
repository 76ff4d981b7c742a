//! Invalid rays and points have no importance, and nothing panics.

use ::realistic_camera::{Aimed, Importance, ScenePoint, WorldRay};

use super::{
    CAMERAS, camera,
    scene::{rays, turned},
    support::{RASTER, Random},
};

/// Returns numbers of any bits, and the most critical numbers.
fn strange(random: &mut Random) -> f32 {
    match (random.next() * 8.0) as u32 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => -0.0,
        3 => f32::MIN_POSITIVE * random.signed() as f32,
        4 => f32::MAX * random.signed() as f32,
        5 => random.signed() as f32,
        _ => f32::from_bits((random.next() * 4_294_967_296.0) as u32),
    }
}

#[test]
fn any_bits_count_nothing_or_something_finite() {
    for given in CAMERAS {
        let camera = camera(given);
        let adjoint = camera.adjoint().expect("defined");
        let mut random = Random::new(11);
        let mut three = || [(); 3].map(|()| strange(&mut random));
        let rays: Vec<WorldRay> = (0..4000)
            .map(|_| WorldRay {
                origin: three(),
                direction: three(),
                time: three()[0],
                ..WorldRay::default()
            })
            .collect();
        let points: Vec<ScenePoint> = (0..4000)
            .map(|_| ScenePoint { point: three(), sample: [three()[0], three()[1]], time: three()[2] })
            .collect();
        let (mut found, mut aimed) = (vec![Importance::default(); 4000], vec![Aimed::default(); 4000]);
        adjoint.arrive(&rays, &mut found);
        adjoint.aim(&points, &mut aimed);
        let is_sound = |importance: &Importance| {
            let Importance { raster, importance, density, area_density, solid_angle_density } = *importance;
            [raster[0], raster[1], importance, density, area_density, solid_angle_density]
                .iter()
                .all(|number| number.is_finite() && *number >= 0.0)
        };
        assert!(found.iter().all(is_sound), "{given:?}");
        for aim in &aimed {
            let numbers = aim.origin.iter().chain(&aim.direction).all(|number| number.is_finite());
            assert!(numbers && aim.density >= 0.0 && is_sound(&aim.importance), "{given:?}: {aim:?}");
        }
    }
}

#[test]
fn rays_from_behind_and_of_no_direction_count_nothing() {
    for given in [&[][..], &[("model", "thick")], &[("lens_file", "fisheye.10mm"), ("film_diagonal", "22")]] {
        let camera = camera(given);
        let adjoint = camera.adjoint().expect("defined");
        for (_, ray, _) in rays(&camera, [RASTER.xres, RASTER.yres], 200, 1) {
            let back = turned(&ray);
            let behind = WorldRay {
                origin: [0, 1, 2].map(|axis| ray.origin[axis] - 500.0 * ray.direction[axis]),
                ..back
            };
            let still = WorldRay { direction: [0.0; 3], ..back };
            let late = WorldRay { time: 2.0, ..back };
            let mut found = [Importance::default(); 4];
            adjoint.arrive(&[ray, behind, still, late], &mut found);
            assert_eq!(found, [Importance::default(); 4], "{given:?}: {ray:?}");
        }
    }
}
