//! Importance between media: no power of the index at the scene.

use super::{
    EYE, FISHEYE, IMMERSED,
    cameras::{anywhere, camera},
    near,
};
use crate::support::{Random, lens_of, ray};
use ::realistic_camera::{Importance, WorldRay};

#[test]
fn importance_has_no_power_of_the_index() {
    for (text, diagonal) in [(EYE, 8.0), (FISHEYE, 16.0), (IMMERSED, 30.0)] {
        for model in ["lens", "thick"] {
            let size = f64::to_string(&diagonal);
            let camera = camera(text, &[("film_diagonal", &size), ("model", model)]);
            let samples: Vec<(WorldRay, f32)> = anywhere(61, 2000)
                .into_iter()
                .filter_map(|(image, lens)| ray(&camera, image, lens))
                .collect();
            let turned =
                |(ray, _): &(WorldRay, f32)| WorldRay { direction: ray.direction.map(|x| -x), ..*ray };
            let back: Vec<WorldRay> = samples.iter().map(turned).collect();
            let mut found = vec![Importance::default(); back.len()];
            camera.adjoint().expect("defined").arrive(&back, &mut found);
            let mut arrived = 0;
            for (found, (_, weight)) in found.iter().zip(&samples).filter(|(found, _)| found.importance > 0.0)
            {
                near(found.importance / found.density / f64::from(*weight), 1.0, 1e-3);
                if model == "lens" {
                    // The film has the format 4:3.
                    near(found.importance * (0.8 * diagonal) * (0.6 * diagonal), 1.0, 1e-4);
                }
                arrived += 1;
            }
            assert!(
                arrived > samples.len() * 9 / 10 && arrived > 200,
                "{model}: {arrived} of {}",
                samples.len()
            );
        }
    }
}

#[test]
fn importance_integrates_over_the_scene_to_the_mean_weight() {
    // ∫ We cosθ dA dω over the front of the lens is the mean weight over film and lens samples.
    const COUNT: usize = 200_000;
    let text = IMMERSED;
    for model in ["lens", "thick"] {
        let camera = camera(text, &[("film_diagonal", "30"), ("fnumber", "4"), ("model", model)]);
        let weights = anywhere(62, COUNT).into_iter().filter_map(|(image, lens)| ray(&camera, image, lens));
        let mean = weights.map(|(_, weight)| f64::from(weight)).sum::<f64>() / COUNT as f64;
        // Points of the plane z = 0 and slopes are uniform over squares.
        let (radius, most) = (lens_of(text).front().semi_diameter, 0.3);
        let mut random = Random::new(65);
        let rays: Vec<WorldRay> = (0..COUNT)
            .map(|_| {
                let [x, y] = [(); 2].map(|()| radius * random.signed());
                let [sx, sy] = [(); 2].map(|()| most * random.signed());
                let length = (1.0 + sx * sx + sy * sy).sqrt();
                let origin = [x - 40.0 * sx, y - 40.0 * sy, 40.0].map(|part| part as f32);
                let direction = [sx / length, sy / length, -1.0 / length].map(|part| part as f32);
                WorldRay { origin, direction, ..WorldRay::default() }
            })
            .collect();
        let mut found = vec![Importance::default(); rays.len()];
        camera.adjoint().expect("defined").arrive(&rays, &mut found);
        // cosθ dω = cos⁴θ d(slopes).
        let cell = (2.0 * radius).powi(2) * (2.0 * most).powi(2) / COUNT as f64;
        let seen = found.iter().zip(&rays);
        let integral: f64 =
            seen.map(|(found, ray)| found.importance * f64::from(ray.direction[2]).powi(4) * cell).sum();
        eprintln!("{model}: {integral} {mean}");
        near(integral / mean, 1.0, 0.03);
    }
}
